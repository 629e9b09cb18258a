/* A program that measures an axis without a sensor at its load: it shakes the motor, and traces the drive's command and the motor's encoder
 * in every tick. */
#include "pipe.h"
#include "posicast_bring_up.h"

#define TRACED(signal) POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0_##signal
int main(void)
{
    /* Every tick, two signals. */
    const posicast_trace trace = {2, {TRACED(COMMAND), TRACED(CAPTURED_POSITION), 0, 0}, 0, 0, 0, 0, 0};
    /* 250 counts, a bit every 1.2 ms. */
    const posicast_excitation shake = {POSICAST_AXIS_EXCITATION_EXCITATION_KIND_PRBS, 250u << 8, 12, 0, 1100};
    posicast_stage stage;
    uint32_t rows, trigger_row, row;
    int32_t words[POSICAST_TRACE_SIGNALS_MAX];
    char name[32];

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    need("switch on", posicast_switch_on(&stage, 1u << X, TICKS), POSICAST_OK);
    need("a trace", posicast_trace_arm(&stage, X, &trace), POSICAST_OK);
    need("a test signal", posicast_excite(&stage, X, &shake), POSICAST_OK);
    need("the trace", posicast_trace_wait(&stage, X, 5 * TICKS), POSICAST_OK);
    need("rows", posicast_trace_rows(&stage, X, &rows, &trigger_row), POSICAST_OK);
    result("rows", rows);
    for (row = 0; row < rows; row++) {
        need("a row", posicast_trace_read(&stage, X, row, words), POSICAST_OK);
        (void)snprintf(name, sizeof name, "command_%" PRIu32, row);
        result(name, words[0]);
        (void)snprintf(name, sizeof name, "captured_position_%" PRIu32, row);
        result(name, words[1]);
    }
    result("causes", posicast_causes(&stage, X));
    return 0;
}
