/* Data of the axes from the machine file; machine_NAME.c fills them in. */
#ifndef POSICAST_MACHINE_H
#define POSICAST_MACHINE_H

#include <stdint.h>

#include "posicast_plan.h"
#include "posicast_stage_regs.h"

/* A tap: it contributes coefficient * x[n - delay_samples]. */
typedef struct {
    uint16_t delay_samples;
    int32_t coefficient;
} posicast_tap;

/* A tap table: taps in order of delay, whose coefficients sum to 2^coefficient_fraction. */
typedef struct {
    const posicast_tap *taps;
    uint32_t count;
    uint32_t coefficient_fraction;
} posicast_table;

/* Settings of a controller: its law POSICAST_AXIS_LAW_LAW_..., and its words, indexed by POSICAST_SETTING_... */
typedef struct {
    uint32_t law;
    uint32_t word[POSICAST_SETTINGS];
} posicast_settings;

/* An axis. */
typedef struct {
    const char *name;
    /* Counts of the loop per unit of the axis in the machine file. */
    double counts_per_unit;
    posicast_limits limits;
    /* The table in bank 0. */
    posicast_table table;
    /* The controller's law, with the settings in bank 0. */
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
