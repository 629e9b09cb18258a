/*
 * The driver of a stage: from reset to moves, tap tables, positions and faults.
 *
 *   posicast_open ─► posicast_switch_on ─► posicast_queue_move ─► posicast_start ─► posicast_wait_at_rest
 *                        ▲                                                            │ POSICAST_FAULT
 *                        └──────────────────────── posicast_causes ◄──────────────────┘
 *
 * It needs only access to the registers: no heap, no clock, no operating system. Time is measured by the stage, in ticks. Every
 * wait ends: when its condition is met, when its ticks are over, or when the time stands still. While the driver waits, it kicks
 * the watchdogs and calls `pause`, if it is set.
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

/* A constant of the stage that posicast_open has refused. */
typedef struct {
    const char *name; /* of its register; 0: nothing was refused */
    uint32_t found;   /* in the stage */
    uint32_t wanted;  /* by the machine file from which this driver was generated */
} posicast_refused;

typedef struct {
    uintptr_t base;
    posicast_refused refused;
    /* Read from the hardware. */
    uint32_t axes;
    uint32_t tick_clocks;
    /* Called repeatedly with `context` while the driver waits; if it is 0, the driver only polls. */
    void (*pause)(void *context);
    void *context;
} posicast_stage;

/* Values of all axes, taken in the same clock. */
typedef struct {
    uint32_t time_stamp; /* number of clocks since reset, modulo 2^32 */
    uint32_t tick_count; /* number of ticks since reset, modulo 2^32 */
    int32_t position[POSICAST_AXES_MAX]; /* counts, from the origin */
    int32_t velocity[POSICAST_AXES_MAX]; /* counts per tick, Q16.16, at the last tick */
} posicast_snapshot;

/* Numbers of clocks in a period of the PWM that a self-test counted, with the pins off. */
typedef struct {
    uint32_t a_high;
    uint32_t a_low;
} posicast_self_test_clocks;

/*
 * Finds the stage at `base` and sets `pause` to 0. Returns POSICAST_NOT_FOUND, POSICAST_VERSION or POSICAST_OTHER_MACHINE if there is none
 * that this driver suits; `refused` then has both values. The machine is compared by the number of axes, the clocks per tick and, where the
 * stage has it ([link] of the machine file), the checksum MACHINE_CRC.
 */
posicast_result posicast_open(posicast_stage *stage, uintptr_t base);

/* Returns the mask of all axes. */
uint32_t posicast_all_axes(const posicast_stage *stage);

/* Returns the state of an axis: POSICAST_AXIS_STATUS_STATE_... */
uint32_t posicast_state(const posicast_stage *stage, uint32_t axis);

/* Kicks the watchdogs of all axes; functions that wait do so themselves. */
void posicast_kick(const posicast_stage *stage);

/* Waits for this many ticks. Returns POSICAST_DEAD if the time stands still. */
posicast_result posicast_wait_ticks(const posicast_stage *stage, uint32_t ticks);

/*
 * Clears the faults, switches on, and waits until the brakes are released and each axis holds its position: HOLD. Axes that are
 * in HOLD already do not change. Returns POSICAST_WRONG_STATE if an axis moves, and POSICAST_FAULT if a cause persists.
 */
posicast_result posicast_switch_on(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Stops the axes, applies the brakes and switches off; waits until the outputs are off. */
posicast_result posicast_switch_off(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/*
 * Puts an entry into an axis's FIFO. Returns POSICAST_BAD_ARGUMENT for an entry of 0 ticks, POSICAST_FULL, or POSICAST_REFUSED
 * if the axis does not keep the entry, for example during a stop or while off.
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

/* Starts all these axes in the same tick; returns POSICAST_REFUSED if none of them has started. */
posicast_result posicast_start(const posicast_stage *stage, uint32_t axes);

/*
 * Waits until the commands and the shaped commands of the axes have ended. Returns POSICAST_FAULT as soon as one of them has a
 * cause; after POSICAST_TIMEOUT the axes still move.
 */
posicast_result posicast_wait_at_rest(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Starts a quick stop through the shaper, which ends in HOLD; does not wait. The entries in the FIFOs are discarded. */
void posicast_stop(const posicast_stage *stage, uint32_t axes);

/*
 * Sets the feed hold: the axes of the mask continue until their commands are at rest in the same tick. Then they stand still in
 * RUN and keep the entries in their FIFOs. A mask of 0 resumes: all axes continue in the same tick, to exactly the positions
 * where they would have ended. The mask stays until it is changed, also through a start; see docs/segments.md. Returns
 * POSICAST_BAD_ARGUMENT for an invalid mask.
 */
posicast_result posicast_feed_hold(const posicast_stage *stage, uint32_t axes);

/*
 * Waits until the commands and the shaped commands of these axes, in a feed hold, stand still. Returns what
 * posicast_wait_at_rest returns, or POSICAST_WRONG_STATE if an axis is not in the feed hold's mask.
 */
posicast_result posicast_wait_held(const posicast_stage *stage, uint32_t axes, uint32_t ticks);

/* Takes the positions and velocities of all axes in the same clock. */
void posicast_take_snapshot(const posicast_stage *stage, posicast_snapshot *snapshot);

/* Returns the command position of an axis before the shaper, in Q24.8 counts since reset. */
int32_t posicast_command_position(const posicast_stage *stage, uint32_t axis);

/* Returns the causes POSICAST_CAUSE_... of an axis. They are sticky; posicast_switch_on clears those that are over. */
uint32_t posicast_causes(const posicast_stage *stage, uint32_t axis);

/* Returns the name of the lowest cause, or "none". */
const char *posicast_cause_name(uint32_t causes);

/*
 * Loads a table into bank 1 or 2 of an axis, which must not be active, and activates it in the way `how`
 * (POSICAST_AXIS_SWAP_SWAP_HOW_...). The settling time of a stop grows with the table. Returns POSICAST_BAD_ARGUMENT if the
 * table does not fit the hardware, POSICAST_WRONG_STATE while the bank is active or a swap is pending, or POSICAST_REFUSED.
 */
posicast_result posicast_load_table(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                    const posicast_table *table, uint32_t how, uint32_t ticks);

/* Activates the machine's own table in bank 0, or one that was loaded before. */
posicast_result posicast_use_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t how,
                                   uint32_t ticks);

/*
 * Reads back the table in bank 0 (the machine's own), 1 or 2 of an axis, active or not: the first `room` taps into `taps`, and
 * the bank's number of taps into `count`, which is 0 if nothing was loaded since reset. A tap with coefficient and delay 0 ends
 * the table; posicast_load_table never loads one. The machine keeps running. Returns POSICAST_BAD_ARGUMENT, or POSICAST_TIMEOUT
 * after `ticks`.
 */
posicast_result posicast_read_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, posicast_tap *taps,
                                    uint32_t room, uint32_t *count, uint32_t ticks);

/*
 * Runs the PWM of an axis with this duty (clocks) while pins, drive and brake stay off, and counts. Returns POSICAST_WRONG_STATE
 * unless the axis is READY. The expected counts depend on the PWM, see docs/pwm.md; if both are 0, the PWM does not run.
 */
posicast_result posicast_self_test(const posicast_stage *stage, uint32_t axis, int32_t duty,
                                   posicast_self_test_clocks *counted);

/* Sets the interrupts that raise the line: POSICAST_AXIS_INTERRUPT(axis, ...), POSICAST_STAGE_INTERRUPT_STATE_..._MSK. */
void posicast_enable_interrupts(const posicast_stage *stage, uint32_t interrupts);

/* Returns the enabled interrupts that have occurred and clears them, so that the line falls. */
uint32_t posicast_take_interrupts(const posicast_stage *stage);

#endif
