/* A program that homes an axis with steps by its probe, and gives it the steps that its drive has lost. */
#include "pipe.h"
#include "posicast_correction.h"
#include "posicast_homing.h"

#define LONG 20000u

static posicast_limits slowly(int64_t thousandths)
{
    posicast_limits limits = *limits_of(X);

    /* Counts per tick. */
    limits.velocity = (thousandths << 32) / 1000;
    return limits;
}

static void homing(posicast_stage *stage)
{
    posicast_probing how = {slowly(300), slowly(50), COUNTS(-20), COUNTS(100), 1000};

    need("an axis that is off", posicast_home_by_probe(stage, X, &how, LONG), POSICAST_WRONG_STATE);
    need("switch on", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    result("touches_first", (IORD_POSICAST_AXIS_STATUS(stage->base, X) & POSICAST_AXIS_STATUS_LEVEL_Z_MSK) != 0);
    need("no contact so near", posicast_home_by_probe(stage, X, &how, LONG), POSICAST_NO_REFERENCE);
    how.within = COUNTS(-400);
    how.retract = 0;
    need("no retract", posicast_home_by_probe(stage, X, &how, LONG), POSICAST_BAD_ARGUMENT);
    how.retract = COUNTS(100);
    need("homing", posicast_home_by_probe(stage, X, &how, LONG), POSICAST_OK);
    result("origin", posicast_origin(stage, X));
    result("index_setup", IORD_POSICAST_AXIS_INDEX(stage->base, X));
    need("travel from the contact on", posicast_limit_travel(stage, X, COUNTS(1000), COUNTS(5000)), POSICAST_OK);
    need("homing again", posicast_home_by_probe(stage, X, &how, LONG), POSICAST_OK);
    result("homed_at", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
}

static void correcting(posicast_stage *stage)
{
    posicast_correction how = {slowly(100), 8, 5};
    int32_t steps;

    need("limits of the travel", posicast_limit_travel(stage, X, COUNTS(0), COUNTS(5000)), POSICAST_OK);
    /* The test cuts the step line on the way. */
    need("a move", posicast_queue_move(stage, X, COUNTS(400), limits_of(X)), POSICAST_OK);
    need("its start", posicast_start(stage, 1u << X), POSICAST_OK);
    need("its end", posicast_wait_at_rest(stage, 1u << X, LONG), POSICAST_OK);
    /* The load rings after the cut. */
    need("rest", posicast_wait_ticks(stage, 4000), POSICAST_OK);
    result("deviation", (int32_t)IORD_POSICAST_AXIS_DEVIATION(stage->base, X));
    result("position", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
    need("no scale", posicast_correct(stage, Y, &how, &steps, LONG), POSICAST_BAD_ARGUMENT);
    need("too many", posicast_correct(stage, X, &how, &steps, LONG), POSICAST_NO_REFERENCE);
    how.most = 200;
    need("the missing steps", posicast_correct(stage, X, &how, &steps, LONG), POSICAST_OK);
    result("steps", steps);
    need("a time", posicast_wait_ticks(stage, 4000), POSICAST_OK);
    need("nothing more", posicast_correct(stage, X, &how, &steps, LONG), POSICAST_OK);
    result("more_steps", steps);
    result("corrected", posicast_corrected_steps(stage, X));
    result("deviation_after", (int32_t)IORD_POSICAST_AXIS_DEVIATION(stage->base, X));
    result("position_after", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
    result("count", (int32_t)IORD_POSICAST_AXIS_COUNT(stage->base, X));
    result("scale", (int32_t)IORD_POSICAST_AXIS_SCALE_COUNT(stage->base, X));
    result("limit", (int32_t)IORD_POSICAST_AXIS_SOFT_LIMIT_PLUS(stage->base, X) / 256 - posicast_origin(stage, X));
    result("homed", posicast_is_homed(stage, X));
    result("causes", posicast_causes(stage, X));
}

int main(void)
{
    posicast_stage stage;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    homing(&stage);
    correcting(&stage);
    return 0;
}
