/*
 * Tap tables of an axis whose modes move with load, position or height: which one a value asks for, and the change to it.
 * machine_NAME.h has the family of each such axis.
 *
 *     uint32_t wanted = posicast_table_for(family, in_use, value);
 *     if (wanted != in_use && posicast_select_table(stage, axis, family, wanted, how, ticks) == POSICAST_OK)
 *         in_use = wanted;
 *
 * After a reset family->nominal is in use.
 */
#ifndef POSICAST_FAMILY_H
#define POSICAST_FAMILY_H

#include "posicast_driver.h"

/* A table, and where it is used. */
typedef struct {
    /* It is designed for this value of the variable. */
    double value;
    /* Below this value the table before it is used, above the next one the table after it. */
    double down;
    double up;
    posicast_table table;
} posicast_family_member;

/* The tables of an axis, in the order of the variable. */
typedef struct {
    /* What the modes move with; a position is in the unit of the machine file. */
    const char *variable;
    /* Place of the table that is in bank 0. */
    uint32_t nominal;
    uint32_t count;
    const posicast_family_member *member;
} posicast_family;

/*
 * Place of the table for a value, where that of place `in_use` is in use: the same one up to its thresholds. A value that is not a number
 * changes nothing.
 */
uint32_t posicast_table_for(const posicast_family *family, uint32_t in_use, double value);

/*
 * Changes to the table of a place as `how` says (POSICAST_AXIS_SWAP_SWAP_HOW_...): it is loaded into the bank that is free, or is the
 * machine's own. Waits until the change is over; in motion, as long as the longer table lasts. POSICAST_BAD_ARGUMENT for a place
 * beyond the tables; else as posicast_load_table.
 */
posicast_result posicast_select_table(const posicast_stage *stage, uint32_t axis, const posicast_family *family,
                                      uint32_t place, uint32_t how, uint32_t ticks);

#endif
