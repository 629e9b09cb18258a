/* The functions of posicast_stage_hal.h. */
#include "posicast_stage_hal.h"

#include <stddef.h>

#include "sys/alt_irq.h"

#ifndef ALT_ENHANCED_INTERRUPT_API_PRESENT
#error "The driver of the stage needs the HAL's enhanced interrupt API."
#endif

static void interrupt(void *context)
{
    posicast_stage_hal *const device = context;
    const alt_u32 now = posicast_take_interrupts(&device->stage);

    device->interrupts |= now;
    if (device->handler != NULL && now != 0)
        device->handler(device->context, now);
}

void posicast_stage_hal_init(posicast_stage_hal *device, alt_u32 base, int controller, int irq)
{
    device->interrupts = 0;
    device->handler = NULL;
    device->context = NULL;
    device->found = posicast_open(&device->stage, base);
    if (device->found != POSICAST_OK)
        return;
    posicast_enable_interrupts(&device->stage, 0);
    if (irq >= 0)
        (void)alt_ic_isr_register((alt_u32)controller, (alt_u32)irq, interrupt, device, NULL);
}

void posicast_stage_hal_handle(posicast_stage_hal *device, posicast_interrupt_handler handler, void *context)
{
    const alt_irq_context before = alt_irq_disable_all();

    device->handler = handler;
    device->context = context;
    alt_irq_enable_all(before);
}

alt_u32 posicast_stage_hal_taken(posicast_stage_hal *device)
{
    const alt_irq_context before = alt_irq_disable_all();
    const alt_u32 taken = device->interrupts;

    device->interrupts = 0;
    alt_irq_enable_all(before);
    return taken;
}
