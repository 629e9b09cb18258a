/* The functions of posicast_compare.h. */
#include "posicast_compare.h"

#include "posicast_homing.h"
#include "posicast_wait.h"

#define LIST_POSITIONS 256u
#define LEAST_DISTANCE 4

static int compares(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && has(POSICAST_COMPARE_AXES, axis);
}

/* Whether a count from the origin is a count since reset. */
static int fits(int64_t count)
{
    return count >= INT32_MIN && count <= INT32_MAX;
}

uint32_t posicast_compare_state(const posicast_stage *stage, uint32_t axis)
{
    return compares(stage, axis) ? (uint32_t)IORD_POSICAST_AXIS_COMPARE_STATE(stage->base, axis) : 0u;
}

uint32_t posicast_compare_passes(const posicast_stage *stage, uint32_t axis)
{
    return compares(stage, axis) ? (uint32_t)IORD_POSICAST_AXIS_COMPARE_PASSES(stage->base, axis) : 0u;
}

posicast_result posicast_compare_off(const posicast_stage *stage, uint32_t axis)
{
    if (!compares(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_AXIS_COMPARE_DISARM(stage->base, axis, 0u);
    return posicast_wait_flags(stage);
}

/* Arms with the positions that are set, of a list or of a row, and waits until the place is found. */
static posicast_result arm(const posicast_stage *stage, uint32_t axis, int from_list, uint32_t ticks)
{
    const uint32_t list = POSICAST_AXIS_COMPARE_CONTROL_COMPARE_USE_LIST_MSK;
    const uint32_t control = (uint32_t)IORD_POSICAST_AXIS_COMPARE_CONTROL(stage->base, axis) & ~list;
    posicast_patience left = posicast_patience_for(stage, ticks);

    IOWR_POSICAST_AXIS_COMPARE_CONTROL(stage->base, axis, control | (from_list ? list : 0u));
    IOWR_POSICAST_AXIS_COMPARE_ARM(stage->base, axis, 0u);
    while ((posicast_compare_state(stage, axis) & POSICAST_AXIS_COMPARE_STATE_COMPARE_READY_MSK) == 0) {
        const posicast_result result = posicast_pass_time(stage, &left);

        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

posicast_result posicast_compare_row(const posicast_stage *stage, uint32_t axis, const posicast_row *row, uint32_t ticks)
{
    int64_t first;
    posicast_result result;

    if (!compares(stage, axis) || row->spacing == 0 || row->positions == 0)
        return POSICAST_BAD_ARGUMENT;
    first = (int64_t)row->first + posicast_origin(stage, axis);
    if (!fits(first))
        return POSICAST_BAD_ARGUMENT;
    result = posicast_compare_off(stage, axis);
    if (result != POSICAST_OK)
        return result;
    IOWR_POSICAST_AXIS_COMPARE_FIRST(stage->base, axis, (uint32_t)first);
    IOWR_POSICAST_AXIS_COMPARE_SPACING(stage->base, axis, row->spacing);
    IOWR_POSICAST_AXIS_COMPARE_POSITIONS(stage->base, axis, row->positions);
    return arm(stage, axis, 0, ticks);
}

posicast_result posicast_compare_list(const posicast_stage *stage, uint32_t axis, const int32_t *positions, uint32_t number,
                                      uint32_t ticks)
{
    int64_t origin;
    uint32_t i;
    posicast_result result;

    if (!compares(stage, axis) || number == 0 || number > LIST_POSITIONS)
        return POSICAST_BAD_ARGUMENT;
    origin = posicast_origin(stage, axis);
    for (i = 0; i < number; i++) {
        if (!fits(positions[i] + origin) || (i > 0 && (int64_t)positions[i] - positions[i - 1] < LEAST_DISTANCE))
            return POSICAST_BAD_ARGUMENT;
    }
    result = posicast_compare_off(stage, axis);
    if (result != POSICAST_OK)
        return result;
    IOWR_POSICAST_AXIS_COMPARE_CLEAR(stage->base, axis, 0u);
    for (i = 0; i < number; i++)
        IOWR_POSICAST_AXIS_COMPARE_ENTRY(stage->base, axis, (uint32_t)(positions[i] + origin));
    return arm(stage, axis, 1, ticks);
}
