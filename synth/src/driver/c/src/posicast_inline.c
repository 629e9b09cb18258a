/* The functions of posicast_inline.h. */
#include "posicast_inline.h"

#define FIELD(word, name) (((uint32_t)(word) & name##_MSK) >> name##_OFST)
#define AS_FIELD(value, name) (((uint32_t)(value) << name##_OFST) & name##_MSK)

/* Reads after which time that stands still means that there is no clock. */
#define STILL_READS 8u

typedef struct {
    uint32_t from_tick;
    uint32_t ticks;
    uint32_t stamp;
    uint32_t still;
} patience;

static patience patience_for(const posicast_inline *shaper, uint32_t ticks)
{
    patience left;

    left.from_tick = (uint32_t)IORD_POSICAST_INLINE_TICK_COUNT(shaper->base);
    left.ticks = ticks;
    left.stamp = (uint32_t)IORD_POSICAST_INLINE_TIME_STAMP(shaper->base);
    left.still = 0;
    return left;
}

static posicast_result pass_time(const posicast_inline *shaper, patience *left)
{
    const uint32_t stamp = (uint32_t)IORD_POSICAST_INLINE_TIME_STAMP(shaper->base);
    const uint32_t tick = (uint32_t)IORD_POSICAST_INLINE_TICK_COUNT(shaper->base);

    left->still = stamp == left->stamp ? left->still + 1u : 0u;
    left->stamp = stamp;
    if (left->still >= STILL_READS)
        return POSICAST_DEAD;
    return tick - left->from_tick > left->ticks ? POSICAST_TIMEOUT : POSICAST_OK;
}

static posicast_result wait_status(const posicast_inline *shaper, uint32_t axis, uint32_t mask, uint32_t wanted,
                                   uint32_t ticks)
{
    patience left = patience_for(shaper, ticks);

    while (((uint32_t)IORD_POSICAST_INLINE_AXIS_STATUS(shaper->base, axis) & mask) != wanted) {
        const posicast_result result = pass_time(shaper, &left);

        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

posicast_result posicast_inline_open(posicast_inline *shaper, uintptr_t base)
{
    const uint32_t version = (uint32_t)IORD_POSICAST_INLINE_VERSION(base);

    shaper->base = base;
    shaper->axes = 0;
    if ((uint32_t)IORD_POSICAST_INLINE_MAGIC(base) != POSICAST_INLINE_MAGIC_RESET)
        return POSICAST_NOT_FOUND;
    /* A larger minor version has registers that this driver does not use. */
    if (version >> 16 != POSICAST_INLINE_VERSION_RESET >> 16 || version < POSICAST_INLINE_VERSION_RESET)
        return POSICAST_VERSION;
    if ((uint32_t)IORD_POSICAST_INLINE_AXES(base) != POSICAST_INLINE_AXES_RESET ||
        (uint32_t)IORD_POSICAST_INLINE_TICK_CLOCKS(base) != POSICAST_INLINE_TICK_CLOCKS_RESET)
        return POSICAST_OTHER_MACHINE;
#ifdef POSICAST_INLINE_MACHINE_CRC_RESET
    if ((uint32_t)IORD_POSICAST_INLINE_MACHINE_CRC(base) != POSICAST_INLINE_MACHINE_CRC_RESET)
        return POSICAST_OTHER_MACHINE;
#endif
    shaper->axes = POSICAST_INLINE_AXES_RESET;
    return POSICAST_OK;
}

uint32_t posicast_inline_status(const posicast_inline *shaper)
{
    return (uint32_t)IORD_POSICAST_INLINE_STATUS(shaper->base);
}

uint32_t posicast_inline_causes(const posicast_inline *shaper, uint32_t axis)
{
    return axis < shaper->axes ? (uint32_t)IORD_POSICAST_INLINE_AXIS_CAUSES(shaper->base, axis) : 0u;
}

void posicast_inline_snapshot(const posicast_inline *shaper)
{
    IOWR_POSICAST_INLINE_SNAPSHOT(shaper->base, 0u);
}

posicast_result posicast_inline_read_counts(const posicast_inline *shaper, uint32_t axis, posicast_inline_counts *counts)
{
    const uint32_t sign = (POSICAST_INLINE_AXIS_SNAPSHOT_OWED_STEPS_OWED_STEPS_MSK + 1u) / 2u;

    if (axis >= shaper->axes)
        return POSICAST_BAD_ARGUMENT;
    counts->input = (int32_t)IORD_POSICAST_INLINE_AXIS_SNAPSHOT_INPUT_STEPS(shaper->base, axis);
    counts->given = (int32_t)IORD_POSICAST_INLINE_AXIS_SNAPSHOT_GIVEN_STEPS(shaper->base, axis);
    counts->owed =
        (int32_t)((uint32_t)IORD_POSICAST_INLINE_AXIS_SNAPSHOT_OWED_STEPS(shaper->base, axis) ^ sign) - (int32_t)sign;
    return POSICAST_OK;
}

posicast_result posicast_inline_bypass(const posicast_inline *shaper, int on, uint32_t ticks)
{
    patience left = patience_for(shaper, ticks);
    const uint32_t wanted = on ? POSICAST_INLINE_STATUS_BYPASSED_MSK : 0u;

    IOWR_POSICAST_INLINE_BYPASS(shaper->base, on ? POSICAST_INLINE_BYPASS_BYPASS_REQUEST_MSK : 0u);
    while ((posicast_inline_status(shaper) & POSICAST_INLINE_STATUS_BYPASSED_MSK) != wanted) {
        const posicast_result result = pass_time(shaper, &left);

        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

/* Returns whether the table fits the hardware of the axis. */
static int table_fits(const posicast_inline *shaper, uint32_t axis, const posicast_inline_tap *taps, uint32_t count)
{
    const uint32_t ring = (uint32_t)IORD_POSICAST_INLINE_AXIS_RING_SAMPLES(shaper->base, axis);
    const int32_t half = (int32_t)((POSICAST_INLINE_AXIS_TAP_TAP_COEFFICIENT_MSK >>
                                    POSICAST_INLINE_AXIS_TAP_TAP_COEFFICIENT_OFST) / 2u);
    int64_t sum = 0;
    uint32_t tap;

    if (count == 0 || count > (uint32_t)IORD_POSICAST_INLINE_AXIS_MOST_TAPS(shaper->base, axis))
        return 0;
    for (tap = 0; tap < count; tap++) {
        if (taps[tap].coefficient == 0 || taps[tap].coefficient > half || taps[tap].coefficient < -half - 1 ||
            taps[tap].delay_samples > ring - 2u || (tap > 0 && taps[tap].delay_samples <= taps[tap - 1].delay_samples))
            return 0;
        sum += taps[tap].coefficient;
    }
    return sum == (int64_t)1 << (uint32_t)IORD_POSICAST_INLINE_AXIS_COEFFICIENT_FRACTION(shaper->base, axis);
}

static posicast_result refused(const posicast_inline *shaper, uint32_t axis)
{
    const uint32_t flag = POSICAST_INLINE_AXIS_FLAGS_TABLE_REFUSED_MSK;
    const uint32_t flags = (uint32_t)IORD_POSICAST_INLINE_AXIS_FLAGS(shaper->base, axis);

    return flags & flag ? POSICAST_REFUSED : POSICAST_OK;
}

posicast_result posicast_inline_load_table(const posicast_inline *shaper, uint32_t axis, uint32_t bank,
                                           const posicast_inline_tap *taps, uint32_t count, uint32_t ticks)
{
    uint32_t status, tap;

    if (axis >= shaper->axes || bank == 0 || bank > 2 || !table_fits(shaper, axis, taps, count))
        return POSICAST_BAD_ARGUMENT;
    status = (uint32_t)IORD_POSICAST_INLINE_AXIS_STATUS(shaper->base, axis);
    if (status & POSICAST_INLINE_AXIS_STATUS_SWAP_PENDING_MSK ||
        FIELD(status, POSICAST_INLINE_AXIS_STATUS_TABLE_BANK) == bank)
        return POSICAST_WRONG_STATE;
    IOWR_POSICAST_INLINE_AXIS_FLAGS(shaper->base, axis, POSICAST_INLINE_AXIS_FLAGS_TABLE_REFUSED_MSK);
    for (tap = 0; tap < count; tap++) {
        IOWR_POSICAST_INLINE_AXIS_TAP_ADDRESS(shaper->base, axis,
                                              AS_FIELD(tap, POSICAST_INLINE_AXIS_TAP_ADDRESS_TAP_INDEX) |
                                                  AS_FIELD(bank, POSICAST_INLINE_AXIS_TAP_ADDRESS_TAP_BANK));
        IOWR_POSICAST_INLINE_AXIS_TAP(shaper->base, axis,
                                      AS_FIELD(taps[tap].delay_samples, POSICAST_INLINE_AXIS_TAP_TAP_DELAY) |
                                          AS_FIELD(taps[tap].coefficient, POSICAST_INLINE_AXIS_TAP_TAP_COEFFICIENT));
    }
    if (refused(shaper, axis) != POSICAST_OK)
        return POSICAST_REFUSED;
    return posicast_inline_use_table(shaper, axis, bank, ticks);
}

posicast_result posicast_inline_use_table(const posicast_inline *shaper, uint32_t axis, uint32_t bank, uint32_t ticks)
{
    const uint32_t swapped =
        POSICAST_INLINE_AXIS_STATUS_SWAP_PENDING_MSK | POSICAST_INLINE_AXIS_STATUS_TABLE_BANK_MSK;
    posicast_result result;

    if (axis >= shaper->axes || bank > 2)
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_INLINE_AXIS_FLAGS(shaper->base, axis, POSICAST_INLINE_AXIS_FLAGS_TABLE_REFUSED_MSK);
    IOWR_POSICAST_INLINE_AXIS_SWAP(shaper->base, axis,
                                   AS_FIELD(bank, POSICAST_INLINE_AXIS_SWAP_SWAP_BANK) |
                                       AS_FIELD(POSICAST_INLINE_AXIS_SWAP_SWAP_HOW_HANDOVER,
                                                POSICAST_INLINE_AXIS_SWAP_SWAP_HOW));
    result = wait_status(shaper, axis, swapped, AS_FIELD(bank, POSICAST_INLINE_AXIS_STATUS_TABLE_BANK), ticks);
    return refused(shaper, axis) == POSICAST_OK ? result : POSICAST_REFUSED;
}

posicast_result posicast_inline_read_tap(const posicast_inline *shaper, uint32_t axis, uint32_t bank, uint32_t index,
                                         posicast_inline_tap *tap, uint32_t ticks)
{
    const uint32_t sign = (POSICAST_INLINE_AXIS_TAP_LOADED_LOADED_COEFFICIENT_MSK >>
                           POSICAST_INLINE_AXIS_TAP_LOADED_LOADED_COEFFICIENT_OFST) / 2u + 1u;
    uint32_t word, coefficient;
    posicast_result result;

    if (axis >= shaper->axes || bank > 2 || index >= (uint32_t)IORD_POSICAST_INLINE_AXIS_MOST_TAPS(shaper->base, axis))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_INLINE_AXIS_TAP_ADDRESS(shaper->base, axis,
                                          AS_FIELD(index, POSICAST_INLINE_AXIS_TAP_ADDRESS_TAP_INDEX) |
                                              AS_FIELD(bank, POSICAST_INLINE_AXIS_TAP_ADDRESS_TAP_BANK));
    IOWR_POSICAST_INLINE_AXIS_TAP_READ(shaper->base, axis, 0u);
    /* The flag of a pending read rises a few clocks after the write: a read of any register takes longer. */
    (void)IORD_POSICAST_INLINE_TIME_STAMP(shaper->base);
    (void)IORD_POSICAST_INLINE_TIME_STAMP(shaper->base);
    result = wait_status(shaper, axis, POSICAST_INLINE_AXIS_STATUS_TAP_READ_WAITS_MSK, 0u, ticks);
    if (result != POSICAST_OK)
        return result;
    word = (uint32_t)IORD_POSICAST_INLINE_AXIS_TAP_LOADED(shaper->base, axis);
    coefficient = FIELD(word, POSICAST_INLINE_AXIS_TAP_LOADED_LOADED_COEFFICIENT);
    tap->delay_samples = (uint16_t)FIELD(word, POSICAST_INLINE_AXIS_TAP_LOADED_LOADED_DELAY);
    tap->coefficient = (int32_t)(coefficient ^ sign) - (int32_t)sign;
    return POSICAST_OK;
}
