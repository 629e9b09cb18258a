/*
 * Position capture: an edge of the line `capture_line` takes the positions of all axes in one clock, for a touch probe; of a stage with
 * [capture]. docs/capture.md says what is captured, and when.
 */
#ifndef POSICAST_CAPTURE_H
#define POSICAST_CAPTURE_H

#include <stdint.h>

#include "posicast_driver.h"

/* The positions at an edge. */
typedef struct {
    /* Counts from the origin, as it is now, of the axes that the stage has. */
    int32_t positions[POSICAST_AXES_MAX];
    /* Clocks since reset, modulo 2^32. */
    uint32_t stamp;
    int rising;
} posicast_edge;

/* A probing move. */
typedef struct {
    posicast_limits limits;
    /* Largest distance of the edge from where the axis stands, in counts * 256. */
    int32_t distance;
} posicast_way;

/* Begins to capture, with no edge counted; edges and filter are those of the register CAPTURE_CONTROL. */
void posicast_capture_begin(const posicast_stage *stage);

/* Ends it: entries stay. */
void posicast_capture_end(const posicast_stage *stage);

/* Takes the oldest edge. Returns POSICAST_NO_REFERENCE if there is none. */
posicast_result posicast_take_edge(const posicast_stage *stage, posicast_edge *edge);

/* Wanted edges since the beginning, captured or not: more than were taken and wait mean that the memory was full. */
uint32_t posicast_captured_edges(const posicast_stage *stage);

/*
 * Moves an axis in HOLD until the line has an edge, and stops it by a quick stop. `edge` has the positions of all axes at the edge, and
 * `overrun` how far the axis went on from there, in counts.
 *
 * Returns POSICAST_NO_REFERENCE if the move ends without an edge, or if the line already has the level that the edge would lead to;
 * POSICAST_WRONG_STATE for an axis that is not in HOLD; otherwise as a move, which takes at most `ticks`.
 */
posicast_result posicast_probe(const posicast_stage *stage, uint32_t axis, const posicast_way *way, posicast_edge *edge,
                               int32_t *overrun, uint32_t ticks);

#endif
