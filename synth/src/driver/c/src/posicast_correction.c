/* The functions of posicast_correction.h. */
#include "posicast_correction.h"

#include "posicast_wait.h"

static int is_corrected(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && (POSICAST_CORRECTION_AXES >> axis & 1u) != 0;
}

int32_t posicast_corrected_steps(const posicast_stage *stage, uint32_t axis)
{
    return is_corrected(stage, axis) ? (int32_t)IORD_POSICAST_AXIS_CORRECTED(stage->base, axis) : 0;
}

posicast_result posicast_accept_deviation(const posicast_stage *stage, uint32_t axis, int32_t steps)
{
    const uint32_t shift = (uint32_t)steps * 256u;
    uint32_t minus, plus, homed;

    if (!is_corrected(stage, axis) || steps < INT16_MIN || steps > INT16_MAX)
        return POSICAST_BAD_ARGUMENT;
    minus = (uint32_t)IORD_POSICAST_AXIS_SOFT_LIMIT_MINUS(stage->base, axis);
    plus = (uint32_t)IORD_POSICAST_AXIS_SOFT_LIMIT_PLUS(stage->base, axis);
    homed = posicast_status(stage, axis) & POSICAST_AXIS_STATUS_HOMED_MSK ? POSICAST_AXIS_HOMED_HOMED_VALUE_MSK : 0u;
    IOWR_POSICAST_AXIS_PRESET(stage->base, axis, (uint32_t)IORD_POSICAST_AXIS_POSITION(stage->base, axis) - (uint32_t)steps);
    IOWR_POSICAST_AXIS_REALIGN(stage->base, axis, (uint32_t)steps & POSICAST_AXIS_REALIGN_REALIGN_STEPS_MSK);
    if (minus != 0 || plus != 0) {
        /* The axis must not be homed while one limit is still the old one. */
        IOWR_POSICAST_AXIS_HOMED(stage->base, axis, 0u);
        IOWR_POSICAST_AXIS_SOFT_LIMIT_MINUS(stage->base, axis, minus + shift);
        IOWR_POSICAST_AXIS_SOFT_LIMIT_PLUS(stage->base, axis, plus + shift);
        IOWR_POSICAST_AXIS_HOMED(stage->base, axis, homed);
    }
    return posicast_wait_flags(stage);
}

posicast_result posicast_correct(const posicast_stage *stage, uint32_t axis, const posicast_correction *how, int32_t *steps,
                                 uint32_t ticks)
{
    int32_t deviation;
    posicast_result result;

    *steps = 0;
    if (!is_corrected(stage, axis) || how->from < 0 || how->most > INT16_MAX)
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD)
        return POSICAST_WRONG_STATE;
    deviation = (int32_t)IORD_POSICAST_AXIS_DEVIATION(stage->base, axis);
    if (deviation <= how->from && deviation >= -how->from)
        return POSICAST_OK;
    if (deviation > how->most || deviation < -how->most)
        return POSICAST_NO_REFERENCE;
    result = posicast_accept_deviation(stage, axis, deviation);
    if (result == POSICAST_OK)
        result = posicast_queue_move(stage, axis, posicast_command_position(stage, axis) + deviation * 256, &how->limits);
    if (result == POSICAST_OK)
        result = posicast_start(stage, 1u << axis);
    if (result == POSICAST_OK)
        result = posicast_wait_at_rest(stage, 1u << axis, ticks);
    if (result == POSICAST_OK)
        *steps = deviation;
    return result;
}
