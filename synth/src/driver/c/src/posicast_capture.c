/* The functions of posicast_capture.h. */
#include "posicast_capture.h"

#include "posicast_homing.h"
#include "posicast_wait.h"

#define ENABLE POSICAST_STAGE_CAPTURE_CONTROL_CAPTURE_ENABLE_MSK
#define RISES POSICAST_STAGE_CAPTURE_CONTROL_CAPTURE_RISES_MSK
#define FALLS POSICAST_STAGE_CAPTURE_CONTROL_CAPTURE_FALLS_MSK

static uint32_t capture_state(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_CAPTURE_STATE(stage->base);
}

static uint32_t control(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_CAPTURE_CONTROL(stage->base);
}

void posicast_capture_begin(const posicast_stage *stage)
{
    IOWR_POSICAST_STAGE_CAPTURE_CONTROL(stage->base, control(stage) & ~ENABLE);
    IOWR_POSICAST_STAGE_CAPTURE_CLEAR(stage->base, 0u);
    IOWR_POSICAST_STAGE_CAPTURE_CONTROL(stage->base, control(stage) | ENABLE);
}

void posicast_capture_end(const posicast_stage *stage)
{
    IOWR_POSICAST_STAGE_CAPTURE_CONTROL(stage->base, control(stage) & ~ENABLE);
}

uint32_t posicast_captured_edges(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_CAPTURE_EDGES(stage->base);
}

posicast_result posicast_take_edge(const posicast_stage *stage, posicast_edge *edge)
{
    const uint32_t state = capture_state(stage);
    uint32_t axis;

    if ((state & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_VALID_MSK) == 0)
        return POSICAST_NO_REFERENCE;
    for (axis = 0; axis < stage->axes; axis++) {
        /* The registers follow each other, one for each axis; positions wrap at 2^32, as in the hardware. */
        const uint32_t count = (uint32_t)IORD(stage->base, POSICAST_STAGE_CAPTURE_COUNT_0_REG + axis);

        edge->positions[axis] = (int32_t)(count - (uint32_t)posicast_origin(stage, axis));
    }
    edge->stamp = (uint32_t)IORD_POSICAST_STAGE_CAPTURE_STAMP(stage->base);
    edge->rising = (state & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_RISING_MSK) != 0;
    IOWR_POSICAST_STAGE_CAPTURE_TAKE(stage->base, 0u);
    return POSICAST_OK;
}

/* Whether the line can have an edge that is wanted: it is known, and not at the level of the only one. */
static int can_find(const posicast_stage *stage)
{
    const uint32_t state = capture_state(stage);
    const uint32_t edges = control(stage) & (RISES | FALLS);
    const int is_high = (state & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_LEVEL_MSK) != 0;

    if ((state & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_LEVEL_KNOWN_MSK) == 0)
        return 0;
    return edges == RISES ? !is_high : edges == FALLS ? is_high : edges != 0;
}

static int has_edge(const posicast_stage *stage, uint32_t axis, uint32_t status, void *context)
{
    (void)axis;
    (void)status;
    return posicast_take_edge(stage, context) == POSICAST_OK;
}

posicast_result posicast_probe(const posicast_stage *stage, uint32_t axis, const posicast_way *way, posicast_edge *edge,
                               int32_t *overrun, uint32_t ticks)
{
    posicast_result result;

    *overrun = 0;
    if (!is_axis(stage, axis) || way->distance == 0)
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD)
        return POSICAST_WRONG_STATE;
    if (!can_find(stage))
        return POSICAST_NO_REFERENCE;
    posicast_capture_begin(stage);
    result = posicast_seek(stage, axis, &way->limits, way->distance, has_edge, edge, ticks);
    /* A later touch is not one of this move. */
    posicast_capture_end(stage);
    if (result == POSICAST_OK)
        *overrun = (int32_t)((uint32_t)IORD_POSICAST_AXIS_POSITION(stage->base, axis) - (uint32_t)edge->positions[axis]);
    return result;
}
