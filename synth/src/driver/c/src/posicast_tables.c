/* The functions of posicast_driver.h that load and activate tap tables. */
#include "posicast_driver.h"
#include "posicast_wait.h"

/* Returns whether the table fits the hardware of the axis. */
static int table_fits(const posicast_stage *stage, uint32_t axis, const posicast_table *table)
{
    const uint32_t ring = (uint32_t)IORD_POSICAST_AXIS_RING_SAMPLES(stage->base, axis);
    const int32_t half = (int32_t)((POSICAST_AXIS_TAP_TAP_COEFFICIENT_MSK >> POSICAST_AXIS_TAP_TAP_COEFFICIENT_OFST) / 2u);
    int64_t sum = 0;
    uint32_t tap;

    if (table->count == 0 || table->count > (uint32_t)IORD_POSICAST_AXIS_MOST_TAPS(stage->base, axis) ||
        table->coefficient_fraction != (uint32_t)IORD_POSICAST_AXIS_COEFFICIENT_FRACTION(stage->base, axis))
        return 0;
    for (tap = 0; tap < table->count; tap++) {
        const int32_t coefficient = table->taps[tap].coefficient;

        if (coefficient == 0 || coefficient > half || coefficient < -half - 1 ||
            table->taps[tap].delay_samples > ring - 2u ||
            (tap > 0 && table->taps[tap].delay_samples <= table->taps[tap - 1].delay_samples))
            return 0;
        sum += coefficient;
    }
    return sum == (int64_t)1 << table->coefficient_fraction;
}

posicast_result posicast_load_table(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                    const posicast_table *table, uint32_t how, uint32_t ticks)
{
    uint32_t tap, longest, settle, before;
    posicast_result result;

    if (!is_axis(stage, axis) || bank == 0 || bank > 2 || !table_fits(stage, axis, table))
        return POSICAST_BAD_ARGUMENT;
    if (posicast_status(stage, axis) & POSICAST_AXIS_STATUS_SWAP_PENDING_MSK ||
        FIELD(posicast_status(stage, axis), POSICAST_AXIS_STATUS_TABLE_BANK) == bank)
        return POSICAST_WRONG_STATE;
    before = posicast_flags(stage, axis);
    for (tap = 0; tap < table->count; tap++) {
        IOWR_POSICAST_AXIS_TAP_ADDRESS(stage->base, axis,
                                       AS_FIELD(tap, POSICAST_AXIS_TAP_ADDRESS_TAP_INDEX) |
                                           AS_FIELD(bank, POSICAST_AXIS_TAP_ADDRESS_TAP_BANK));
        IOWR_POSICAST_AXIS_TAP(stage->base, axis,
                               AS_FIELD(table->taps[tap].delay_samples, POSICAST_AXIS_TAP_TAP_DELAY) |
                                   AS_FIELD(table->taps[tap].coefficient, POSICAST_AXIS_TAP_TAP_COEFFICIENT));
    }
    result = posicast_refused_since(stage, axis, POSICAST_AXIS_FLAGS_TABLE_REFUSED_MSK, before);
    if (result != POSICAST_OK)
        return result;
    longest = table->taps[table->count - 1].delay_samples;
    settle = FIELD(IORD_POSICAST_AXIS_SETTLE(stage->base, axis), POSICAST_AXIS_SETTLE_SETTLE_TICKS);
    if (longest > settle)
        IOWR_POSICAST_AXIS_SETTLE(stage->base, axis, AS_FIELD(longest, POSICAST_AXIS_SETTLE_SETTLE_TICKS));
    return posicast_use_table(stage, axis, bank, how, ticks);
}

posicast_result posicast_use_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t how,
                                   uint32_t ticks)
{
    const uint32_t swapped = POSICAST_AXIS_STATUS_SWAP_PENDING_MSK | POSICAST_AXIS_STATUS_TABLE_BANK_MSK;
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t before;
    posicast_result result;

    if (!is_axis(stage, axis) || bank > 2)
        return POSICAST_BAD_ARGUMENT;
    before = posicast_flags(stage, axis);
    IOWR_POSICAST_AXIS_SWAP(
        stage->base, axis,
        AS_FIELD(bank, POSICAST_AXIS_SWAP_SWAP_BANK) | AS_FIELD(how, POSICAST_AXIS_SWAP_SWAP_HOW));
    result = posicast_refused_since(stage, axis, POSICAST_AXIS_FLAGS_TABLE_REFUSED_MSK, before);
    if (result != POSICAST_OK)
        return result;
    return posicast_wait_status(stage, axis, swapped, AS_FIELD(bank, POSICAST_AXIS_STATUS_TABLE_BANK), &left);
}

posicast_result posicast_read_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, posicast_tap *taps,
                                    uint32_t room, uint32_t *count, uint32_t ticks)
{
    const uint32_t sign = (POSICAST_AXIS_TAP_LOADED_LOADED_COEFFICIENT_MSK >>
                           POSICAST_AXIS_TAP_LOADED_LOADED_COEFFICIENT_OFST) / 2u + 1u;
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t tap, most;

    if (!is_axis(stage, axis) || bank > 2)
        return POSICAST_BAD_ARGUMENT;
    most = (uint32_t)IORD_POSICAST_AXIS_MOST_TAPS(stage->base, axis);
    for (tap = 0; tap < most; tap++) {
        posicast_result result;
        uint32_t word, coefficient;

        IOWR_POSICAST_AXIS_TAP_ADDRESS(stage->base, axis,
                                       AS_FIELD(tap, POSICAST_AXIS_TAP_ADDRESS_TAP_INDEX) |
                                           AS_FIELD(bank, POSICAST_AXIS_TAP_ADDRESS_TAP_BANK));
        IOWR_POSICAST_AXIS_TAP_READ(stage->base, axis, 0u);
        /* The flag of a pending read rises a few clocks after the write. */
        result = posicast_wait_flags(stage);
        if (result == POSICAST_OK)
            result = posicast_wait_status(stage, axis, POSICAST_AXIS_STATUS_TAP_READ_WAITS_MSK, 0, &left);
        if (result != POSICAST_OK)
            return result;
        word = (uint32_t)IORD_POSICAST_AXIS_TAP_LOADED(stage->base, axis);
        if (word == 0)
            break;
        if (tap >= room)
            continue;
        coefficient = FIELD(word, POSICAST_AXIS_TAP_LOADED_LOADED_COEFFICIENT);
        taps[tap].delay_samples = (uint16_t)FIELD(word, POSICAST_AXIS_TAP_LOADED_LOADED_DELAY);
        taps[tap].coefficient = (int32_t)(coefficient ^ sign) - (int32_t)sign;
    }
    *count = tap;
    return POSICAST_OK;
}
