/*
 * The path between the servo periods of LinuxCNC and those of the stage, whose clocks differ a little.
 *
 *   commands, one per servo period ─► Catmull-Rom ─► points, one per entry of the FIFO ─► posicast_stream_write
 *                                          ▲
 *             step: servo periods from point to point, 1 or up to 0.2 % more or less, so that the FIFO neither fills nor empties
 *
 * It touches no register.
 */
#ifndef POSICAST_PATH_H
#define POSICAST_PATH_H

#include <stdint.h>

#include "posicast_machine.h"
#include "posicast_stream.h"

typedef struct {
    uint32_t axes;
    uint32_t ticks; /* of a servo period */
    double commands[4][POSICAST_AXES_MAX]; /* counts since reset, the newest first */
    double step;
    /* When the next point is due: servo periods after the newest command. */
    double due;
    double too_many; /* ticks in the FIFO, more than wanted; filtered */
} posicast_path;

/* Begins where the axes stand, in counts since reset. */
void posicast_path_begin(posicast_path *path, uint32_t axes, uint32_t ticks, const double *positions);

/* Takes the command of a servo period, and by how many ticks the FIFO holds more than wanted. A command that is not a number is the last. */
void posicast_path_command(posicast_path *path, const double *positions, int32_t too_many);

/* Takes the next point that is due; returns whether there was one. Call it until there is none. */
int posicast_path_point(posicast_path *path, posicast_stream_point *points);

#endif
