/*
 * Error tables: the measured error of a screw or a scale, which the hardware takes from the position reference. After a reset the
 * machine file's table counts, once the host has said that the axis is homed: docs/error_table.md.
 *
 *     int32_t entries[POSICAST_ERROR_ENTRIES_MAX];
 *     posicast_error_entries(&format, points, count, entries)      from what was measured
 *     posicast_load_error_table(stage, axis, entries, format.entries, ticks)
 *
 * The error in force comes and goes within POSICAST_ERROR_WEIGHT_FULL ticks, so nothing jumps. Before an axis is homed anew, switch its
 * table off: the origin is taken while it is off.
 */
#ifndef POSICAST_ERROR_TABLE_H
#define POSICAST_ERROR_TABLE_H

#include "posicast_driver.h"

#define POSICAST_ERROR_ENTRIES_MAX 256u
#define POSICAST_ERROR_WEIGHT_FULL 1024u

/* Where the entries of an axis are, and what they mean. */
typedef struct {
    int32_t first;          /* position of entry 0, counts from the origin */
    uint32_t spacing;       /* counts from entry to entry */
    uint32_t entries;       /* of a table */
    uint32_t fraction_bits; /* an entry of 1 is 2^-fraction_bits counts */
} posicast_error_format;

/* What was measured at a position: true less counted position. Both in counts. */
typedef struct {
    double position;
    double error;
} posicast_error_point;

/* As the axis was built. POSICAST_BAD_ARGUMENT for one without an error table. */
posicast_result posicast_error_format_of(const posicast_stage *stage, uint32_t axis, posicast_error_format *format);

/*
 * The entries of a table from points in order of position: linear between two points, that of the nearest one outside.
 * POSICAST_BAD_ARGUMENT for no point, positions that do not increase, and errors that an entry does not hold.
 */
posicast_result posicast_error_entries(const posicast_error_format *format, const posicast_error_point *points,
                                       uint32_t count, int32_t *entries);

/*
 * Loads a table and uses it. Where a loaded one is in use, that is left first. POSICAST_BAD_ARGUMENT for another number of entries
 * than the axis has, and entries of more than 18 bits; POSICAST_REFUSED for neighbours that differ by more than a sixteenth of their
 * distance: then nothing is compensated until a table is chosen.
 */
posicast_result posicast_load_error_table(const posicast_stage *stage, uint32_t axis, const int32_t *entries,
                                          uint32_t count, uint32_t ticks);

/*
 * The machine file's table, 0, or the one that was loaded, 1. Waits until it is the one in use; its error then comes in force.
 * POSICAST_WRONG_STATE for a loaded one that is not complete.
 */
posicast_result posicast_use_error_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t ticks);

/* Compensates, or not. Waits, if not, until nothing of the error is in force. */
posicast_result posicast_enable_error_table(const posicast_stage *stage, uint32_t axis, int enabled, uint32_t ticks);

/* Reads back a table: the first `room` entries. As posicast_read_table. */
posicast_result posicast_read_error_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, int32_t *entries,
                                          uint32_t room, uint32_t ticks);

/* How much of the error is in force: 0 to POSICAST_ERROR_WEIGHT_FULL. */
uint32_t posicast_error_weight(const posicast_stage *stage, uint32_t axis);

/* The error in force, Q24.8 counts: the axis stands at its counted position and this. */
int32_t posicast_error_now(const posicast_stage *stage, uint32_t axis);

#endif
