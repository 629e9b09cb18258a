/*
 * Tap tables of an axis whose modes move with load, position or height: selection of the table for a value, and the change to it.
 * machine_NAME.h has the family of each such axis.
 *
 *     uint32_t wanted = posicast_table_for(family, in_use, value);
 *     if (wanted != in_use && posicast_select_table(stage, axis, family, wanted, how, ticks) == POSICAST_OK)
 *         in_use = wanted;
 *
 * After a reset, the table family->nominal is active.
 */
#ifndef POSICAST_FAMILY_H
#define POSICAST_FAMILY_H

#include "posicast_driver.h"

/* A table, and the range of values for which it is used. */
typedef struct {
    /* Value of the variable for which the table is designed. */
    double value;
    /* Below `down` the previous table is used, above `up` the next one. */
    double down;
    double up;
    posicast_table table;
} posicast_family_member;

/* The tables of an axis, in the order of the variable. */
typedef struct {
    /* Variable on which the modes depend; a position is in the unit of the machine file. */
    const char *variable;
    /* Index of the table in bank 0. */
    uint32_t nominal;
    uint32_t count;
    const posicast_family_member *member;
} posicast_family;

/*
 * Returns the index of the table for a value while the table with index `in_use` is active; that one stays within its thresholds.
 * A value that is not a number changes nothing.
 */
uint32_t posicast_table_for(const posicast_family *family, uint32_t in_use, double value);

/*
 * Changes to the table with index `place` in the way `how` (POSICAST_AXIS_SWAP_SWAP_HOW_...): it is loaded into a free bank unless
 * it is the machine's own. Waits until the change is complete, which in motion takes as long as the longer table. Returns
 * POSICAST_BAD_ARGUMENT for an invalid index, otherwise what posicast_load_table returns.
 */
posicast_result posicast_select_table(const posicast_stage *stage, uint32_t axis, const posicast_family *family,
                                      uint32_t place, uint32_t how, uint32_t ticks);

#endif
