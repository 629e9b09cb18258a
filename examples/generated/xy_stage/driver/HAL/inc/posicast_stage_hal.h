/*
 * A stage in a HAL system (Nios II, Nios V): found in alt_sys_init, its interrupt taken through the enhanced interrupt API.
 *
 * `interrupts` collects what has happened; a handler is called from the interrupt, with what has happened now. What raises the
 * line says posicast_enable_interrupts: nothing does, after alt_sys_init.
 */
#ifndef POSICAST_STAGE_HAL_H
#define POSICAST_STAGE_HAL_H

#include "alt_types.h"
#include "posicast_driver.h"

typedef void (*posicast_interrupt_handler)(void *context, alt_u32 interrupts);

typedef struct {
    posicast_stage stage;
    /* Of posicast_open: nothing else works unless it is POSICAST_OK. */
    posicast_result found;
    volatile alt_u32 interrupts;
    posicast_interrupt_handler handler;
    void *context;
} posicast_stage_hal;

/* Called by alt_sys_init. `irq` below 0: the line is not connected. */
void posicast_stage_hal_init(posicast_stage_hal *device, alt_u32 base, int controller, int irq);

/* From now on this is called from the interrupt; 0: nothing is. */
void posicast_stage_hal_handle(posicast_stage_hal *device, posicast_interrupt_handler handler, void *context);

/* What has happened since the last call. */
alt_u32 posicast_stage_hal_taken(posicast_stage_hal *device);

#endif
