/*
 * Correction at rest: an axis with steps and a scale ([axis.correction]) gets the steps that its motor has lost.
 *
 * The driver accepts where the scale says that the axis is: it sets the position, shifts the soft limits, and lets the deviation count
 * anew. Then an ordinary move leads the axis back. Wherever it is interrupted, position and limits are true, and no step is given twice.
 */
#ifndef POSICAST_CORRECTION_H
#define POSICAST_CORRECTION_H

#include <stdint.h>

#include "posicast_driver.h"

typedef struct {
    /* Limits of the move; its velocity is the rate of the steps. */
    posicast_limits limits;
    /* Steps: up to `from` nothing is done, and beyond `most`, at most 32767, the axis is left alone. */
    int32_t from;
    int32_t most;
} posicast_correction;

/*
 * Corrects an axis in HOLD that rests; call it after a time of rest. `steps` are the missing steps that were given. Returns
 * POSICAST_NO_REFERENCE for a deviation beyond `most`, POSICAST_WRONG_STATE for an axis that is not in HOLD,
 * POSICAST_BAD_ARGUMENT for one without [axis.correction]; otherwise as a move, which takes at most `ticks`.
 */
posicast_result posicast_correct(const posicast_stage *stage, uint32_t axis, const posicast_correction *how, int32_t *steps,
                                 uint32_t ticks);

/* Missing steps for which the axis was corrected since reset, up less down. */
int32_t posicast_corrected_steps(const posicast_stage *stage, uint32_t axis);

/*
 * Only accepts the scale's position, without a move: for programs that stream positions. The axis must stand. `steps` is its
 * deviation, by which the origin moves.
 */
posicast_result posicast_accept_deviation(const posicast_stage *stage, uint32_t axis, int32_t steps);

#endif
