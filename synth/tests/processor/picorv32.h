/* What is particular to picorv32 in processor.v: its instructions for interrupts, and the console. */
#ifdef __ASSEMBLER__

#define RETURN_FROM_INTERRUPT .insn r 0x0b, 0, 2, x0, x0, x0    /* retirq */
/* It goes to address 16 by itself. */
#define SET_HANDLER

#else

/* The stage's interrupt at the core. */
#define STAGE_IRQ 3u
#define CONSOLE ((volatile uint32_t *)0x10000000u)

static void let_through(uint32_t line)
{
    __asm__ volatile(".insn r 0x0b, 0, 3, x0, %0, x0" ::"r"(~(1u << line)));
}

static void sleep(void *context)
{
    uint32_t pending;

    (void)context;
    __asm__ volatile(".insn r 0x0b, 0, 4, %0, x0, x0" : "=r"(pending)::"memory");
}

static void put(char character)
{
    *CONSOLE = (uint8_t)character;
}

/* The core shows itself that it is in the handler. */
static void mark_handler(uint32_t is_in)
{
    (void)is_in;
}

/* It stops after a fault. */
static int has_trapped(void)
{
    return 0;
}

#endif
