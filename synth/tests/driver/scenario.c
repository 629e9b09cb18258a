/* A program that uses the driver: moves, a fault, tables, settings, the self-test, and a stage that does not answer. */
#include <string.h>

#include "pipe.h"
#include "posicast_settings.h"

/* Goes from reset to a move of both axes. */
static void first_move(posicast_stage *stage)
{
    posicast_snapshot at;

    need("switch on", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    need("start of nothing", posicast_start(stage, 1u << 2), POSICAST_BAD_ARGUMENT);
    need("move X", posicast_queue_move(stage, X, COUNTS(40), limits_of(X)), POSICAST_OK);
    need("move Y", posicast_queue_move(stage, Y, COUNTS(-25), limits_of(Y)), POSICAST_OK);
    need("a second move", posicast_queue_move(stage, X, 0, limits_of(X)), POSICAST_WRONG_STATE);
    need("start", posicast_start(stage, BOTH), POSICAST_OK);
    need("switch on in a move", posicast_switch_on(stage, BOTH, TICKS), POSICAST_WRONG_STATE);
    need("come to rest", posicast_wait_at_rest(stage, BOTH, TICKS), POSICAST_OK);
    posicast_take_snapshot(stage, &at);
    result("x", at.position[X]);
    result("y", at.position[Y]);
    result("command_x", posicast_command_position(stage, X));
    result("command_y", posicast_command_position(stage, Y));
    result("ticks", at.tick_count);
}

static void queue_from(posicast_stage *stage, uint32_t axis, int32_t start, int32_t end)
{
    posicast_entry entries[POSICAST_PLAN_ROOM];
    uint32_t count, entry;

    need("plan", posicast_plan_move(start, end, limits_of(axis), entries, POSICAST_PLAN_ROOM, &count), POSICAST_OK);
    for (entry = 0; entry < count; entry++)
        need("an entry", posicast_write_entry(stage, axis, &entries[entry]), POSICAST_OK);
}

/* X moves there and back: a feed hold stops it at the far end, with the way back in its FIFO. */
static void feed_hold(posicast_stage *stage)
{
    need("no such axis", posicast_feed_hold(stage, 1u << 2), POSICAST_BAD_ARGUMENT);
    need("none that holds", posicast_wait_held(stage, 1u << X, TICKS), POSICAST_WRONG_STATE);
    queue_from(stage, X, COUNTS(40), COUNTS(60));
    queue_from(stage, X, COUNTS(60), COUNTS(40));
    need("start to and fro", posicast_start(stage, 1u << X), POSICAST_OK);
    /* The hold comes during the first move; at rest it would act before it. */
    need("a while", posicast_wait_ticks(stage, 20), POSICAST_OK);
    need("hold", posicast_feed_hold(stage, BOTH), POSICAST_OK);
    need("held", posicast_wait_held(stage, 1u << X, TICKS), POSICAST_OK);
    result("held_at", posicast_command_position(stage, X));
    result("held_state", posicast_state(stage, X));
    need("still held", posicast_wait_at_rest(stage, 1u << X, 200), POSICAST_TIMEOUT);
    need("go on", posicast_feed_hold(stage, 0), POSICAST_OK);
    need("the way back", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
    result("resumed_to", posicast_command_position(stage, X));
    result("held_causes", posicast_causes(stage, X));
}

/* The drive of X fails in a move: both axes stop, the fault is read and cleared, and the move starts again. */
static void fault(posicast_stage *stage)
{
    const posicast_entry nothing = posicast_segment(0, 0, 0), rest = posicast_segment(0, 1, 0);
    uint32_t causes;

    need("move X on", posicast_queue_move(stage, X, COUNTS(90), limits_of(X)), POSICAST_OK);
    need("move Y on", posicast_queue_move(stage, Y, COUNTS(40), limits_of(Y)), POSICAST_OK);
    posicast_enable_interrupts(stage, POSICAST_AXIS_INTERRUPT(X, POSICAST_INTERRUPT_FAULTED));
    (void)posicast_take_interrupts(stage);
    need("start again", posicast_start(stage, BOTH), POSICAST_OK);
    need("an entry without ticks", posicast_write_entry(stage, X, &nothing), POSICAST_BAD_ARGUMENT);
    need("a while", posicast_wait_ticks(stage, 20), POSICAST_OK);
    set_line("x_drive_fault_n", 0);
    need("a fault", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_FAULT);
    result("interrupt", posicast_take_interrupts(stage) == POSICAST_AXIS_INTERRUPT(X, POSICAST_INTERRUPT_FAULTED));
    causes = posicast_causes(stage, X);
    result("causes_x", causes);
    result("named", strcmp(posicast_cause_name(causes), "pwm tripped") == 0);
    need("a fault that stays", posicast_switch_on(stage, BOTH, 20), POSICAST_WRONG_STATE);
    need("an entry in a stop", posicast_write_entry(stage, Y, &rest), POSICAST_REFUSED);
    need("the group to stop", posicast_wait_at_rest(stage, 1u << Y, TICKS), POSICAST_FAULT);
    need("the stop to end", posicast_wait_ticks(stage, 200), POSICAST_OK);
    result("causes_y", posicast_causes(stage, Y));
    need("a fault that stays", posicast_switch_on(stage, BOTH, 20), POSICAST_FAULT);
    set_line("x_drive_fault_n", 1);
    need("switch on again", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    result("causes_after", posicast_causes(stage, X) | posicast_causes(stage, Y));
    need("move X again", posicast_queue_move(stage, X, COUNTS(90), limits_of(X)), POSICAST_OK);
    need("start X", posicast_start(stage, 1u << X), POSICAST_OK);
    need("rest", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
    result("after_fault_x", posicast_command_position(stage, X));
}

/* Returns whether the bank of X has exactly these taps. */
static int holds(posicast_stage *stage, uint32_t bank, const posicast_tap *taps, uint32_t count)
{
    posicast_tap back[8];
    uint32_t found, tap;

    need("reads a table", posicast_read_table(stage, X, bank, back, 8, &found, TICKS), POSICAST_OK);
    for (tap = 0; tap < found && tap < count && tap < 8; tap++)
        if (back[tap].delay_samples != taps[tap].delay_samples || back[tap].coefficient != taps[tap].coefficient)
            return 0;
    return found == count;
}

/* Loads another table while the axis moves, tries what is refused, and switches off. */
static void tables(posicast_stage *stage)
{
    static const posicast_tap one[] = {{0, 65536}};
    static const posicast_tap late[] = {{0, 65636}, {126, -100}};
    static const posicast_tap wrong[] = {{0, 65535}};
    const posicast_table machine = machine_xy_stage.axis[X].table;
    posicast_table table = {one, 1, machine.coefficient_fraction};
    posicast_tap none[1];
    uint32_t count;

    result("machine_taps", (int64_t)IORD_POSICAST_AXIS_MACHINE_TAPS(stage->base, X) == machine.count);
    result("read_empty", holds(stage, 1, one, 0));
    need("move X", posicast_queue_move(stage, X, COUNTS(400), limits_of(X)), POSICAST_OK);
    need("start X", posicast_start(stage, 1u << X), POSICAST_OK);
    need("table", posicast_load_table(stage, X, 1, &table, POSICAST_AXIS_SWAP_SWAP_HOW_HANDOVER, TICKS), POSICAST_OK);
    result("bank", (IORD_POSICAST_AXIS_STATUS(stage->base, X) & POSICAST_AXIS_STATUS_TABLE_BANK_MSK) >>
                       POSICAST_AXIS_STATUS_TABLE_BANK_OFST);
    need("the bank in use", posicast_load_table(stage, X, 1, &table, 0, TICKS), POSICAST_WRONG_STATE);
    table.taps = wrong;
    need("no table", posicast_load_table(stage, X, 2, &table, 0, TICKS), POSICAST_BAD_ARGUMENT);
    table.taps = late;
    table.count = 2;
    need("a late table", posicast_load_table(stage, X, 2, &table, POSICAST_AXIS_SWAP_SWAP_HOW_HANDOVER, TICKS),
         POSICAST_OK);
    result("settle", IORD_POSICAST_AXIS_SETTLE(stage->base, X));
    result("read_back", holds(stage, 2, late, 2) && holds(stage, 1, one, 1));
    result("read_machine", holds(stage, 0, machine.taps, machine.count));
    need("reads no tap, but how many", posicast_read_table(stage, X, 2, none, 0, &count, TICKS), POSICAST_OK);
    result("read_count", count);
    need("bank 3", posicast_read_table(stage, X, 3, none, 1, &count, TICKS), POSICAST_BAD_ARGUMENT);
    need("the machine's", posicast_use_table(stage, X, 0, POSICAST_AXIS_SWAP_SWAP_HOW_HANDOVER, TICKS), POSICAST_OK);
    need("rest", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
    result("x", posicast_command_position(stage, X));
    result("causes", posicast_causes(stage, X));
    need("off", posicast_switch_off(stage, BOTH, TICKS), POSICAST_OK);
    result("off", posicast_state(stage, X));
}

/* Uses a controller whose command is 0 while the reference moves; then the machine's again, with another gain. */
static void settings(posicast_stage *stage)
{
    const posicast_settings *machine = &machine_xy_stage.axis[X].settings;
    posicast_settings changed = *machine, back;
    posicast_snapshot at;
    uint32_t gain = machine->word[POSICAST_SETTING_PROPORTIONAL], row, unwritten = 0;

    changed.word[POSICAST_SETTING_LIMIT] = 0;
    need("no command", posicast_load_settings(stage, X, 2, &changed, TICKS), POSICAST_OK);
    need("the bank in use", posicast_load_settings(stage, X, 2, &changed, TICKS), POSICAST_WRONG_STATE);
    need("bank 0", posicast_load_settings(stage, X, 0, &changed, TICKS), POSICAST_BAD_ARGUMENT);
    need("reads the bank in use", posicast_read_settings(stage, X, 2, &back, TICKS), POSICAST_OK);
    result("read_back", memcmp(back.word, changed.word, sizeof back.word) == 0 && back.law == changed.law);
    need("reads the machine's", posicast_read_settings(stage, X, 0, &back, TICKS), POSICAST_OK);
    result("read_machine", memcmp(back.word, machine->word, sizeof back.word) == 0);
    need("reads bank 1", posicast_read_settings(stage, X, 1, &back, TICKS), POSICAST_OK);
    for (row = 0; row < POSICAST_SETTINGS; row++)
        unwritten |= back.word[row];
    result("read_unwritten", unwritten);
    need("bank 3", posicast_read_settings(stage, X, 3, &back, TICKS), POSICAST_BAD_ARGUMENT);
    need("law 3", posicast_use_settings(stage, X, 0, 3, TICKS), POSICAST_BAD_ARGUMENT);
    need("move X", posicast_queue_move(stage, X, COUNTS(20), limits_of(X)), POSICAST_OK);
    need("start X", posicast_start(stage, 1u << X), POSICAST_OK);
    need("rest", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_OK);
    posicast_take_snapshot(stage, &at);
    result("without_command", at.position[X]);
    need("3/0", posicast_scale_gain(&gain, 3, 0), POSICAST_BAD_ARGUMENT);
    need("3/2", posicast_scale_gain(&gain, 3, 2), POSICAST_OK);
    result("gain", machine->word[POSICAST_SETTING_PROPORTIONAL]);
    result("gain_3_2", gain);
    gain = 0x1ffff;
    need("too large", posicast_scale_gain(&gain, 65535, 1), POSICAST_BAD_ARGUMENT);
    result("unchanged", gain);
    need("the machine's", posicast_use_settings(stage, X, 0, machine->law, TICKS), POSICAST_OK);
    need("a while", posicast_wait_ticks(stage, 400), POSICAST_OK);
    posicast_take_snapshot(stage, &at);
    result("with_command", at.position[X]);
    result("causes", posicast_causes(stage, X));
}

/* Tests the PWM of Y alone, in READY. */
static void self_test(posicast_stage *stage)
{
    posicast_self_test_clocks counted;

    need("not in OFF", posicast_self_test(stage, Y, 0, &counted), POSICAST_WRONG_STATE);
    need("on", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    need("off", posicast_switch_off(stage, BOTH, TICKS), POSICAST_OK);
    need("a while", posicast_wait_ticks(stage, 4), POSICAST_OK);
    need("self-test", posicast_self_test(stage, Y, -101, &counted), POSICAST_OK);
    result("high", counted.a_high);
    result("low", counted.a_low);
}

int main(int argc, char **argv)
{
    posicast_stage stage;
    posicast_result found = posicast_open(&stage, BASE);

    stage.pause = pause_here;
    if (argc == 2 && strcmp(argv[1], "absent") == 0) {
        need("nothing", found, POSICAST_NOT_FOUND);
        return 0;
    }
    need("open", found, POSICAST_OK);
    if (argc == 2 && strcmp(argv[1], "dead") == 0) {
        need("a stage without a clock", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_DEAD);
        return 0;
    }
    if (argc == 2 && strcmp(argv[1], "tables") == 0) {
        self_test(&stage);
        need("on again", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_OK);
        tables(&stage);
        return 0;
    }
    if (argc == 2 && strcmp(argv[1], "settings") == 0) {
        need("on", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_OK);
        settings(&stage);
        return 0;
    }
    first_move(&stage);
    feed_hold(&stage);
    fault(&stage);
    return 0;
}
