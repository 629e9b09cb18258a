/*
 * Homing: an axis searches for its home switch, then for the index of its encoder, and gives that place a known position.
 *
 *   HOLD ─► off the switch, if it is on it ─► towards the switch ─► towards the index ─► HOLD, POSITION known
 *   HOLD ─► towards the probe ─► retract ─► slowly towards the probe ─► retract ─► HOLD, POSITION known
 *
 * Commands and soft limits stay in counts since reset, like COUNT: a position is commanded as position + posicast_origin, and
 * posicast_limit_travel shifts the soft limits. The searches end with a quick stop, for which there must be room after the switch.
 */
#ifndef POSICAST_HOMING_H
#define POSICAST_HOMING_H

#include <stdint.h>

#include "posicast_driver.h"

typedef struct {
    /* Limits of the searches. The switch is found within the distance that the axis moves between two reads of it. */
    posicast_limits limits;
    /* Largest distance of the switch in Q24.8 counts; the sign gives its direction. 0 means that there is no switch. */
    int32_t switch_within;
    /* Largest distance of the index from where the axis then stands, with its sign. 0 means that the switch is the reference. */
    int32_t index_within;
    /* Position in counts of the index or, without it, of the switch; without both, of the place where the axis stands. */
    int32_t position;
} posicast_homing;

/*
 * Homes an axis in HOLD, and ends at rest. An axis with an absolute encoder is not homed: POSICAST_BAD_ARGUMENT. `ticks` limits each of its moves, of which there are up to three. Returns
 * POSICAST_NO_REFERENCE if switch or index was not found within its distance: the axis rests, and its position is not valid.
 * POSICAST_WRONG_STATE, POSICAST_FAULT and POSICAST_TIMEOUT are as for moves; after POSICAST_TIMEOUT the axis is stopping.
 */
posicast_result posicast_home(const posicast_stage *stage, uint32_t axis, const posicast_homing *homing, uint32_t ticks);

/* Homing by a probe: an axis with [axis.probe]. */
typedef struct {
    /* Limits of the first approach, and of the moves back. */
    posicast_limits limits;
    /* Limits of the second approach, whose contact is the reference. */
    posicast_limits slow;
    /* Largest distance of the contact in Q24.8 counts; the sign gives its direction. */
    int32_t within;
    /* Distance back from the contact, above 0: before the second approach, and at the end. */
    int32_t retract;
    /* Position of the contact in counts. */
    int32_t position;
} posicast_probing;

/*
 * Homes an axis in HOLD by its probe, and ends at rest, `retract` from the contact. The hardware sets the position at the contact.
 * `ticks` limits each of its moves, of which there are up to five. Returns POSICAST_NO_REFERENCE if there was no contact within its
 * distance, or if the probe touches after a move back; otherwise as posicast_home.
 */
posicast_result posicast_home_by_probe(const posicast_stage *stage, uint32_t axis, const posicast_probing *probing, uint32_t ticks);

/* Returns the COUNT at which POSITION is 0. */
int32_t posicast_origin(const posicast_stage *stage, uint32_t axis);

/*
 * Limits the position (Q24.8 counts) of a homed axis to these soft limits from the next tick on: writes both as counts since
 * reset, then HOMED. With soft_limits_after_homing in the machine file there are none before. An axis that is beyond them, or
 * moves there, has a fault. Returns POSICAST_BAD_ARGUMENT if the limits do not fit their words, or if low is not below high.
 */
posicast_result posicast_limit_travel(const posicast_stage *stage, uint32_t axis, int32_t low, int32_t high);

/*
 * Returns whether the axis has been homed and has not lost its position since; with an absolute encoder, whether that says where the
 * axis stands. A lost encoder or an encoder error ends that, as a
 * reset does, and HOMED cannot be set before posicast_switch_on has cleared that cause.
 */
int posicast_is_homed(const posicast_stage *stage, uint32_t axis);

#endif
