/* The pins of the component, and what is done while it is loaded. */
#ifndef POSICAST_LOAD_H
#define POSICAST_LOAD_H

#include "rtapi.h"
#include "hal.h"

#include "posicast_driver.h"

/* Banks of the machine's own table, and of the one that does not shape. */
#define SHAPED   0u
#define UNSHAPED 1u

typedef struct {
    hal_float_t *pos_cmd, *vel_cmd, *pos_fb, *vel_fb, *following_error;
    hal_bit_t *enable, *fault, *index_enable, *home, *limit_plus, *limit_minus;
    hal_u32_t *cause, *shaper;
    /* Of a stage with [capture]. */
    hal_float_t *probed;
} posicast_axis_pins;

typedef struct {
    posicast_axis_pins axis[POSICAST_AXES_MAX];
    hal_bit_t *ok;
    /* Of a stage with [capture]. */
    hal_bit_t *probe_input;
    hal_u32_t *probe_edges;
    hal_u32_t *phase, *level, *late_ticks, *accesses;
    hal_u32_t watchdog_ms;
} posicast_pins;

/* Makes the pins of so many axes, and the parameter. Returns 0, or the HAL's negative error. */
int posicast_make_pins(posicast_pins *pins, int component, uint32_t axes);

/* Says in LinuxCNC's log which constant of the stage posicast_open has refused, with both values. */
void posicast_say_refused(const posicast_stage *stage, const char *where, const posicast_machine *machine);

/* Returns whether the stage has the tap tables of the machine file; if not, LinuxCNC's log says what differs. */
int posicast_is_of_machine(const posicast_stage *stage, const posicast_machine *machine);

/* Switches the axes off, where another program left them on, and loads the table that does not shape; the machine's own stays in use. */
posicast_result posicast_prepare(const posicast_stage *stage, const posicast_machine *machine);

#endif
