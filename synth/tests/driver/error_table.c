/* A program that homes an axis with an inaccurate screw, and loads another error table. */
#include "pipe.h"
#include "posicast_error_table.h"
#include "posicast_homing.h"

#define LONG (POSICAST_ERROR_WEIGHT_FULL + 50u)

static void go(posicast_stage *stage, int32_t counts)
{
    need("move", posicast_queue_move(stage, X, COUNTS(counts), limits_of(X)), POSICAST_OK);
    need("start", posicast_start(stage, 1u << X), POSICAST_OK);
    need("rest", posicast_wait_at_rest(stage, 1u << X, LONG), POSICAST_OK);
    need("settles", posicast_wait_ticks(stage, 300), POSICAST_OK);
}

int main(void)
{
    static int32_t entries[POSICAST_ERROR_ENTRIES_MAX], back[POSICAST_ERROR_ENTRIES_MAX];
    const posicast_error_point points[] = {{-100000, 0}, {0, 0}, {100000, 50}};
    const posicast_error_point wrong[] = {{0, 0}, {0, 1}};
    const posicast_error_point large[] = {{0, 0}, {100000, 600}};
    posicast_stage stage;
    posicast_error_format format;
    posicast_snapshot at;
    uint32_t entry, same;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    need("none on y", posicast_error_format_of(&stage, Y, &format), POSICAST_BAD_ARGUMENT);
    need("format", posicast_error_format_of(&stage, X, &format), POSICAST_OK);
    result("entries", format.entries);
    result("spacing", format.spacing);
    result("first", format.first);
    need("on", posicast_switch_on(&stage, 1u << X, TICKS), POSICAST_OK);
    go(&stage, 10000);
    result("not_homed", posicast_error_weight(&stage, X));
    posicast_take_snapshot(&stage, &at);
    result("counted_before", at.position[X]);

    /* The machine file's table corrects 20 counts at 100,000. */
    need("homed", posicast_limit_travel(&stage, X, COUNTS(-90000), COUNTS(90000)), POSICAST_OK);
    need("comes in force", posicast_wait_ticks(&stage, LONG), POSICAST_OK);
    result("weight", posicast_error_weight(&stage, X));
    result("error", posicast_error_now(&stage, X));
    posicast_take_snapshot(&stage, &at);
    result("counted", at.position[X]);

    /* Another table corrects 50 counts. */
    need("two at one place", posicast_error_entries(&format, wrong, 2, entries), POSICAST_BAD_ARGUMENT);
    need("more than an entry holds", posicast_error_entries(&format, large, 2, entries), POSICAST_BAD_ARGUMENT);
    need("entries", posicast_error_entries(&format, points, 3, entries), POSICAST_OK);
    need("one too few", posicast_load_error_table(&stage, X, entries, format.entries - 1, LONG), POSICAST_BAD_ARGUMENT);
    need("none loaded", posicast_use_error_table(&stage, X, 1, LONG), POSICAST_WRONG_STATE);
    need("loads", posicast_load_error_table(&stage, X, entries, format.entries, LONG), POSICAST_OK);
    need("comes in force", posicast_wait_ticks(&stage, LONG), POSICAST_OK);
    result("error_loaded", posicast_error_now(&stage, X));
    need("reads back", posicast_read_error_table(&stage, X, 1, back, format.entries, TICKS), POSICAST_OK);
    same = 1;
    for (entry = 0; entry < format.entries; entry++)
        same = same && back[entry] == entries[entry];
    result("same", same);
    need("reads the machine's", posicast_read_error_table(&stage, X, 0, back, format.entries, TICKS), POSICAST_OK);
    result("machine_first", back[0]);
    result("machine_last", back[format.entries - 1]);

    /* A step of more than a sixteenth of the distance is refused, and the machine's table stays in use. */
    entries[3] = entries[2] + (int32_t)(format.spacing << format.fraction_bits) / 16 + 1;
    need("too steep", posicast_load_error_table(&stage, X, entries, format.entries, LONG), POSICAST_REFUSED);
    need("machine's again", posicast_wait_ticks(&stage, LONG), POSICAST_OK);
    result("error_refused", posicast_error_now(&stage, X));
    need("off", posicast_enable_error_table(&stage, X, 0, LONG), POSICAST_OK);
    result("error_off", posicast_error_now(&stage, X));
    /* A position at 2^31 counts, where it comes round: no axis is homed there. */
    IOWR_POSICAST_AXIS_PRESET(stage.base, X, 0x7fffff00u);
    need("preset", posicast_wait_ticks(&stage, TICKS), POSICAST_OK);
    need("too far", posicast_limit_travel(&stage, X, COUNTS(-90000), COUNTS(90000)), POSICAST_BAD_ARGUMENT);
    result("causes", posicast_causes(&stage, X));
    return 0;
}
