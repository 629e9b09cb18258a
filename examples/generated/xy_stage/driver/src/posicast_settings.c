/* Settings of the controllers. */
#include "posicast_settings.h"
#include "posicast_wait.h"

#define MANTISSA_MASK ((1u << POSICAST_GAIN_MANTISSA_BITS) - 1u)
#define SIGN_BIT (1u << (POSICAST_GAIN_MANTISSA_BITS - 1u))

posicast_result posicast_scale_gain(uint32_t *word, uint16_t numerator, uint16_t denominator)
{
    const uint32_t mantissa = *word & MANTISSA_MASK, shift = *word >> POSICAST_GAIN_MANTISSA_BITS & POSICAST_GAIN_SHIFT_MAX;
    const int negative = (mantissa & SIGN_BIT) != 0;
    const uint64_t size = (uint64_t)(negative ? MANTISSA_MASK + 1u - mantissa : mantissa) * numerator;
    uint32_t next, found = 0;
    int fits = 0;

    if (denominator == 0)
        return POSICAST_BAD_ARGUMENT;
    /* The largest shift whose mantissa fits is the finest; a mantissa that does not fit is less than twice one that does. */
    for (next = 0; next <= POSICAST_GAIN_SHIFT_MAX; next++) {
        const uint64_t above = next > shift ? size << (next - shift) : size;
        const uint64_t below = next < shift ? (uint64_t)denominator << (shift - next) : denominator;
        const uint64_t rounded = (2u * above + below) / (2u * below);

        if (rounded >= SIGN_BIT)
            break;
        found = (negative ? MANTISSA_MASK + 1u - (uint32_t)rounded : (uint32_t)rounded) & MANTISSA_MASK;
        found |= next << POSICAST_GAIN_MANTISSA_BITS;
        fits = 1;
    }
    if (!fits)
        return POSICAST_BAD_ARGUMENT;
    *word = found;
    return POSICAST_OK;
}

#if POSICAST_LOOP_AXES
/* Waits until no commit is pending. */
static posicast_result wait_for_commit(const posicast_stage *stage, posicast_patience *left)
{
    posicast_result result = POSICAST_OK;

    while (IORD_POSICAST_STAGE_COMMIT(stage->base) != 0 && result == POSICAST_OK)
        result = posicast_pass_time(stage, left);
    return result;
}

posicast_result posicast_load_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       const posicast_settings *settings, uint32_t ticks)
{
    uint32_t row;
    posicast_result result;

    if (!has_loop(stage, axis) || bank == 0 || bank > 2)
        return POSICAST_BAD_ARGUMENT;
    if (FIELD(IORD_POSICAST_AXIS_LAW(stage->base, axis), POSICAST_AXIS_LAW_LAW_BANK) == bank ||
        IORD_POSICAST_STAGE_COMMIT(stage->base) != 0)
        return POSICAST_WRONG_STATE;
    IOWR_POSICAST_AXIS_EVENTS(stage->base, axis, POSICAST_AXIS_EVENTS_SETTING_REFUSED_MSK);
    for (row = 0; row < POSICAST_SETTINGS; row++) {
        IOWR_POSICAST_AXIS_SETTING_ADDRESS(stage->base, axis,
                                           AS_FIELD(row, POSICAST_AXIS_SETTING_ADDRESS_SETTING_ROW) |
                                               AS_FIELD(bank, POSICAST_AXIS_SETTING_ADDRESS_SETTING_BANK));
        IOWR_POSICAST_AXIS_SETTING(stage->base, axis, settings->word[row]);
    }
    result = posicast_wait_flags(stage);
    if (result != POSICAST_OK)
        return result;
    if ((uint32_t)IORD_POSICAST_AXIS_EVENTS(stage->base, axis) & POSICAST_AXIS_EVENTS_SETTING_REFUSED_MSK)
        return POSICAST_REFUSED;
    return posicast_use_settings(stage, axis, bank, settings->law, ticks);
}

posicast_result posicast_use_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t law,
                                      uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    posicast_result result;

    if (!has_loop(stage, axis) || bank > 2 || law > POSICAST_AXIS_LAW_PID)
        return POSICAST_BAD_ARGUMENT;
    /* Writes are refused while a commit is pending, also one of another axis. */
    result = wait_for_commit(stage, &left);
    if (result != POSICAST_OK)
        return result;
    IOWR_POSICAST_AXIS_LAW(stage->base, axis,
                           AS_FIELD(law, POSICAST_AXIS_LAW) | AS_FIELD(bank, POSICAST_AXIS_LAW_LAW_BANK));
    IOWR_POSICAST_STAGE_COMMIT(stage->base, 1u);
    return wait_for_commit(stage, &left);
}

posicast_result posicast_read_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       posicast_settings *settings, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t row;

    if (!has_loop(stage, axis) || bank > 2)
        return POSICAST_BAD_ARGUMENT;
    for (row = 0; row < POSICAST_SETTINGS; row++) {
        posicast_result result;

        IOWR_POSICAST_AXIS_SETTING_ADDRESS(stage->base, axis,
                                           AS_FIELD(row, POSICAST_AXIS_SETTING_ADDRESS_SETTING_ROW) |
                                               AS_FIELD(bank, POSICAST_AXIS_SETTING_ADDRESS_SETTING_BANK));
        IOWR_POSICAST_AXIS_SETTING_READ(stage->base, axis, 0u);
        /* The flag of a pending read rises a few clocks after the write. */
        result = posicast_wait_flags(stage);
        if (result == POSICAST_OK)
            result = posicast_wait_status(stage, axis, POSICAST_AXIS_STATUS_SETTING_READ_WAITS_MSK, 0, &left);
        if (result != POSICAST_OK)
            return result;
        settings->word[row] = (uint32_t)IORD_POSICAST_AXIS_SETTING_LOADED(stage->base, axis);
    }
    settings->law = FIELD(IORD_POSICAST_AXIS_LAW(stage->base, axis), POSICAST_AXIS_LAW);
    return POSICAST_OK;
}
#endif
