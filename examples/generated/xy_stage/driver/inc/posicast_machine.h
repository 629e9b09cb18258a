/* What the machine file says of the axes: filled in by machine_NAME.c. */
#ifndef POSICAST_MACHINE_H
#define POSICAST_MACHINE_H

#include <stdint.h>

#include "posicast_plan.h"
#include "posicast_stage_regs.h"

/* coefficient * x[n - delay_samples] */
typedef struct {
    uint16_t delay_samples;
    int32_t coefficient;
} posicast_tap;

/* Taps in order of delay; the coefficients sum to 2^coefficient_fraction. */
typedef struct {
    const posicast_tap *taps;
    uint32_t count;
    uint32_t coefficient_fraction;
} posicast_table;

/* A controller: POSICAST_AXIS_LAW_LAW_..., and its words by POSICAST_SETTING_... */
typedef struct {
    uint32_t law;
    uint32_t word[POSICAST_SETTINGS];
} posicast_settings;

/* An axis. */
typedef struct {
    const char *name;
    /* Of the loop, per unit of the axis in the machine file. */
    double counts_per_unit;
    posicast_limits limits;
    /* The table that is in bank 0. */
    posicast_table table;
    /* What computes the command, with the settings that are in bank 0. */
    posicast_settings settings;
} posicast_axis_machine;

/* A machine. */
typedef struct {
    const char *name;
    double tick_hz;
    uint32_t axes;
    const posicast_axis_machine *axis;
} posicast_machine;

#endif
