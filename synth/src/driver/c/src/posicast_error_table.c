/* The functions of posicast_error_table.h. */
#include "posicast_error_table.h"

#include "posicast_wait.h"

#define ENTRY_MSK (POSICAST_AXIS_ERROR_ENTRY_MSK >> POSICAST_AXIS_ERROR_ENTRY_OFST)

static const int32_t largest_entry = (int32_t)(ENTRY_MSK / 2u);

static int has_table(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && has(POSICAST_ERROR_TABLE_AXES, axis);
}

static uint32_t error_status(const posicast_stage *stage, uint32_t axis)
{
    return (uint32_t)IORD_POSICAST_AXIS_ERROR_STATUS(stage->base, axis);
}

/* Until bits of ERROR_STATUS are these. */
static posicast_result wait_error_status(const posicast_stage *stage, uint32_t axis, uint32_t mask, uint32_t wanted,
                                         uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    posicast_result result = POSICAST_OK;

    while ((error_status(stage, axis) & mask) != wanted && result == POSICAST_OK)
        result = posicast_pass_time(stage, &left);
    return result;
}

/* The other bits of ERROR_CONTROL stay. */
static void control(const posicast_stage *stage, uint32_t axis, uint32_t mask, uint32_t bits)
{
    const uint32_t word = (uint32_t)IORD_POSICAST_AXIS_ERROR_CONTROL(stage->base, axis);

    IOWR_POSICAST_AXIS_ERROR_CONTROL(stage->base, axis, (word & ~mask) | (bits & mask));
}

static void address(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t entry)
{
    IOWR_POSICAST_AXIS_ERROR_ADDRESS(stage->base, axis,
                                     AS_FIELD(entry, POSICAST_AXIS_ERROR_ADDRESS_ERROR_INDEX) |
                                         AS_FIELD(bank, POSICAST_AXIS_ERROR_ADDRESS_ERROR_BANK));
}

posicast_result posicast_error_format_of(const posicast_stage *stage, uint32_t axis, posicast_error_format *format)
{
    uint32_t word;

    if (!has_table(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    word = (uint32_t)IORD_POSICAST_AXIS_ERROR_FORMAT(stage->base, axis);
    format->first = (int32_t)IORD_POSICAST_AXIS_ERROR_FIRST(stage->base, axis);
    format->spacing = 1u << FIELD(word, POSICAST_AXIS_ERROR_FORMAT_ERROR_SPACING_BITS);
    format->entries = FIELD(word, POSICAST_AXIS_ERROR_FORMAT_ERROR_ENTRIES);
    format->fraction_bits = FIELD(word, POSICAST_AXIS_ERROR_FORMAT_ERROR_FRACTION_BITS);
    return POSICAST_OK;
}

posicast_result posicast_error_entries(const posicast_error_format *format, const posicast_error_point *points,
                                       uint32_t count, int32_t *entries)
{
    const double unit = (double)(1u << format->fraction_bits);
    uint32_t entry, point, above = 0;

    for (point = 1; point < count; point++)
        if (!(points[point].position > points[point - 1].position))
            return POSICAST_BAD_ARGUMENT;
    if (count == 0 || format->entries > POSICAST_ERROR_ENTRIES_MAX)
        return POSICAST_BAD_ARGUMENT;
    for (entry = 0; entry < format->entries; entry++) {
        const double position = (double)format->first + (double)format->spacing * (double)entry;
        double error;

        while (above < count && points[above].position <= position)
            above++;
        if (above == 0) {
            error = points[0].error;
        } else if (above == count) {
            error = points[count - 1].error;
        } else {
            const posicast_error_point *low = &points[above - 1], *high = &points[above];

            error = low->error +
                    (high->error - low->error) * (position - low->position) / (high->position - low->position);
        }
        error *= unit;
        /* Not a number is neither. */
        if (!(error <= (double)largest_entry && error >= -(double)largest_entry))
            return POSICAST_BAD_ARGUMENT;
        entries[entry] = (int32_t)(error < 0 ? error - 0.5 : error + 0.5);
    }
    return POSICAST_OK;
}

posicast_result posicast_load_error_table(const posicast_stage *stage, uint32_t axis, const int32_t *entries,
                                          uint32_t count, uint32_t ticks)
{
    posicast_error_format format;
    posicast_result result = posicast_error_format_of(stage, axis, &format);
    uint32_t entry;

    if (result != POSICAST_OK || count != format.entries)
        return POSICAST_BAD_ARGUMENT;
    for (entry = 0; entry < count; entry++)
        if (entries[entry] > largest_entry || entries[entry] < -largest_entry - 1)
            return POSICAST_BAD_ARGUMENT;
    if (error_status(stage, axis) & POSICAST_AXIS_ERROR_STATUS_ERROR_BANK_USED_MSK) {
        result = posicast_use_error_table(stage, axis, 0, ticks);
        if (result != POSICAST_OK)
            return result;
    }
    IOWR_POSICAST_AXIS_ERROR_EVENTS(stage->base, axis, POSICAST_AXIS_ERROR_EVENTS_ERROR_REFUSED_MSK);
    for (entry = 0; entry < count; entry++) {
        address(stage, axis, 1, entry);
        IOWR_POSICAST_AXIS_ERROR_ENTRY(stage->base, axis,
                                       AS_FIELD(entries[entry], POSICAST_AXIS_ERROR_ENTRY));
    }
    result = posicast_wait_flags(stage);
    if (result != POSICAST_OK)
        return result;
    if ((uint32_t)IORD_POSICAST_AXIS_ERROR_EVENTS(stage->base, axis) & POSICAST_AXIS_ERROR_EVENTS_ERROR_REFUSED_MSK)
        return POSICAST_REFUSED;
    return posicast_use_error_table(stage, axis, 1, ticks);
}

posicast_result posicast_use_error_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t ticks)
{
    if (!has_table(stage, axis) || bank > 1)
        return POSICAST_BAD_ARGUMENT;
    if (bank == 1 && !(error_status(stage, axis) & POSICAST_AXIS_ERROR_STATUS_ERROR_COMPLETE_MSK))
        return POSICAST_WRONG_STATE;
    control(stage, axis, POSICAST_AXIS_ERROR_CONTROL_ERROR_SELECT_MSK,
            AS_FIELD(bank, POSICAST_AXIS_ERROR_CONTROL_ERROR_SELECT));
    return wait_error_status(stage, axis, POSICAST_AXIS_ERROR_STATUS_ERROR_BANK_USED_MSK,
                             AS_FIELD(bank, POSICAST_AXIS_ERROR_STATUS_ERROR_BANK_USED), ticks);
}

posicast_result posicast_enable_error_table(const posicast_stage *stage, uint32_t axis, int enabled, uint32_t ticks)
{
    if (!has_table(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    control(stage, axis, POSICAST_AXIS_ERROR_CONTROL_ERROR_ENABLE_MSK,
            enabled ? POSICAST_AXIS_ERROR_CONTROL_ERROR_ENABLE_MSK : 0);
    if (enabled)
        return POSICAST_OK;
    return wait_error_status(stage, axis, POSICAST_AXIS_ERROR_STATUS_ERROR_WEIGHT_MSK, 0, ticks);
}

posicast_result posicast_read_error_table(const posicast_stage *stage, uint32_t axis, uint32_t bank, int32_t *entries,
                                          uint32_t room, uint32_t ticks)
{
    const uint32_t sign = ENTRY_MSK / 2u + 1u;
    posicast_error_format format;
    uint32_t entry;

    if (posicast_error_format_of(stage, axis, &format) != POSICAST_OK || bank > 1)
        return POSICAST_BAD_ARGUMENT;
    for (entry = 0; entry < format.entries && entry < room; entry++) {
        posicast_result result;
        uint32_t word;

        address(stage, axis, bank, entry);
        IOWR_POSICAST_AXIS_ERROR_READ(stage->base, axis, 0u);
        /* The flag that the read waits rises a few clocks after the write. */
        result = posicast_wait_flags(stage);
        if (result == POSICAST_OK)
            result = wait_error_status(stage, axis, POSICAST_AXIS_ERROR_STATUS_ERROR_READ_WAITS_MSK, 0, ticks);
        if (result != POSICAST_OK)
            return result;
        word = FIELD(IORD_POSICAST_AXIS_ERROR_LOADED(stage->base, axis), POSICAST_AXIS_ERROR_LOADED);
        entries[entry] = (int32_t)(word ^ sign) - (int32_t)sign;
    }
    return POSICAST_OK;
}

uint32_t posicast_error_weight(const posicast_stage *stage, uint32_t axis)
{
    return has_table(stage, axis) ? FIELD(error_status(stage, axis), POSICAST_AXIS_ERROR_STATUS_ERROR_WEIGHT) : 0;
}

int32_t posicast_error_now(const posicast_stage *stage, uint32_t axis)
{
    return has_table(stage, axis) ? (int32_t)IORD_POSICAST_AXIS_ERROR_NOW(stage->base, axis) : 0;
}
