/* What a BSP writes for one instance of the stage, on registers of an array; it exits 0 if all is as it should be. */
#include "sys/alt_irq.h"
#include "xy_stage_stage.h"

#define STAGE_0_BASE 0x10000
#define STAGE_0_IRQ 5
#define STAGE_0_IRQ_INTERRUPT_CONTROLLER_ID 2

static alt_u32 words[POSICAST_STAGE_BYTES / 4u];
static alt_isr_func isr;
static void *isr_context;
static int masked, handled;

alt_u32 stub_read(alt_u32 address)
{
    return words[(address - STAGE_0_BASE) / 4u];
}

void stub_write(alt_u32 address, alt_u32 data)
{
    const alt_u32 word = (address - STAGE_0_BASE) / 4u;

    if (word == POSICAST_STAGE_INTERRUPT_STATE_REG)
        words[word] &= ~data;
    else
        words[word] = data;
}

int alt_ic_isr_register(alt_u32 ic_id, alt_u32 irq, alt_isr_func function, void *context, void *flags)
{
    (void)flags;
    isr = function;
    isr_context = context;
    return ic_id == STAGE_0_IRQ_INTERRUPT_CONTROLLER_ID && irq == STAGE_0_IRQ ? 0 : -1;
}

alt_irq_context alt_irq_disable_all(void)
{
    return masked++;
}

void alt_irq_enable_all(alt_irq_context context)
{
    masked = context;
}

static void handle(void *context, alt_u32 interrupts)
{
    handled += context == &handled && interrupts == POSICAST_AXIS_INTERRUPT(1, POSICAST_INTERRUPT_MOVE_DONE);
}

XY_STAGE_STAGE_INSTANCE(STAGE_0, stage_0);

int main(void)
{
    const alt_u32 done = POSICAST_AXIS_INTERRUPT(1, POSICAST_INTERRUPT_MOVE_DONE);

    XY_STAGE_STAGE_INIT(STAGE_0, stage_0);
    if (stage_0.found != POSICAST_NOT_FOUND || isr != 0)
        return 1;
    words[POSICAST_STAGE_MAGIC_REG] = POSICAST_STAGE_MAGIC_RESET;
    words[POSICAST_STAGE_VERSION_REG] = POSICAST_STAGE_VERSION_RESET - 1u;
    XY_STAGE_STAGE_INIT(STAGE_0, stage_0);
    if (stage_0.found != POSICAST_VERSION)
        return 2;
    words[POSICAST_STAGE_VERSION_REG] = POSICAST_STAGE_VERSION_RESET;
    words[POSICAST_STAGE_AXES_REG] = POSICAST_STAGE_AXES_RESET;
    XY_STAGE_STAGE_INIT(STAGE_0, stage_0);
    if (stage_0.found != POSICAST_OTHER_MACHINE || stage_0.stage.refused.wanted != POSICAST_STAGE_TICK_CLOCKS_RESET)
        return 6;
    words[POSICAST_STAGE_TICK_CLOCKS_REG] = POSICAST_STAGE_TICK_CLOCKS_RESET;
    XY_STAGE_STAGE_INIT(STAGE_0, stage_0);
    if (stage_0.found != POSICAST_OK || isr == 0)
        return 3;
    posicast_stage_hal_handle(&stage_0, handle, &handled);
    posicast_enable_interrupts(&stage_0.stage, done);
    words[POSICAST_STAGE_INTERRUPT_STATE_REG] = done | 1u;
    isr(isr_context);
    if (handled != 1 || words[POSICAST_STAGE_INTERRUPT_STATE_REG] != 1u)
        return 4;
    return posicast_stage_hal_taken(&stage_0) == done && posicast_stage_hal_taken(&stage_0) == 0 && masked == 0 ? 0 : 5;
}
