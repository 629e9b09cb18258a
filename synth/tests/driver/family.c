/* A program that changes the tap tables of an axis while it moves and its mode with it. */
#include "pipe.h"
#include "posicast_family.h"

/* Counts per unit of the points: m. */
#define COUNTS_PER_M 1000000.0

int main(void)
{
    const posicast_family *family = &machine_xy_stage_family_of_x;
    const uint32_t how = POSICAST_AXIS_SWAP_SWAP_HOW_HANDOVER;
    posicast_stage stage;
    uint32_t in_use = family->nominal, changes = 0;
    posicast_tap taps[64];
    uint32_t count, tap, same;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    need("switch on", posicast_switch_on(&stage, 1u << X, TICKS), POSICAST_OK);
    need("no such table", posicast_select_table(&stage, X, family, family->count, how, TICKS), POSICAST_BAD_ARGUMENT);
    need("no such axis", posicast_select_table(&stage, 7, family, 0, how, TICKS), POSICAST_BAD_ARGUMENT);
    need("move", posicast_queue_move(&stage, X, COUNTS(90000), limits_of(X)), POSICAST_OK);
    need("start", posicast_start(&stage, 1u << X), POSICAST_OK);
    do {
        const double value = (double)posicast_command_position(&stage, X) / (256.0 * COUNTS_PER_M);
        const uint32_t wanted = posicast_table_for(family, in_use, value);

        if (wanted != in_use) {
            need("another table", posicast_select_table(&stage, X, family, wanted, how, TICKS), POSICAST_OK);
            in_use = wanted;
            changes++;
        }
        pause_here(NULL);
    } while (posicast_state(&stage, X) == POSICAST_AXIS_STATUS_STATE_RUN);
    need("rest", posicast_wait_at_rest(&stage, 1u << X, TICKS), POSICAST_OK);
    result("tables", family->count);
    result("in_use", in_use);
    result("changes", changes);
    need("reads back", posicast_read_table(&stage, X, 2u - changes % 2u, taps, 64, &count, TICKS), POSICAST_OK);
    same = count == family->member[in_use].table.count;
    for (tap = 0; tap < count && same; tap++)
        same = taps[tap].delay_samples == family->member[in_use].table.taps[tap].delay_samples &&
               taps[tap].coefficient == family->member[in_use].table.taps[tap].coefficient;
    result("loaded", same);
    need("the machine's", posicast_select_table(&stage, X, family, family->nominal, how, TICKS), POSICAST_OK);
    result("bank", (IORD_POSICAST_AXIS_STATUS(stage.base, X) & POSICAST_AXIS_STATUS_TABLE_BANK_MSK) >>
                       POSICAST_AXIS_STATUS_TABLE_BANK_OFST);
    result("from_nowhere", posicast_table_for(family, 99, family->member[0].value));
    result("command", posicast_command_position(&stage, X));
    result("causes", posicast_causes(&stage, X));
    return 0;
}
