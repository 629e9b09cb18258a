/*
 * Aids for bringing up an axis: its trace memory, and test signals on its position.
 *
 *   posicast_trace_arm ─► a move, or posicast_excite ─► posicast_trace_wait ─► posicast_trace_read
 *
 * These functions are for axes whose machine file has a trace; for others they return POSICAST_BAD_ARGUMENT.
 */
#ifndef POSICAST_BRING_UP_H
#define POSICAST_BRING_UP_H

#include <stdint.h>

#include "posicast_driver.h"

#define POSICAST_TRACE_SIGNALS_MAX 4u

typedef struct {
    uint32_t signals; /* number of signals in a row: 1, 2 or 4 */
    uint32_t select[POSICAST_TRACE_SIGNALS_MAX]; /* POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0_..., for every signal */
    uint32_t decimation; /* number of ticks that are skipped between rows */
    uint32_t trigger_mode; /* POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_MODE_... */
    uint32_t trigger_select; /* signal, as in `select`, for the modes rising and falling */
    int32_t trigger_level; /* in the format of that signal */
    uint32_t pre_trigger; /* number of rows before the trigger */
} posicast_trace;

typedef struct {
    uint32_t kind; /* POSICAST_AXIS_EXCITATION_EXCITATION_KIND_... */
    uint32_t amplitude; /* Q8.8 counts; the hardware limits it to that of the machine file */
    uint32_t period_ticks; /* ticks of a bit, of a period, or of a chirp's first period */
    uint32_t sweep; /* for a chirp: rise of the frequency per tick, in 65536ths of the first frequency */
    uint32_t duration_ticks;
} posicast_excitation;

/* Discards the last trace and begins a new one. Returns POSICAST_BAD_ARGUMENT if a number does not fit. */
posicast_result posicast_trace_arm(const posicast_stage *stage, uint32_t axis, const posicast_trace *trace);

/* Waits until the trace is complete. After POSICAST_TIMEOUT the trace keeps waiting. */
posicast_result posicast_trace_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks);

/* Ends the trace now; the rows taken so far can be read. */
posicast_result posicast_trace_halt(const posicast_stage *stage, uint32_t axis);

/* Returns the number of rows, and the index of the trigger's row, counted from 0. */
posicast_result posicast_trace_rows(const posicast_stage *stage, uint32_t axis, uint32_t *rows, uint32_t *trigger_row);

/*
 * Reads one row, with as many words as it has signals; row 0 is the oldest. Returns POSICAST_WRONG_STATE before the trace is
 * complete or halted.
 */
posicast_result posicast_trace_read(const posicast_stage *stage, uint32_t axis, uint32_t row, int32_t *words);

/*
 * Begins a test signal, which ends by itself. Returns POSICAST_WRONG_STATE unless the axis is in HOLD and could start, and
 * POSICAST_BAD_ARGUMENT if a number does not fit.
 */
posicast_result posicast_excite(const posicast_stage *stage, uint32_t axis, const posicast_excitation *excitation);

/* Waits until the test signal is over. Returns POSICAST_FAULT if a cause ended it; after POSICAST_TIMEOUT it is still running. */
posicast_result posicast_excitation_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks);

/* Ends the test signal now. */
posicast_result posicast_excitation_end(const posicast_stage *stage, uint32_t axis);

#endif
