/* Of the HAL: the enhanced interrupt API. */
#ifndef ALT_IRQ_H
#define ALT_IRQ_H
#include "alt_types.h"
#define ALT_ENHANCED_INTERRUPT_API_PRESENT
typedef int alt_irq_context;
typedef void (*alt_isr_func)(void *isr_context);
int alt_ic_isr_register(alt_u32 ic_id, alt_u32 irq, alt_isr_func isr, void *isr_context, void *flags);
alt_irq_context alt_irq_disable_all(void);
void alt_irq_enable_all(alt_irq_context context);
#endif
