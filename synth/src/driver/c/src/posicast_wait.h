/* Functions that the parts of the driver share: waiting with a limit, and reading the status of an axis. */
#ifndef POSICAST_WAIT_H
#define POSICAST_WAIT_H

#include "posicast_driver.h"

#define FIELD(word, name) (((uint32_t)(word) & name##_MSK) >> name##_OFST)
#define AS_FIELD(value, name) (((uint32_t)(value) << name##_OFST) & name##_MSK)

/* The limit of a wait. */
typedef struct {
    uint32_t from_tick;
    uint32_t ticks;
    uint32_t stamp;
    uint32_t still;
} posicast_patience;

/* Returns a limit of this many ticks from now on. */
posicast_patience posicast_patience_for(const posicast_stage *stage, uint32_t ticks);

/* Lets a little time pass. Returns POSICAST_OK, or the reason why waiting must end. */
posicast_result posicast_pass_time(const posicast_stage *stage, posicast_patience *left);

/* Waits until the bits of STATUS under `mask` have the values `wanted`. */
posicast_result posicast_wait_status(const posicast_stage *stage, uint32_t axis, uint32_t mask, uint32_t wanted,
                                     posicast_patience *left);

/* Waits until flags that a write has caused can be read. */
posicast_result posicast_wait_flags(const posicast_stage *stage);

/* What a search looks for: returns whether it is there. `status` is a word of STATUS, read before. */
typedef int (*posicast_look)(const posicast_stage *stage, uint32_t axis, uint32_t status, void *context);

/*
 * Moves an axis over a distance, in counts * 256, until `look` finds something, and lets it come to rest. Returns
 * POSICAST_NO_REFERENCE if the move ends before.
 */
posicast_result posicast_seek(const posicast_stage *stage, uint32_t axis, const posicast_limits *limits, int32_t distance,
                              posicast_look look, void *context, uint32_t ticks);

/* Returns the FLAGS of an axis. */
uint32_t posicast_flags(const posicast_stage *stage, uint32_t axis);

/*
 * Returns POSICAST_REFUSED if writes since `before` was read have set one of the flags `refusals`, which stay until faults are
 * cleared.
 */
posicast_result posicast_refused_since(const posicast_stage *stage, uint32_t axis, uint32_t refusals, uint32_t before);

/* The words of an entry; `more`: it is taken with those that follow, or not at all. A segment needs no word 2. */
static inline void posicast_put_entry(const posicast_stage *stage, uint32_t axis, const posicast_entry *entry, int more)
{
    const uint32_t last = entry->words[3] | (more ? POSICAST_ENTRY_MORE : 0u);

    IOWR_POSICAST_AXIS_SEGMENT(stage->base, axis, 0, entry->words[0]);
    IOWR_POSICAST_AXIS_SEGMENT(stage->base, axis, 1, entry->words[1]);
    if (last & (POSICAST_ENTRY_POINT | POSICAST_ENTRY_CUBIC))
        IOWR_POSICAST_AXIS_SEGMENT(stage->base, axis, 2, entry->words[2]);
    IOWR_POSICAST_AXIS_SEGMENT(stage->base, axis, 3, last);
}

static inline uint32_t posicast_status(const posicast_stage *stage, uint32_t axis)
{
    return (uint32_t)IORD_POSICAST_AXIS_STATUS(stage->base, axis);
}

static inline int is_axis(const posicast_stage *stage, uint32_t axis)
{
    return axis < stage->axes;
}

/* Whether it is an axis with a controller. */
static inline int has_loop(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && (POSICAST_LOOP_AXES >> axis & 1u) != 0;
}

static inline int are_axes(const posicast_stage *stage, uint32_t axes)
{
    return axes != 0 && (axes & ~posicast_all_axes(stage)) == 0;
}

static inline int has(uint32_t axes, uint32_t axis)
{
    return (axes >> axis & 1u) != 0;
}

static inline uint32_t state_of(uint32_t word)
{
    return FIELD(word, POSICAST_AXIS_STATUS_STATE);
}

/* Of a word of STATUS: entries stay in the FIFO in HOLD and RUN alone. The stop of the segments follows that of the axis a tick later. */
static inline int keeps_entries(uint32_t word)
{
    return (state_of(word) == POSICAST_AXIS_STATUS_STATE_HOLD || state_of(word) == POSICAST_AXIS_STATUS_STATE_RUN) &&
           FIELD(word, POSICAST_AXIS_STATUS_SEGMENTS_STATE) < POSICAST_SEGMENTS_STOP;
}

#endif
