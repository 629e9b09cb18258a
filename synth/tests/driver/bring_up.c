/* A program that brings up an axis with homing, trace memory and a test signal. */
#include "pipe.h"
#include "posicast_bring_up.h"
#include "posicast_homing.h"

#define TRACED(signal) POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0_##signal

static void move_to(posicast_stage *stage, int32_t end)
{
    need("a move", posicast_queue_move(stage, X, end, limits_of(X)), POSICAST_OK);
    need("its start", posicast_start(stage, 1u << X), POSICAST_OK);
    need("its end", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
}

static void homing(posicast_stage *stage)
{
    posicast_homing how = {*limits_of(X), COUNTS(10), COUNTS(-40), 1000};
    int32_t origin;

    /* 0.3 counts per tick. */
    how.limits.velocity = ((int64_t)3 << 32) / 10;
    need("no such axis", posicast_home(stage, 2, &how, TICKS), POSICAST_BAD_ARGUMENT);
    need("an axis that is off", posicast_home(stage, X, &how, TICKS), POSICAST_WRONG_STATE);
    need("switch on", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    need("a switch too far away", posicast_home(stage, X, &how, TICKS), POSICAST_NO_REFERENCE);
    how.switch_within = COUNTS(60);
    how.index_within = COUNTS(-3);
    need("an index too far away", posicast_home(stage, X, &how, TICKS), POSICAST_NO_REFERENCE);
    need("no time", posicast_home(stage, X, &how, 5), POSICAST_TIMEOUT);
    need("the stop", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
    how.index_within = COUNTS(-40);
    need("homing", posicast_home(stage, X, &how, TICKS), POSICAST_OK);
    origin = posicast_origin(stage, X);
    result("origin_by_index", origin);
    result("index_setup", IORD_POSICAST_AXIS_INDEX(stage->base, X));
    /* The index comes once more and must have no effect. */
    move_to(stage, COUNTS(-10));
    move_to(stage, COUNTS(45));
    result("origin_moves", posicast_origin(stage, X) - origin);
    result("homed_before", posicast_is_homed(stage, X));
    need("limits the wrong way round", posicast_limit_travel(stage, X, COUNTS(10), COUNTS(-10)), POSICAST_BAD_ARGUMENT);
    need("limits too far away", posicast_limit_travel(stage, X, INT32_MIN, INT32_MAX), POSICAST_BAD_ARGUMENT);
    /* The index is position 1000, and the axis is a few counts from it. */
    need("limits of the travel", posicast_limit_travel(stage, X, COUNTS(800), COUNTS(1200)), POSICAST_OK);
    result("homed_after", posicast_is_homed(stage, X));
    result("limit_minus", (int32_t)IORD_POSICAST_AXIS_SOFT_LIMIT_MINUS(stage->base, X) - COUNTS(origin));
    result("limit_plus", (int32_t)IORD_POSICAST_AXIS_SOFT_LIMIT_PLUS(stage->base, X) - COUNTS(origin));
    how.index_within = 0;
    how.position = 0;
    need("homing from on the switch", posicast_home(stage, X, &how, TICKS), POSICAST_OK);
    result("origin_by_switch", posicast_origin(stage, X));
}

static void looking(posicast_stage *stage)
{
    posicast_trace trace = {4, {TRACED(SHAPED_POSITION), TRACED(CAPTURED_POSITION), TRACED(ERROR),
                                TRACED(EXCITATION_VALUE)}, 1, 0, 0, 0, 0};
    const posicast_excitation square = {POSICAST_AXIS_EXCITATION_EXCITATION_KIND_SQUARE, 3u << 8, 20, 0, 100};
    uint32_t rows, trigger_row, row;
    int32_t most = 0, least = 0, furthest = INT32_MIN, nearest = INT32_MAX;
    int32_t words[POSICAST_TRACE_SIGNALS_MAX];

    need("an axis without a trace", posicast_trace_arm(stage, Y, &trace), POSICAST_BAD_ARGUMENT);
    need("an axis without test signals", posicast_excite(stage, Y, &square), POSICAST_BAD_ARGUMENT);
    trace.signals = 3;
    need("three signals", posicast_trace_arm(stage, X, &trace), POSICAST_BAD_ARGUMENT);
    trace.signals = 4;
    need("a trace", posicast_trace_arm(stage, X, &trace), POSICAST_OK);
    need("a trace that runs", posicast_trace_wait(stage, X, 5), POSICAST_TIMEOUT);
    need("half a trace", posicast_trace_halt(stage, X), POSICAST_OK);
    need("a trace again", posicast_trace_arm(stage, X, &trace), POSICAST_OK);
    need("reading too early", posicast_trace_rows(stage, X, &rows, &trigger_row), POSICAST_OK);
    need("a square", posicast_excite(stage, X, &square), POSICAST_OK);
    need("its end", posicast_excitation_wait(stage, X, TICKS), POSICAST_OK);
    need("another", posicast_excite(stage, X, &square), POSICAST_OK);
    need("an end to it", posicast_excitation_end(stage, X), POSICAST_OK);
    need("the trace", posicast_trace_wait(stage, X, TICKS), POSICAST_OK);
    need("rows", posicast_trace_rows(stage, X, &rows, &trigger_row), POSICAST_OK);
    result("rows", rows);
    result("trigger_row", trigger_row);
    for (row = 0; row < rows; row++) {
        need("a row", posicast_trace_read(stage, X, row, words), POSICAST_OK);
        most = words[3] > most ? words[3] : most;
        least = words[3] < least ? words[3] : least;
        furthest = words[1] > furthest ? words[1] : furthest;
        nearest = words[1] < nearest ? words[1] : nearest;
    }
    need("a row too many", posicast_trace_read(stage, X, rows, words), POSICAST_BAD_ARGUMENT);
    result("most", most);
    result("least", least);
    result("moved", furthest - nearest);
    result("causes", posicast_causes(stage, X));
}

int main(void)
{
    posicast_stage stage;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    homing(&stage);
    looking(&stage);
    return 0;
}
