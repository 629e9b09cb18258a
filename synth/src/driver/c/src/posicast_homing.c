/* The functions of posicast_homing.h. */
#include "posicast_homing.h"

#include "posicast_wait.h"

#if POSICAST_HOMED_AXES
/* An axis with an absolute encoder is not homed, and has no registers for it. */
static int is_homed_here(uint32_t axis)
{
    return (POSICAST_HOMED_AXES >> axis & 1u) != 0;
}

static void set_homed(const posicast_stage *stage, uint32_t axis, uint32_t homed)
{
    if (is_homed_here(axis))
        IOWR_POSICAST_AXIS_HOMED(stage->base, axis, homed);
}

static int32_t position_of(const posicast_stage *stage, uint32_t axis)
{
    return (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, axis);
}

/* Bits of STATUS, and where the axis was when they came. */
typedef struct {
    uint32_t mask;
    uint32_t wanted;
    int32_t found_at;
} status_bits;

static int has_bits(const posicast_stage *stage, uint32_t axis, uint32_t status, void *context)
{
    status_bits *bits = context;

    if ((status & bits->mask) != bits->wanted)
        return 0;
    bits->found_at = position_of(stage, axis);
    return 1;
}

/* Moves over a distance until STATUS has the wanted bits, and comes to rest. `found_at` is the position at that time. */
static posicast_result seek(const posicast_stage *stage, uint32_t axis, const posicast_limits *limits, int32_t distance,
                            uint32_t mask, uint32_t wanted, uint32_t ticks, int32_t *found_at)
{
    status_bits bits = {mask, wanted, 0};
    const posicast_result result = posicast_seek(stage, axis, limits, distance, has_bits, &bits, ticks);

    if (result == POSICAST_OK)
        *found_at = bits.found_at;
    return result;
}

/* Searches for the edge of the switch, from the side on which it is not pressed. */
static posicast_result seek_switch(const posicast_stage *stage, uint32_t axis, const posicast_homing *homing, uint32_t ticks,
                                   int32_t *found_at)
{
    const uint32_t home = POSICAST_AXIS_STATUS_LEVEL_HOME_MSK;

    if (homing->switch_within == INT32_MIN)
        return POSICAST_BAD_ARGUMENT;
    if (posicast_status(stage, axis) & home) {
        const posicast_result result =
            seek(stage, axis, &homing->limits, -homing->switch_within, home, 0, ticks, found_at);

        if (result != POSICAST_OK)
            return result;
    }
    return seek(stage, axis, &homing->limits, homing->switch_within, home, home, ticks, found_at);
}

/*
 * Searches for the index, or the contact of a probe, at which the hardware sets the position: exactly, however fast the axis passes it.
 */
static posicast_result seek_index(const posicast_stage *stage, uint32_t axis, const posicast_limits *limits, int32_t within,
                                  int32_t position, uint32_t ticks)
{
    const uint32_t setup = (uint32_t)IORD_POSICAST_AXIS_INDEX(stage->base, axis);
    posicast_result result;
    int32_t found_at;

    IOWR_POSICAST_AXIS_PRESET(stage->base, axis, (uint32_t)position);
    IOWR_POSICAST_AXIS_INDEX(stage->base, axis,
                             (setup & ~POSICAST_AXIS_INDEX_INDEX_ALWAYS_MSK) | POSICAST_AXIS_INDEX_INDEX_PRESETS_MSK);
    IOWR_POSICAST_AXIS_INDEX_ARM(stage->base, axis, 0);
    result = posicast_wait_flags(stage);
    if (result == POSICAST_OK)
        result = seek(stage, axis, limits, within, POSICAST_AXIS_STATUS_INDEX_ARMED_MSK, 0, ticks, &found_at);
    /* A later index must not move the origin again. */
    IOWR_POSICAST_AXIS_INDEX(stage->base, axis, setup);
    return result;
}

posicast_result posicast_home(const posicast_stage *stage, uint32_t axis, const posicast_homing *homing, uint32_t ticks)
{
    posicast_result result = POSICAST_OK;
    int32_t found_at;

    if (!is_axis(stage, axis) || !is_homed_here(axis))
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD)
        return POSICAST_WRONG_STATE;
    found_at = position_of(stage, axis);
    if (homing->switch_within != 0)
        result = seek_switch(stage, axis, homing, ticks, &found_at);
    if (result != POSICAST_OK)
        return result;
    if (homing->index_within != 0)
        return seek_index(stage, axis, &homing->limits, homing->index_within, homing->position, ticks);
    /* The distance that the axis has moved since; positions wrap at 2^32, as in the hardware. */
    IOWR_POSICAST_AXIS_PRESET(stage->base, axis,
                              (uint32_t)homing->position + (uint32_t)position_of(stage, axis) - (uint32_t)found_at);
    return posicast_wait_flags(stage);
}

/* Moves back from the probe, which must then be free. */
static posicast_result retract(const posicast_stage *stage, uint32_t axis, const posicast_probing *probing, uint32_t ticks)
{
    const int32_t back = probing->within < 0 ? probing->retract : -probing->retract;
    const int64_t end = (int64_t)posicast_command_position(stage, axis) + back;
    posicast_result result;

    if (end < INT32_MIN || end > INT32_MAX)
        return POSICAST_BAD_ARGUMENT;
    result = posicast_queue_move(stage, axis, (int32_t)end, &probing->limits);
    if (result == POSICAST_OK)
        result = posicast_start(stage, 1u << axis);
    if (result == POSICAST_OK)
        result = posicast_wait_at_rest(stage, 1u << axis, ticks);
    if (result != POSICAST_OK)
        return result;
    return posicast_status(stage, axis) & POSICAST_AXIS_STATUS_LEVEL_Z_MSK ? POSICAST_NO_REFERENCE : POSICAST_OK;
}

posicast_result posicast_home_by_probe(const posicast_stage *stage, uint32_t axis, const posicast_probing *probing, uint32_t ticks)
{
    const uint32_t touches = POSICAST_AXIS_STATUS_LEVEL_Z_MSK;
    posicast_result result = POSICAST_OK;
    int32_t found_at;

    if (!is_axis(stage, axis) || !is_homed_here(axis) || probing->within == 0 || probing->retract <= 0 || probing->retract > INT32_MAX / 2)
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD)
        return POSICAST_WRONG_STATE;
    /* The approaches go past the contact, where the travel of an earlier homing may end. */
    set_homed(stage, axis, 0u);
    if (posicast_status(stage, axis) & touches)
        result = retract(stage, axis, probing, ticks);
    if (result == POSICAST_OK)
        result = seek(stage, axis, &probing->limits, probing->within, touches, touches, ticks, &found_at);
    if (result == POSICAST_OK)
        result = retract(stage, axis, probing, ticks);
    if (result == POSICAST_OK)
        result = seek_index(stage, axis, &probing->slow, (probing->within < 0 ? -2 : 2) * probing->retract, probing->position, ticks);
    if (result == POSICAST_OK)
        result = retract(stage, axis, probing, ticks);
    return result;
}
#else
static void set_homed(const posicast_stage *stage, uint32_t axis, uint32_t homed)
{
    (void)stage;
    (void)axis;
    (void)homed;
}

posicast_result posicast_home(const posicast_stage *stage, uint32_t axis, const posicast_homing *homing, uint32_t ticks)
{
    (void)stage;
    (void)axis;
    (void)homing;
    (void)ticks;
    return POSICAST_BAD_ARGUMENT;
}

posicast_result posicast_home_by_probe(const posicast_stage *stage, uint32_t axis, const posicast_probing *probing, uint32_t ticks)
{
    (void)stage;
    (void)axis;
    (void)probing;
    (void)ticks;
    return POSICAST_BAD_ARGUMENT;
}
#endif

int32_t posicast_origin(const posicast_stage *stage, uint32_t axis)
{
    return (int32_t)IORD_POSICAST_AXIS_ORIGIN(stage->base, axis);
}

posicast_result posicast_limit_travel(const posicast_stage *stage, uint32_t axis, int32_t low, int32_t high)
{
    int64_t minus, plus;

    if (!is_axis(stage, axis) || low >= high)
        return POSICAST_BAD_ARGUMENT;
    minus = low + (int64_t)posicast_origin(stage, axis) * 256;
    plus = high + (int64_t)posicast_origin(stage, axis) * 256;
    if (minus < INT32_MIN || plus > INT32_MAX)
        return POSICAST_BAD_ARGUMENT;
    /* The axis must not be homed while one limit is still the old one. */
    set_homed(stage, axis, 0u);
    IOWR_POSICAST_AXIS_SOFT_LIMIT_MINUS(stage->base, axis, (uint32_t)(int32_t)minus);
    IOWR_POSICAST_AXIS_SOFT_LIMIT_PLUS(stage->base, axis, (uint32_t)(int32_t)plus);
    set_homed(stage, axis, 1u);
    return posicast_wait_flags(stage);
}

int posicast_is_homed(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && (posicast_status(stage, axis) & POSICAST_AXIS_STATUS_HOMED_MSK) != 0;
}
