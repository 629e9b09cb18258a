/*
 * Moves from rest to rest as entries of the FIFO: as fast as the limits allow, in integers alone.
 *
 *   n1 n2 n1 n3 n1 n2 n1 ticks of jerk j 0 -j 0 -j 0 j cover exactly j * n1 * (n1 + n2) * (2 n1 + n2 + n3)
 *
 * The jerk is cut to its word. What the cut leaves is made up by moves of the same duration and an LSB or some of jerk, laid over
 * it. A point of one tick then says exactly where the target is; it changes the command by less than half of its LSB.
 */
#ifndef POSICAST_PLAN_H
#define POSICAST_PLAN_H

#include <stdint.h>

#include "posicast_result.h"
#include "posicast_segments.h"

/* What a move may ask for, each above 0, in LSB of 2^-32. */
typedef struct {
    int64_t velocity;     /* counts per tick */
    int64_t acceleration; /* counts per tick^2 */
    int64_t jerk;         /* counts per tick^3 */
} posicast_limits;

/* Room that any plan fits into. */
#define POSICAST_PLAN_ROOM 40u

/*
 * The move from `start` to `end`, command positions in Q24.8 counts, into `entries`, of which there are `room`; `count` says how
 * many it takes: none where start is end. The last one has POSICAST_ENTRY_NOTIFY.
 * POSICAST_BAD_ARGUMENT for limits of 0 or less, POSICAST_TOO_LONG, POSICAST_FULL.
 */
posicast_result posicast_plan_move(int32_t start, int32_t end, const posicast_limits *limits, posicast_entry *entries,
                                   uint32_t room, uint32_t *count);

#endif
