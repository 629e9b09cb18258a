/*
 * A stage in a HAL system (Nios II, Nios V): alt_sys_init finds it, and the enhanced interrupt API handles its interrupt.
 *
 * `interrupts` collects the interrupts that have occurred; a handler is called from the interrupt with the new ones.
 * posicast_enable_interrupts selects the interrupts that raise the line; after alt_sys_init, none does.
 */
#ifndef POSICAST_STAGE_HAL_H
#define POSICAST_STAGE_HAL_H

#include "alt_types.h"
#include "posicast_driver.h"

typedef void (*posicast_interrupt_handler)(void *context, alt_u32 interrupts);

typedef struct {
    posicast_stage stage;
    /* Result of posicast_open; unless it is POSICAST_OK, nothing else works, and `stage.refused` says why. */
    posicast_result found;
    volatile alt_u32 interrupts;
    posicast_interrupt_handler handler;
    void *context;
} posicast_stage_hal;

/* Is called by alt_sys_init. If `irq` is below 0, the line is not connected. */
void posicast_stage_hal_init(posicast_stage_hal *device, alt_u32 base, int controller, int irq);

/* Sets the handler that is called from the interrupt; 0 means none. */
void posicast_stage_hal_handle(posicast_stage_hal *device, posicast_interrupt_handler handler, void *context);

/* Returns the interrupts that have occurred since the last call. */
alt_u32 posicast_stage_hal_taken(posicast_stage_hal *device);

#endif
