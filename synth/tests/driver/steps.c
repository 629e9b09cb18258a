/* A program that homes an axis with steps by its probe, and gives it the steps that its drive has lost. */
#include "pipe.h"
#include "posicast_capture.h"
#include "posicast_compare.h"
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

/* Moves to a position, which counts from the origin. */
static void moves_to(posicast_stage *stage, int32_t position)
{
    const int32_t target = COUNTS(position) + 256 * posicast_origin(stage, X);

    need("a move", posicast_queue_move(stage, X, target, limits_of(X)), POSICAST_OK);
    need("its start", posicast_start(stage, 1u << X), POSICAST_OK);
    need("its end", posicast_wait_at_rest(stage, 1u << X, LONG), POSICAST_OK);
    need("rest", posicast_wait_ticks(stage, 400), POSICAST_OK);
}

static void comparing(posicast_stage *stage)
{
    const posicast_row row = {1600, 50, 10};
    const posicast_row none = {1600, 50, 0};
    const posicast_row far = {INT32_MIN, 50, 10};
    const int32_t list[] = {1850, 1854, 1900};
    const int32_t close[] = {1850, 1853};

    moves_to(stage, 1575);
    need("no compare", posicast_compare_row(stage, Y, &row, LONG), POSICAST_BAD_ARGUMENT);
    need("no position", posicast_compare_row(stage, X, &none, LONG), POSICAST_BAD_ARGUMENT);
    need("beyond the word", posicast_compare_row(stage, X, &far, LONG), POSICAST_BAD_ARGUMENT);
    need("a row", posicast_compare_row(stage, X, &row, LONG), POSICAST_OK);
    moves_to(stage, 1825);
    result("row_passes", posicast_compare_passes(stage, X));
    need("too close", posicast_compare_list(stage, X, close, 2, LONG), POSICAST_BAD_ARGUMENT);
    need("a list", posicast_compare_list(stage, X, list, 3, LONG), POSICAST_OK);
    moves_to(stage, 1875);
    result("list_passes", posicast_compare_passes(stage, X));
    result("list_state", posicast_compare_state(stage, X));
    need("off", posicast_compare_off(stage, X), POSICAST_OK);
    result("off_state", posicast_compare_state(stage, X) & POSICAST_AXIS_COMPARE_STATE_COMPARE_ARMED_MSK);
}

static void probing(posicast_stage *stage)
{
    const posicast_way way = {slowly(100), COUNTS(300)};
    const posicast_way back = {slowly(100), COUNTS(-20)};
    posicast_edge edge;
    int32_t overrun;

    need("a touch", posicast_probe(stage, X, &way, &edge, &overrun, LONG), POSICAST_OK);
    result("edge_x", edge.positions[X]);
    result("origin_now", posicast_origin(stage, X));
    result("edge_y", edge.positions[Y]);
    result("edge_rises", edge.rising);
    result("overrun", overrun);
    result("stands_at", (int32_t)IORD_POSICAST_AXIS_POSITION(stage->base, X));
    need("it touches", posicast_probe(stage, X, &way, &edge, &overrun, LONG), POSICAST_NO_REFERENCE);
    moves_to(stage, 1900);
    need("nothing there", posicast_probe(stage, X, &back, &edge, &overrun, LONG), POSICAST_NO_REFERENCE);
    result("edges", posicast_captured_edges(stage));
    need("no more", posicast_take_edge(stage, &edge), POSICAST_NO_REFERENCE);
}

int main(void)
{
    posicast_stage stage;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    homing(&stage);
    correcting(&stage);
    comparing(&stage);
    probing(&stage);
    return 0;
}
