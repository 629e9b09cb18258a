/*
 * Homing: an axis looks for its home switch, then for the index of its encoder, and calls the place there a position.
 *
 *   HOLD ─► off the switch, if it is on it ─► towards the switch ─► towards the index ─► HOLD, POSITION known
 *
 * Commands and soft limits stay in counts since reset, as COUNT has them: what is meant as a position is commanded as
 * position + posicast_origin, and posicast_limit_travel shifts the soft limits. The searches end as a quick stop does: behind the switch there must be room for it.
 */
#ifndef POSICAST_HOMING_H
#define POSICAST_HOMING_H

#include <stdint.h>

#include "posicast_driver.h"

typedef struct {
    /* Of the searches. How slow they are says how exactly the switch is found: within what the axis moves in two looks at it. */
    posicast_limits limits;
    /* How far the switch may be away, Q24.8 counts; the sign says in which direction it is. 0: there is no switch. */
    int32_t switch_within;
    /* How far the index may be away from where the axis then stands, with its sign. 0: the place of the switch counts. */
    int32_t index_within;
    /* The position at the index, or else at the switch; without both, where the axis stands. Counts. */
    int32_t position;
} posicast_homing;

/*
 * Homes an axis in HOLD, and comes to rest. `ticks` are for each of its moves, of which there are up to three.
 * POSICAST_NO_REFERENCE where the way is over before switch or index came: the axis rests, its position is worth nothing.
 * POSICAST_WRONG_STATE, POSICAST_FAULT, POSICAST_TIMEOUT as of moves; after the last the axis is stopping.
 */
posicast_result posicast_home(const posicast_stage *stage, uint32_t axis, const posicast_homing *homing, uint32_t ticks);

/* COUNT at which POSITION is 0. */
int32_t posicast_origin(const posicast_stage *stage, uint32_t axis);

/*
 * The axis is homed, and its position, Q24.8 counts, lies between these soft limits from the next tick on: writes both as counts
 * since reset, then HOMED. With soft_limits_after_homing in the machine file there are none before. An axis that is beyond them has a
 * fault, as has one that moves there. POSICAST_BAD_ARGUMENT where the limits do not fit their words, or low is not below high.
 */
posicast_result posicast_limit_travel(const posicast_stage *stage, uint32_t axis, int32_t low, int32_t high);

/*
 * Has the axis been homed, and not lost its position since? A lost encoder or an error of it ends that, as a reset does, and
 * HOMED is not set before posicast_switch_on has forgotten that cause.
 */
int posicast_is_homed(const posicast_stage *stage, uint32_t axis);

#endif
