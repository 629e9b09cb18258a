/*
 * What the programs that measure an axis have in common: they shake the motor, trace two signals, and write the rows.
 */
#ifndef MEASURE_H
#define MEASURE_H

#include "pipe.h"
#include "posicast_bring_up.h"

#define TRACED(signal) POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0_##signal

/* Switches axis X on, shakes it, and waits until the trace is complete. */
static inline void measure(posicast_stage *stage, const posicast_trace *trace, const posicast_excitation *shake)
{
    need("open", posicast_open(stage, BASE), POSICAST_OK);
    stage->pause = pause_here;
    need("switch on", posicast_switch_on(stage, 1u << X, TICKS), POSICAST_OK);
    need("a trace", posicast_trace_arm(stage, X, trace), POSICAST_OK);
    need("a test signal", posicast_excite(stage, X, shake), POSICAST_OK);
    need("the trace", posicast_trace_wait(stage, X, 5 * TICKS), POSICAST_OK);
}

/* Writes each row as NAME_ROW for both signals, and the causes at the end. */
static inline void write_rows(posicast_stage *stage, const char *first, const char *second)
{
    uint32_t rows, trigger_row, row;
    int32_t words[POSICAST_TRACE_SIGNALS_MAX];
    char name[32];

    need("rows", posicast_trace_rows(stage, X, &rows, &trigger_row), POSICAST_OK);
    result("rows", rows);
    for (row = 0; row < rows; row++) {
        need("a row", posicast_trace_read(stage, X, row, words), POSICAST_OK);
        (void)snprintf(name, sizeof name, "%s_%" PRIu32, first, row);
        result(name, words[0]);
        (void)snprintf(name, sizeof name, "%s_%" PRIu32, second, row);
        result(name, words[1]);
    }
    result("causes", posicast_causes(stage, X));
}

#endif
