/* What is particular to the VexRiscv of litex_soc.py: its interrupts, and LiteX's UART. LiteX's headers say where they are, and
   where the stage is. */
#ifdef __ASSEMBLER__

#define RETURN_FROM_INTERRUPT mret
#define SET_HANDLER .option arch, +zicsr; la t0, handler; csrw mtvec, t0

#else

/* The instructions for interrupts. */
__asm__(".option arch, +zicsr");

#include <generated/csr.h>
#include <generated/mem.h>
#include <irq.h>

#define STAGE_IRQ STAGE_INTERRUPT
#define MIE_EXTERNAL (1u << 11)

static void let_through(uint32_t line)
{
    irq_setmask(1u << line);
    csrs(mie, MIE_EXTERNAL);
    irq_setie(1);
}

static void sleep(void *context)
{
    (void)context;
    __asm__ volatile("wfi" ::: "memory");
}

static void put(char character)
{
    while (uart_txfull_read() != 0)
        ;
    uart_rxtx_write((uint8_t)character);
}

static void mark_handler(uint32_t is_in)
{
    handler_out_write(is_in);
}

/* An exception leads to the handler as well. */
static int has_trapped(void)
{
    return csrr(mcause) >> 31 == 0;
}

#endif
