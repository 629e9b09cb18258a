/*
 * Registers of an inline shaper: its state, its counts, its tables, and the request for no shaping.
 *
 * The controller at its pins moves the axes; nothing here starts or stops them, and a program that ends changes nothing.
 */
#ifndef POSICAST_INLINE_H
#define POSICAST_INLINE_H

#include <stdint.h>

#include "posicast_inline_regs.h"
#include "posicast_result.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An inline shaper. */
typedef struct {
    uintptr_t base;
    uint32_t axes; /* number of axes */
} posicast_inline;

/* The counts of an axis in one clock, in steps modulo 2^32. */
typedef struct {
    int32_t input; /* of the controller since reset */
    int32_t given; /* to the drive since reset */
    int32_t owed;  /* demanded and still to come */
} posicast_inline_counts;

/* A tap of a table. */
typedef struct {
    uint16_t delay_samples;
    int32_t coefficient; /* in units of 2^-F, F from the register COEFFICIENT_FRACTION */
} posicast_inline_tap;

/*
 * Finds the inline shaper at this address. POSICAST_NOT_FOUND: there is none; POSICAST_VERSION: its registers are of another version;
 * POSICAST_OTHER_MACHINE: it was built from another machine file than this driver.
 */
posicast_result posicast_inline_open(posicast_inline *shaper, uintptr_t base);

/* Returns STATUS of all axes: POSICAST_INLINE_STATUS_RUN_MSK, ..SETTLED.., ..BYPASSED.., ..FAULT... */
uint32_t posicast_inline_status(const posicast_inline *shaper);

/* Returns why an axis has stopped: POSICAST_INLINE_AXIS_CAUSES_INPUT_TOO_FAST_MSK and so on; 0 for no cause, or no such axis. */
uint32_t posicast_inline_causes(const posicast_inline *shaper, uint32_t axis);

/* Freezes the counts of all axes in one clock. */
void posicast_inline_snapshot(const posicast_inline *shaper);

/* Reads the counts of an axis at the last snapshot. */
posicast_result posicast_inline_read_counts(const posicast_inline *shaper, uint32_t axis, posicast_inline_counts *counts);

/*
 * Asks for no shaping, or withdraws the request, and waits at most this many ticks until it holds. The shaping ends, and begins, where all
 * axes are settled. POSICAST_TIMEOUT: an axis moves, or the pin asks for no shaping; the request stays.
 */
posicast_result posicast_inline_bypass(const posicast_inline *shaper, int on, uint32_t ticks);

/*
 * Writes a table to bank 1 or 2, and hands over to it, while the axis stands or moves. POSICAST_BAD_ARGUMENT: it does not fit the
 * hardware, or its coefficients do not sum to one; POSICAST_WRONG_STATE: the bank is in use, or a swap waits. The delays of the axes
 * are then no longer equal, unless the table has the mean delay of the one before.
 */
posicast_result posicast_inline_load_table(const posicast_inline *shaper, uint32_t axis, uint32_t bank,
                                           const posicast_inline_tap *taps, uint32_t count, uint32_t ticks);

/* Hands over to a bank; 0 is the table of the machine. */
posicast_result posicast_inline_use_table(const posicast_inline *shaper, uint32_t axis, uint32_t bank, uint32_t ticks);

/* Reads a tap back; a coefficient of 0 is none. */
posicast_result posicast_inline_read_tap(const posicast_inline *shaper, uint32_t axis, uint32_t bank, uint32_t index,
                                         posicast_inline_tap *tap, uint32_t ticks);

#ifdef __cplusplus
}
#endif

#endif
