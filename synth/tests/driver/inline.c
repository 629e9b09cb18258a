/* The driver of an inline shaper: its identity, counts, no shaping, and tables. The test steps its axes. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "posicast_inline.h"

#define BASE 0x40000u
#define TICKS 3000u

uint32_t posicast_read(uintptr_t base, uint32_t word)
{
    uint32_t data;

    printf("r %" PRIu32 "\n", word);
    if (base != BASE || fflush(stdout) != 0 || scanf("%" SCNu32, &data) != 1)
        exit(3);
    return data;
}

void posicast_write(uintptr_t base, uint32_t word, uint32_t data)
{
    if (base != BASE)
        exit(3);
    printf("w %" PRIu32 " %" PRIu32 "\n", word, data);
}

static void result(const char *name, int64_t value)
{
    printf("= %s %" PRId64 "\n", name, value);
}

/* Lets the axis X get steps, and waits until all axes are settled. */
static void ride(const posicast_inline *shaper, int steps)
{
    uint32_t looks;

    printf("s x_%s %d\n", steps < 0 ? "down" : "up", steps < 0 ? -steps : steps);
    for (looks = 0; looks < 20; looks++)
        printf("p\n");
    for (looks = 0; looks < 2000 && !(posicast_inline_status(shaper) & POSICAST_INLINE_STATUS_SETTLED_MSK); looks++)
        printf("p\n");
}

int main(int argc, char **argv)
{
    static const posicast_inline_tap half[] = {{0, 1 << 15}, {60, 1 << 15}};
    static const posicast_inline_tap wrong[] = {{0, 1 << 15}, {60, 1 << 14}};
    posicast_inline shaper;
    posicast_inline_counts counts;
    posicast_inline_tap tap = {0, 0};
    const posicast_result opened = posicast_inline_open(&shaper, BASE);

    (void)argv;
    result("opened", opened);
    if (opened != POSICAST_OK || argc > 1)
        return 0;
    result("axes", shaper.axes);
    ride(&shaper, 100);
    posicast_inline_snapshot(&shaper);
    result("read", posicast_inline_read_counts(&shaper, POSICAST_INLINE_OF_X, &counts));
    result("input", counts.input);
    result("given", counts.given);
    result("owed", counts.owed);
    result("no_axis", posicast_inline_read_counts(&shaper, shaper.axes, &counts));
    result("causes", posicast_inline_causes(&shaper, POSICAST_INLINE_OF_X));
    result("bypass", posicast_inline_bypass(&shaper, 1, TICKS));
    result("bypassed", (posicast_inline_status(&shaper) & POSICAST_INLINE_STATUS_BYPASSED_MSK) != 0);
    result("shape", posicast_inline_bypass(&shaper, 0, TICKS));
    result("wrong", posicast_inline_load_table(&shaper, POSICAST_INLINE_OF_X, 1, wrong, 2, TICKS));
    result("load", posicast_inline_load_table(&shaper, POSICAST_INLINE_OF_X, 1, half, 2, TICKS));
    result("in_use", posicast_inline_load_table(&shaper, POSICAST_INLINE_OF_X, 1, half, 2, TICKS));
    result("read_tap", posicast_inline_read_tap(&shaper, POSICAST_INLINE_OF_X, 1, 1, &tap, TICKS));
    result("delay", tap.delay_samples);
    result("coefficient", tap.coefficient);
    ride(&shaper, -150);
    result("machine", posicast_inline_use_table(&shaper, POSICAST_INLINE_OF_X, 0, TICKS));
    posicast_inline_snapshot(&shaper);
    (void)posicast_inline_read_counts(&shaper, POSICAST_INLINE_OF_X, &counts);
    result("input_after", counts.input);
    result("given_after", counts.given);
    return 0;
}
