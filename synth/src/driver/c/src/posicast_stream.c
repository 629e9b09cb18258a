/* The functions of posicast_stream.h. */
#include "posicast_stream.h"

#include "posicast_wait.h"

/* Words of an entry, in LSB of 2^-32. */
#define VELOCITY_LSB     ((int64_t)1 << (POSICAST_FRACTION_BITS - POSICAST_VELOCITY_FRACTION))
#define ACCELERATION_LSB ((int64_t)1 << (POSICAST_FRACTION_BITS - POSICAST_ACCELERATION_FRACTION))
#define POSITION_LSB     ((int64_t)1 << (POSICAST_FRACTION_BITS - POSICAST_POSITION_FRACTION))

/* The nearest whole number to a quotient; the divisor is positive. */
static int64_t nearest(int64_t value, int64_t divisor)
{
    return (value >= 0 ? value + divisor / 2 : value - divisor / 2) / divisor;
}

static int64_t magnitude(int64_t value)
{
    return value < 0 ? -value : value;
}

static int is_word(int64_t value)
{
    return value >= INT32_MIN && value <= INT32_MAX;
}

/*
 * The velocities of n ticks are v + k a + k (k + 1) / 2 j for k = 0 to n - 1. They sum to
 *   n v + n (n - 1) / 2 a + (n - 1) n (n + 1) / 6 j = distance,
 * the last one is the point's, and of a cubic the one before the first, v - a, is the present one.
 */
posicast_result posicast_stream_entry(const posicast_integrator *at, const posicast_stream_point *point, uint32_t ticks,
                                      posicast_stream_order order, posicast_entry *entry)
{
    const int64_t n = ticks;
    const int64_t end = point->velocity * VELOCITY_LSB;
    /* The position comes round at 2^24 counts, as a rotary axis does; half a turn is the longest way. */
    const int64_t distance =
        (int64_t)(((uint64_t)(point->position * POSITION_LSB) - (uint64_t)at->position) << 8) / ((int64_t)1 << 8);
    int64_t velocity, acceleration = 0, jerk = 0;

    if (ticks == 0 || ticks > POSICAST_STREAM_TICKS_MAX)
        return POSICAST_BAD_ARGUMENT;
    /* What rounding left of the last velocity would be a motion without an end. */
    if (end == 0 && magnitude(distance) < POSITION_LSB && magnitude(n * at->velocity) < POSITION_LSB) {
        *entry = posicast_cubic(0, 0, 0, ticks, 0);
        return POSICAST_OK;
    }
    if (order == POSICAST_STREAM_CUBIC && n > 1) {
        const int64_t change = end - at->velocity;
        const int64_t extra = (n + 1) * change - 2 * (distance - n * at->velocity);

        jerk = nearest(extra, (n - 1) * n * (n + 1) / 6);
        acceleration = nearest(2 * change - (n - 1) * n * jerk, 2 * n);
    } else if (order == POSICAST_STREAM_QUADRATIC && n > 1) {
        acceleration = nearest(2 * (n * end - distance), n * (n - 1));
    }
    acceleration = nearest(acceleration, ACCELERATION_LSB);
    if (!is_word(acceleration) || !is_word(jerk))
        return POSICAST_BAD_ARGUMENT;
    velocity = nearest(distance - n * (n - 1) / 2 * acceleration * ACCELERATION_LSB - (n - 1) * n * (n + 1) / 6 * jerk,
                       n * VELOCITY_LSB);
    if (!is_word(velocity))
        return POSICAST_BAD_ARGUMENT;
    *entry = posicast_cubic((int32_t)velocity, (int32_t)acceleration, (int32_t)jerk, ticks, 0);
    return POSICAST_OK;
}

static uint32_t fifo(const posicast_stream *stream, uint32_t axis)
{
    return (uint32_t)IORD_POSICAST_AXIS_FIFO(stream->stage->base, axis);
}

posicast_result posicast_stream_open(posicast_stream *stream, const posicast_stage *stage, uint32_t axes,
                                     posicast_stream_order order, uint32_t late_ticks)
{
    uint32_t axis;

    if (!are_axes(stage, axes) || late_ticks > POSICAST_AXIS_FIFO_CONTROL_EXTRAPOLATION_MSK >>
                                                   POSICAST_AXIS_FIFO_CONTROL_EXTRAPOLATION_OFST)
        return POSICAST_BAD_ARGUMENT;
    stream->stage = stage;
    stream->axes = axes;
    stream->started = 0;
    stream->order = order;
    for (axis = 0; axis < stage->axes; axis++) {
        const uint32_t now = fifo(stream, axis);
        const uint32_t control = (uint32_t)IORD_POSICAST_AXIS_FIFO_CONTROL(stage->base, axis);
        posicast_stream_axis *path = &stream->axis[axis];

        if (!has(axes, axis))
            continue;
        if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD ||
            !FIELD(now, POSICAST_AXIS_FIFO_SEGMENTS_EMPTY))
            return POSICAST_WRONG_STATE;
        IOWR_POSICAST_AXIS_FIFO_CONTROL(stage->base, axis,
                                        (control & ~POSICAST_AXIS_FIFO_CONTROL_EXTRAPOLATION_MSK) |
                                            AS_FIELD(late_ticks, POSICAST_AXIS_FIFO_CONTROL_EXTRAPOLATION));
        path->at = posicast_resting_at(posicast_command_position(stage, axis));
        path->level = 0;
        path->late_ticks = 0;
        path->late_word = FIELD(now, POSICAST_AXIS_FIFO_LATE_TICKS);
    }
    return POSICAST_OK;
}

/* What the hardware says after an entry: what was late until then was so after the entry before, at that one's velocity. */
static void follow(posicast_stream_axis *path, uint32_t fifo_word, const posicast_entry *entry)
{
    uint32_t late = (FIELD(fifo_word, POSICAST_AXIS_FIFO_LATE_TICKS) - path->late_word) & 0xffu;

    path->level = FIELD(fifo_word, POSICAST_AXIS_FIFO_FIFO_LEVEL);
    path->late_word = FIELD(fifo_word, POSICAST_AXIS_FIFO_LATE_TICKS);
    path->late_ticks += late;
    while (late-- > 0)
        posicast_extrapolate(&path->at);
    (void)posicast_play(&path->at, entry);
}

posicast_result posicast_stream_write(posicast_stream *stream, const posicast_stream_point *points, uint32_t ticks)
{
    posicast_entry entries[POSICAST_AXES_MAX];
    posicast_result result = POSICAST_OK;
    uint32_t axis, resting = 0;

    for (axis = 0; axis < stream->stage->axes; axis++) {
        const posicast_stream_axis *path = &stream->axis[axis];
        posicast_integrator at = path->at;

        if (!has(stream->axes, axis))
            continue;
        /* It may have become less meanwhile, but not more. */
        if (path->level >= POSICAST_FIFO_ENTRIES &&
            FIELD(fifo(stream, axis), POSICAST_AXIS_FIFO_FIFO_LEVEL) >= POSICAST_FIFO_ENTRIES)
            return POSICAST_FULL;
        result = posicast_stream_entry(&at, &points[axis], ticks, stream->order, &entries[axis]);
        if (result != POSICAST_OK || !posicast_play(&at, &entries[axis]))
            return POSICAST_BAD_ARGUMENT;
    }
    for (axis = 0; axis < stream->stage->axes; axis++) {
        if (has(stream->axes, axis))
            posicast_put_entry(stream->stage, axis, &entries[axis], 0);
    }
    for (axis = 0; axis < stream->stage->axes; axis++) {
        uint32_t status;

        if (!has(stream->axes, axis))
            continue;
        follow(&stream->axis[axis], fifo(stream, axis), &entries[axis]);
        status = posicast_status(stream->stage, axis);
        if (!keeps_entries(status))
            result = POSICAST_REFUSED;
        else if (state_of(status) == POSICAST_AXIS_STATUS_STATE_HOLD)
            resting |= 1u << axis;
    }
    /* A path that ran dry at rest goes on by itself. */
    if (result == POSICAST_OK && stream->started && resting != 0)
        IOWR_POSICAST_STAGE_START(stream->stage->base, AS_FIELD(resting, POSICAST_STAGE_START_START_AXES));
    return result;
}

posicast_result posicast_stream_start(posicast_stream *stream)
{
    const posicast_result result = posicast_start(stream->stage, stream->axes);

    stream->started = result == POSICAST_OK;
    return result;
}
