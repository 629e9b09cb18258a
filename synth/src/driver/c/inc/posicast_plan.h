/*
 * Moves from rest to rest as entries of the FIFO: as fast as the limits allow, in integer arithmetic only.
 *
 *   n1 n2 n1 n3 n1 n2 n1 ticks of jerk j 0 -j 0 -j 0 j cover exactly j * n1 * (n1 + n2) * (2 n1 + n2 + n3)
 *
 * The jerk is truncated to its word. Superposed moves of the same duration with one or a few LSB of jerk cover the remaining
 * distance. A final point of one tick sets the exact target; it changes the command by less than half of its LSB.
 */
#ifndef POSICAST_PLAN_H
#define POSICAST_PLAN_H

#include <stdint.h>

#include "posicast_result.h"
#include "posicast_segments.h"

/* Limits of a move, each above 0, in LSB of 2^-32. */
typedef struct {
    int64_t velocity;     /* counts per tick */
    int64_t acceleration; /* counts per tick^2 */
    int64_t jerk;         /* counts per tick^3 */
} posicast_limits;

/* Number of entries that suffices for any plan. */
#define POSICAST_PLAN_ROOM 40u

/*
 * Plans the move from `start` to `end`, command positions in Q24.8 counts, into `entries`, which has room for `room` of them, and
 * sets `count` to the number of entries, which is 0 if start equals end. The last entry has POSICAST_ENTRY_NOTIFY. Returns
 * POSICAST_BAD_ARGUMENT for limits of 0 or less, POSICAST_TOO_LONG or POSICAST_FULL.
 */
posicast_result posicast_plan_move(int32_t start, int32_t end, const posicast_limits *limits, posicast_entry *entries,
                                   uint32_t room, uint32_t *count);

#endif
