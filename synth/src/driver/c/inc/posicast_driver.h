/*
 * The driver of a stage: from reset to moves, tap tables, positions and faults.
 *
 *   posicast_open ─► posicast_switch_on ─► posicast_queue_move ─► posicast_start ─► posicast_wait_at_rest
 *                        ▲                                                            │ POSICAST_FAULT
 *                        └──────────────────────── posicast_causes ◄──────────────────┘
 *
 * It needs nothing but access to the registers: no heap, no clock, no operating system. Time is the stage's own, in ticks. Every
 * wait ends: when what it waits for has come, when its ticks are over, or when time stands still. While it waits it kicks the
 * watchdogs and calls `pause`, if there is one.
 *
 * `axis` counts from 0 in the order of the machine file; `axes` is a mask, bit k for axis k. A stage belongs to one thread at a
 * time; an interrupt may call posicast_take_interrupts.
 */
#ifndef POSICAST_DRIVER_H
#define POSICAST_DRIVER_H

#include <stdint.h>

#include "posicast_io.h"
#include "posicast_machine.h"
#include "posicast_plan.h"
#include "posicast_result.h"
#include "posicast_segments.h"
#include "posicast_stage_regs.h"

typedef struct {
    uintptr_t base;
    /* Read from the hardware. */
    uint32_t axes;
    uint32_t tick_clocks;
    /* Called over and over while the driver waits, with `context`; 0: it polls. */
    void (*pause)(void *context);
    void *context;
} posicast_stage;

/* All axes in one clock. */
typedef struct {
    uint32_t time_stamp; /* clocks since reset, modulo 2^32 */
    uint32_t tick_count; /* ticks since reset, modulo 2^32 */
    int32_t position[POSICAST_AXES_MAX]; /* counts, from the origin */
    int32_t velocity[POSICAST_AXES_MAX]; /* counts per tick, Q16.16, at the last tick */
} posicast_snapshot;

/* Clocks in a period of the PWM that a self-test counted, behind no pin. */
typedef struct {
    uint32_t a_high;
    uint32_t a_low;
} posicast_self_test_clocks;

/* Finds the stage at `base`. POSICAST_NOT_FOUND, POSICAST_VERSION. Sets `pause` to 0. */
posicast_result posicast_open(posicast_stage *stage, uintptr_t base);

/* Mask of all axes. */
uint32_t posicast_all_axes(const posicast_stage *stage);

/* POSICAST_AXIS_STATUS_STATE_... of an axis. */
uint32_t posicast_state(const posicast_stage *stage, uint32_t axis);

/* For the watchdogs of all axes; while a function waits, it does so itself. */
void posicast_kick(const posicast_stage *stage);

/* Lets so many ticks pass. POSICAST_DEAD. */
posicast_result posicast_wait_ticks(const posicast_stage *stage, uint32_t ticks);

/*
 * Forgets what was wrong, switches on, and waits until the brakes are open and each axis holds its position: HOLD. Axes that hold
 * already stay as they are. POSICAST_WRONG_STATE for one that moves; POSICAST_FAULT where a cause does not go away.
 */
posicast_result posicast_switch_on(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Off, through a stop and the brakes; waits until the outputs are off. */
posicast_result posicast_switch_off(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/*
 * Puts an entry into an axis's FIFO. POSICAST_BAD_ARGUMENT without ticks; POSICAST_FULL; POSICAST_REFUSED where it is
 * not kept, as in a stop or while off.
 */
posicast_result posicast_write_entry(const posicast_stage *stage, uint32_t axis, const posicast_entry *entry);

/*
 * The same of a batch, with one check at its end: all of these entries are taken, or none. A batch costs 3 or 4 accesses per entry and 8
 * beside them. POSICAST_BAD_ARGUMENT for none, or for more than POSICAST_FIFO_ENTRIES.
 */
posicast_result posicast_write_entries(const posicast_stage *stage, uint32_t axis, const posicast_entry *entries,
                                       uint32_t count);

/*
 * Plans a move of an axis in HOLD from where its command stands to `end` and puts it into the empty FIFO; posicast_start
 * moves it. `end` is in Q24.8 counts since reset, as COUNT has them; POSITION is COUNT less ORIGIN. As posicast_plan_move;
 * POSICAST_WRONG_STATE.
 */
posicast_result posicast_queue_move(const posicast_stage *stage, uint32_t axis, int32_t end,
                                    const posicast_limits *limits);

/* All these axes start in one tick, or none: POSICAST_REFUSED. */
posicast_result posicast_start(const posicast_stage *stage, uint32_t axes);

/*
 * Until the commands have ended and the shaped commands with them. POSICAST_FAULT as soon as one of them has a cause;
 * POSICAST_TIMEOUT leaves it moving.
 */
posicast_result posicast_wait_at_rest(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Quick stop through the shaper, then HOLD; does not wait. What waits in the FIFOs is dropped. */
void posicast_stop(const posicast_stage *stage, uint32_t axes);

/*
 * Feed hold: the axes of the mask play on until their commands are at rest in the same tick. There they stand, in RUN, and keep
 * what waits in their FIFOs. 0 resumes: all go on in one tick, to exactly where they would have ended. It stays until it is
 * changed, through a start too: docs/segments.md. POSICAST_BAD_ARGUMENT.
 */
posicast_result posicast_feed_hold(const posicast_stage *stage, uint32_t axes);

/*
 * Until the commands of these axes, in a feed hold, stand and the shaped commands with them. As posicast_wait_at_rest;
 * POSICAST_WRONG_STATE for one that is not told to hold.
 */
posicast_result posicast_wait_held(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Positions and velocities of all axes in one clock. */
void posicast_take_snapshot(const posicast_stage *stage, posicast_snapshot *snapshot);

/* Where the command of an axis is, before the shaper: Q24.8 counts since reset. */
int32_t posicast_command_position(const posicast_stage *stage, uint32_t axis);

/* POSICAST_CAUSE_... of an axis, sticky; posicast_switch_on forgets those that are over. */
uint32_t posicast_causes(const posicast_stage *stage, uint32_t axis);

/* The name of the lowest cause, or "none". */
const char *posicast_cause_name(uint32_t causes);

/*
 * Loads a table into bank 1 or 2 of an axis, where it is not in use, and makes it active as `how` says
 * (POSICAST_AXIS_SWAP_SWAP_HOW_...). The time that a stop is given to settle grows with it. POSICAST_BAD_ARGUMENT for a table that
 * the hardware does not hold; POSICAST_WRONG_STATE while the bank is in use or a swap waits; POSICAST_REFUSED.
 */
posicast_result posicast_load_table(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                    const posicast_table *table, uint32_t how, uint32_t ticks);

/* Back to the machine's own table, or to one that was loaded. */
posicast_result posicast_use_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t how,
                                   uint32_t ticks);

/*
 * Reads back the table in bank 0 (the machine's), 1 or 2 of an axis, in use or not: the first `room` taps into `taps`, and how many the
 * bank holds into `count`, 0 where nothing was loaded since reset. A tap of coefficient and delay 0 ends it; posicast_load_table
 * loads none. The machine runs on. POSICAST_BAD_ARGUMENT; POSICAST_TIMEOUT where `ticks` are over.
 */
posicast_result posicast_read_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, posicast_tap *taps,
                                    uint32_t room, uint32_t *count, uint32_t ticks);

/*
 * Runs the PWM of an axis with this duty (clocks) while pins, drive and brake stay off, and counts. The axis must be READY:
 * POSICAST_WRONG_STATE. What the counts should be depends on the PWM: docs/pwm.md; both 0 is a PWM that does not run.
 */
posicast_result posicast_self_test(const posicast_stage *stage, uint32_t axis, int32_t duty,
                                   posicast_self_test_clocks *counted);

/* Which interrupts raise the line: POSICAST_AXIS_INTERRUPT(axis, ...), POSICAST_STAGE_INTERRUPT_STATE_..._MSK. */
void posicast_enable_interrupts(const posicast_stage *stage, uint32_t interrupts);

/* The enabled interrupts that have happened; they are forgotten, and the line falls. */
uint32_t posicast_take_interrupts(const posicast_stage *stage);

#endif
