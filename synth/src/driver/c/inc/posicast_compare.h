/*
 * Position compare: an axis with [axis.compare] pulses its line `compare` where it passes positions, for a camera or a laser.
 *
 * Positions are counts from the origin, as it is when the compare is armed. docs/compare.md says which passages give a pulse, and when.
 */
#ifndef POSICAST_COMPARE_H
#define POSICAST_COMPARE_H

#include <stdint.h>

#include "posicast_driver.h"

/* Positions first, first + spacing, ..., `positions` of them. */
typedef struct {
    int32_t first;
    uint32_t spacing;
    uint32_t positions;
} posicast_row;

/*
 * Arms the compare, and waits until it is ready: a clock for each position of a row below the axis, three for each of a list. A list
 * has up to 256 positions that increase by 4 counts or more. Directions, hysteresis and the width of a pulse are those of the
 * registers COMPARE_CONTROL and COMPARE_PULSE, which have the machine's values after a reset.
 *
 * Returns POSICAST_BAD_ARGUMENT for an axis without [axis.compare] and for positions that the hardware cannot have,
 * POSICAST_TIMEOUT if it is not ready after `ticks`.
 */
posicast_result posicast_compare_row(const posicast_stage *stage, uint32_t axis, const posicast_row *row, uint32_t ticks);
posicast_result posicast_compare_list(const posicast_stage *stage, uint32_t axis, const int32_t *positions, uint32_t number,
                                      uint32_t ticks);

/* Disarms it; a pulse that has begun goes on. */
posicast_result posicast_compare_off(const posicast_stage *stage, uint32_t axis);

/* Pulses since it was armed, modulo 2^32. */
uint32_t posicast_compare_passes(const posicast_stage *stage, uint32_t axis);

/* Word of COMPARE_STATE; 0 for an axis without [axis.compare]. */
uint32_t posicast_compare_state(const posicast_stage *stage, uint32_t axis);

#endif
