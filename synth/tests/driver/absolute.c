/* A program that moves axes with absolute encoders, without homing, and goes on after one of them was lost. */
#include "pipe.h"
#include "posicast_homing.h"

#define LONG 20000u

static void moves_to(posicast_stage *stage, int32_t position, posicast_result expected)
{
    need("a move", posicast_queue_move(stage, X, COUNTS(position), limits_of(X)), POSICAST_OK);
    need("its start", posicast_start(stage, 1u << X), POSICAST_OK);
    need("its end", posicast_wait_at_rest(stage, 1u << X, LONG), expected);
}

int main(void)
{
    const posicast_homing homing = {*limits_of(X), 0, 0, 0};
    posicast_stage opened, *stage = &opened;

    need("open", posicast_open(stage, BASE), POSICAST_OK);
    stage->pause = pause_here;
    result("homed_at_first", posicast_is_homed(stage, X));
    need("switch on", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    result("homed", posicast_is_homed(stage, X));
    need("no homing", posicast_home(stage, X, &homing, LONG), POSICAST_BAD_ARGUMENT);
    need("a narrower travel", posicast_limit_travel(stage, X, COUNTS(-9000), COUNTS(9000)), POSICAST_OK);
    moves_to(stage, 3000, POSICAST_OK);
    need("rest", posicast_wait_ticks(stage, 400), POSICAST_OK);
    result("position", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
    result("delay", IORD_POSICAST_AXIS_ENCODER_STATE(stage->base, X) >> POSICAST_AXIS_ENCODER_STATE_LINE_DELAY_OFST);
    /* The encoder is unplugged on the way. */
    moves_to(stage, 8000, POSICAST_FAULT);
    result("causes", posicast_causes(stage, X));
    result("homed_when_lost", posicast_is_homed(stage, X));
    result("silent", (IORD_POSICAST_AXIS_ENCODER_STATE(stage->base, X) & POSICAST_AXIS_ENCODER_STATE_ENCODER_SILENT_MSK) != 0);
    need("a time", posicast_wait_ticks(stage, 400), POSICAST_OK);
    need("switch on again", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    result("homed_again", posicast_is_homed(stage, X));
    moves_to(stage, 1000, POSICAST_OK);
    need("rest", posicast_wait_ticks(stage, 400), POSICAST_OK);
    result("position_after", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
    result("causes_after", posicast_causes(stage, X));
    return 0;
}
