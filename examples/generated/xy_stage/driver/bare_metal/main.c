/*
 * First moves of xy_stage without an operating system: each axis 100 counts there and back, then off. Written by posicast.
 *
 * Before the power stage is switched on, measure the gates: see the README.md of the folder above.
 */
#include "machine_xy_stage.h"
#include "posicast_driver.h"

/* Address of the stage in the system, as in sopc/. */
#ifndef STAGE_BASE
#define STAGE_BASE 0x00020000u
#endif

/* Distance of a move in Q24.8 counts. */
#define DISTANCE (100 * 256)
/* Number of ticks after which a step times out. */
#define PATIENCE_TICKS 20000u

/* The stage (`refused` says what posicast_open does not accept), the result, and the causes of each axis, for a debugger. */
static posicast_stage first_moves_stage;
volatile posicast_result first_moves_result = POSICAST_TIMEOUT;
volatile uint32_t first_moves_causes[2];

static posicast_result move(const posicast_stage *stage, uint32_t axis, int32_t end)
{
    posicast_result result = posicast_queue_move(stage, axis, end, &machine_xy_stage.axis[axis].limits);

    if (result == POSICAST_OK)
        result = posicast_start(stage, 1u << axis);
    if (result == POSICAST_OK)
        result = posicast_wait_at_rest(stage, 1u << axis, PATIENCE_TICKS);
    return result;
}

static posicast_result first_moves(const posicast_stage *stage)
{
    posicast_result result = posicast_switch_on(stage, posicast_all_axes(stage), PATIENCE_TICKS);
    uint32_t axis;

    for (axis = 0; axis < machine_xy_stage.axes && result == POSICAST_OK; axis++) {
        int32_t start = posicast_command_position(stage, axis);

        result = move(stage, axis, start + DISTANCE);
        if (result == POSICAST_OK)
            result = move(stage, axis, start);
    }
    return result;
}

int main(void)
{
    posicast_stage *const stage = &first_moves_stage;
    posicast_result result = posicast_open(stage, STAGE_BASE);
    uint32_t axis;

    if (result == POSICAST_OK) {
        result = first_moves(stage);
        for (axis = 0; axis < machine_xy_stage.axes; axis++)
            first_moves_causes[axis] = posicast_causes(stage, axis);
        (void)posicast_switch_off(stage, posicast_all_axes(stage), PATIENCE_TICKS);
    }
    first_moves_result = result;
    return result == POSICAST_OK ? 0 : 1;
}
