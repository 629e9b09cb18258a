/* Tables of axes whose modes move. */
#include "posicast_family.h"
#include "posicast_wait.h"

uint32_t posicast_table_for(const posicast_family *family, uint32_t in_use, double value)
{
    uint32_t place = in_use < family->count ? in_use : family->nominal;

    while (place > 0 && value < family->member[place].down)
        place--;
    while (place + 1u < family->count && value > family->member[place].up)
        place++;
    return place;
}

posicast_result posicast_select_table(const posicast_stage *stage, uint32_t axis, const posicast_family *family,
                                      uint32_t place, uint32_t how, uint32_t ticks)
{
    uint32_t bank;

    if (!is_axis(stage, axis) || place >= family->count)
        return POSICAST_BAD_ARGUMENT;
    if (place == family->nominal)
        return posicast_use_table(stage, axis, 0, how, ticks);
    bank = FIELD(posicast_status(stage, axis), POSICAST_AXIS_STATUS_TABLE_BANK) == 1u ? 2u : 1u;
    return posicast_load_table(stage, axis, bank, &family->member[place].table, how, ticks);
}
