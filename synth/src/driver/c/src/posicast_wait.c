/* The functions of posicast_wait.h, and those of posicast_driver.h that let time pass. */
#include "posicast_wait.h"

#include <stddef.h>

/* Number of consecutive reads after which an unchanged time stamp means that the time stands still: each read takes clocks. */
#define STILL_LOOKS 8u
/* Number of clocks from a write until every flag that follows from it is visible. */
#define FLAG_CLOCKS 16u

static uint32_t time_stamp(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_TIME_STAMP(stage->base);
}

static uint32_t tick_count(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_TICK_COUNT(stage->base);
}

posicast_patience posicast_patience_for(const posicast_stage *stage, uint32_t ticks)
{
    posicast_patience left;

    left.from_tick = tick_count(stage);
    left.ticks = ticks;
    left.stamp = time_stamp(stage);
    left.still = 0;
    return left;
}

posicast_result posicast_pass_time(const posicast_stage *stage, posicast_patience *left)
{
    uint32_t stamp;

    posicast_kick(stage);
    if (stage->pause != NULL)
        stage->pause(stage->context);
    stamp = time_stamp(stage);
    left->still = stamp == left->stamp ? left->still + 1 : 0;
    left->stamp = stamp;
    if (left->still >= STILL_LOOKS)
        return POSICAST_DEAD;
    return tick_count(stage) - left->from_tick > left->ticks ? POSICAST_TIMEOUT : POSICAST_OK;
}

posicast_result posicast_wait_status(const posicast_stage *stage, uint32_t axis, uint32_t mask, uint32_t wanted,
                                     posicast_patience *left)
{
    while ((posicast_status(stage, axis) & mask) != wanted) {
        const posicast_result result = posicast_pass_time(stage, left);

        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

posicast_result posicast_wait_flags(const posicast_stage *stage)
{
    const uint32_t from = time_stamp(stage);
    uint32_t looks;

    for (looks = 0; looks < FLAG_CLOCKS; looks++) {
        if (time_stamp(stage) - from >= FLAG_CLOCKS)
            return POSICAST_OK;
    }
    return time_stamp(stage) == from ? POSICAST_DEAD : POSICAST_OK;
}

uint32_t posicast_flags(const posicast_stage *stage, uint32_t axis)
{
    return (uint32_t)IORD_POSICAST_AXIS_FLAGS(stage->base, axis);
}

posicast_result posicast_refused_since(const posicast_stage *stage, uint32_t axis, uint32_t refusals, uint32_t before)
{
    const posicast_result result = posicast_wait_flags(stage);

    if (result != POSICAST_OK)
        return result;
    return posicast_flags(stage, axis) & ~before & refusals ? POSICAST_REFUSED : POSICAST_OK;
}

void posicast_kick(const posicast_stage *stage)
{
    uint32_t axis;

    for (axis = 0; axis < stage->axes; axis++)
        IOWR_POSICAST_AXIS_KICK(stage->base, axis, POSICAST_KICK_WORD);
}

posicast_result posicast_wait_ticks(const posicast_stage *stage, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    posicast_result result;

    do {
        result = posicast_pass_time(stage, &left);
    } while (result == POSICAST_OK);
    return result == POSICAST_TIMEOUT ? POSICAST_OK : result;
}

/* Waits until `look` finds something; returns POSICAST_NO_REFERENCE if the move ends before. */
static posicast_result watch(const posicast_stage *stage, uint32_t axis, posicast_look look, void *context, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);

    for (;;) {
        /* The status is read first: a move that has ended is looked at to its end. */
        const uint32_t word = posicast_status(stage, axis);
        posicast_result result;

        if (look(stage, axis, word, context))
            return POSICAST_OK;
        if (posicast_causes(stage, axis) != 0)
            return POSICAST_FAULT;
        if (state_of(word) == POSICAST_AXIS_STATUS_STATE_HOLD)
            return POSICAST_NO_REFERENCE;
        result = posicast_pass_time(stage, &left);
        if (result != POSICAST_OK)
            return result;
    }
}

posicast_result posicast_seek(const posicast_stage *stage, uint32_t axis, const posicast_limits *limits, int32_t distance,
                              posicast_look look, void *context, uint32_t ticks)
{
    const int64_t end = (int64_t)posicast_command_position(stage, axis) + distance;
    posicast_result found, result;

    if (end < INT32_MIN || end > INT32_MAX)
        return POSICAST_BAD_ARGUMENT;
    result = posicast_queue_move(stage, axis, (int32_t)end, limits);
    if (result == POSICAST_OK)
        result = posicast_start(stage, 1u << axis);
    if (result != POSICAST_OK)
        return result;
    found = watch(stage, axis, look, context, ticks);
    posicast_stop(stage, 1u << axis);
    if (found != POSICAST_OK && found != POSICAST_NO_REFERENCE)
        return found;
    result = posicast_wait_at_rest(stage, 1u << axis, ticks);
    return result == POSICAST_OK ? found : result;
}
