/*
 * Looking at an axis while it is brought up: its trace memory, and test signals on its position.
 *
 *   posicast_trace_arm ─► a move, or posicast_excite ─► posicast_trace_wait ─► posicast_trace_read
 *
 * For axes whose machine file asks for a trace; every function answers POSICAST_BAD_ARGUMENT for one that has none.
 */
#ifndef POSICAST_BRING_UP_H
#define POSICAST_BRING_UP_H

#include <stdint.h>

#include "posicast_driver.h"

#define POSICAST_TRACE_SIGNALS_MAX 4u

typedef struct {
    uint32_t signals; /* in a row: 1, 2 or 4 */
    uint32_t select[POSICAST_TRACE_SIGNALS_MAX]; /* POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0_..., of all places */
    uint32_t decimation; /* ticks that are left out between rows */
    uint32_t trigger_mode; /* POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_MODE_... */
    uint32_t trigger_select; /* as `select`; modes rising and falling look at it */
    int32_t trigger_level; /* in the words of that signal */
    uint32_t pre_trigger; /* rows before the trigger */
} posicast_trace;

typedef struct {
    uint32_t kind; /* POSICAST_AXIS_EXCITATION_EXCITATION_KIND_... */
    uint32_t amplitude; /* Q8.8 counts; the hardware cuts it to that of the machine file */
    uint32_t period_ticks; /* a bit, a period, or a chirp's first */
    uint32_t sweep; /* of a chirp: rise of the frequency per tick, in 65536ths of the first */
    uint32_t duration_ticks;
} posicast_excitation;

/* Forgets the last trace and begins one. POSICAST_BAD_ARGUMENT for numbers that do not fit. */
posicast_result posicast_trace_arm(const posicast_stage *stage, uint32_t axis, const posicast_trace *trace);

/* Until the trace is complete. POSICAST_TIMEOUT leaves it waiting. */
posicast_result posicast_trace_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks);

/* Ends it now; what is there can be read. */
posicast_result posicast_trace_halt(const posicast_stage *stage, uint32_t axis);

/* How many rows there are, and which of them is that of the trigger, from 0. */
posicast_result posicast_trace_rows(const posicast_stage *stage, uint32_t axis, uint32_t *rows, uint32_t *trigger_row);

/* One row, as many words as it has signals, the oldest row being 0. POSICAST_WRONG_STATE while the trace is not over. */
posicast_result posicast_trace_read(const posicast_stage *stage, uint32_t axis, uint32_t row, int32_t *words);

/*
 * Begins a test signal, of an axis in HOLD that could start: POSICAST_WRONG_STATE. POSICAST_BAD_ARGUMENT for numbers that do not
 * fit. It ends by itself.
 */
posicast_result posicast_excite(const posicast_stage *stage, uint32_t axis, const posicast_excitation *excitation);

/* Until the test signal is over. POSICAST_FAULT where a cause ended it; POSICAST_TIMEOUT leaves it running. */
posicast_result posicast_excitation_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks);

/* Ends it now. */
posicast_result posicast_excitation_end(const posicast_stage *stage, uint32_t axis);

#endif
