/*
 * Register accesses over standard output and input: r, w, p (time passes), s (a line of the machine changes), = (a result). The
 * test at the other end simulates the stage.
 */
#ifndef PIPE_H
#define PIPE_H

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "machine_xy_stage.h"
#include "posicast_driver.h"

#define BASE 0x40000u
#define X MACHINE_XY_STAGE_AXIS_X
#define Y MACHINE_XY_STAGE_AXIS_Y
#define BOTH 3u
#define COUNTS(n) ((int32_t)(n) * 256)
#define TICKS 2000u

/* Number of them so far. */
static uint32_t accesses;

uint32_t posicast_read(uintptr_t base, uint32_t word)
{
    uint32_t data;

    accesses++;
    printf("r %" PRIu32 "\n", word);
    if (base != BASE || fflush(stdout) != 0 || scanf("%" SCNu32, &data) != 1)
        exit(3);
    return data;
}

void posicast_write(uintptr_t base, uint32_t word, uint32_t data)
{
    if (base != BASE)
        exit(3);
    accesses++;
    printf("w %" PRIu32 " %" PRIu32 "\n", word, data);
}

static inline void pause_here(void *context)
{
    (void)context;
    printf("p\n");
}

static inline void set_line(const char *line, int level)
{
    printf("s %s %d\n", line, level);
}

static inline void result(const char *name, int64_t value)
{
    printf("= %s %" PRId64 "\n", name, value);
}

static inline void need(const char *what, posicast_result got, posicast_result wanted)
{
    if (got == wanted)
        return;
    printf("! %s gives %d, not %d\n", what, got, wanted);
    (void)fflush(stdout);
    exit(2);
}

static inline const posicast_limits *limits_of(uint32_t axis)
{
    return &machine_xy_stage.axis[axis].limits;
}

#endif
