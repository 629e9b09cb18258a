/*
 * A path that a controller computes as it goes, as LinuxCNC or a motion kernel does: every period, say each millisecond, one point per axis,
 * and between them a straight line, a parabola or a cubic. One entry per axis and period: 4 writes and 2 reads.
 *
 *   posicast_stream_open ─► posicast_stream_write ─► posicast_stream_start ─► posicast_stream_write … ─► posicast_stream_write at rest
 *                           (a few points ahead)                              (one per period)             (the last one: it ends in HOLD)
 *
 * Points that come early wait in the FIFO: how many, `level` says. Where the next one is late the axis goes on at its velocity for the ticks
 * that the program allows, and then makes a quick stop with the cause "segments". The path is then late by as many ticks, but no point is
 * lost: the next one leads back to it.
 */
#ifndef POSICAST_STREAM_H
#define POSICAST_STREAM_H

#include <stdint.h>

#include "posicast_driver.h"

/* Longest period, in ticks. */
#define POSICAST_STREAM_TICKS_MAX 256u

/*
 * What lies between two points. Each ends within ticks * 2^-17 counts of the position, which the next one makes up for. A point of velocity 0
 * where the command already stands is a rest: a path that ends with one is over, and the axis holds; the next point goes on from there.
 */
typedef enum {
    /* A straight line: the velocity jumps at each point. */
    POSICAST_STREAM_LINEAR,
    /* A parabola that arrives with the point's velocity; how it begins follows. */
    POSICAST_STREAM_QUADRATIC,
    /* It begins with the present velocity and arrives with the point's: nothing jumps but the acceleration. */
    POSICAST_STREAM_CUBIC
} posicast_stream_order;

/* Where the command is to be at the end of a period. */
typedef struct {
    int32_t position; /* Q24.8 counts since reset */
    int32_t velocity; /* Q16.16 counts per tick; a line does without */
} posicast_stream_point;

/* An axis's path. */
typedef struct {
    /* The command after all that was written. */
    posicast_integrator at;
    /* Entries that waited after the last write. */
    uint32_t level;
    /* Ticks that were late since posicast_stream_open. */
    uint32_t late_ticks;
    uint32_t late_word;
} posicast_stream_axis;

typedef struct {
    const posicast_stage *stage;
    uint32_t axes;
    posicast_stream_order order;
    int started;
    posicast_stream_axis axis[POSICAST_AXES_MAX];
} posicast_stream;

/*
 * Begins paths of these axes where they hold. Where a point is missing an axis goes on for up to `late_ticks` (0 to 255) at its velocity.
 * POSICAST_WRONG_STATE for an axis that does not hold, or has entries. POSICAST_BAD_ARGUMENT.
 */
posicast_result posicast_stream_open(posicast_stream *stream, const posicast_stage *stage, uint32_t axes,
                                     posicast_stream_order order, uint32_t late_ticks);

/*
 * On from the last point of each axis to this one within `ticks`. `points` has one per axis of the stage; those of other axes are not looked
 * at. POSICAST_BAD_ARGUMENT where a point asks for more than the words of an entry hold, or has no ticks: then nothing is written for any axis.
 * POSICAST_FULL: nothing was written; the program is too fast. POSICAST_REFUSED: an axis stops or is off: posicast_causes.
 */
posicast_result posicast_stream_write(posicast_stream *stream, const posicast_stream_point *points, uint32_t ticks);

/* All these axes begin to play what was written, in one tick. As posicast_start. */
posicast_result posicast_stream_start(posicast_stream *stream);

/* An entry on from `at`: POSICAST_BAD_ARGUMENT where it does not fit its words. Touches no register. */
posicast_result posicast_stream_entry(const posicast_integrator *at, const posicast_stream_point *point, uint32_t ticks,
                                      posicast_stream_order order, posicast_entry *entry);

#endif
