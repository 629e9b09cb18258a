/*
 * A program for the core beside the stage: on, home, a move of two axes, a move with a fault in it, recovery, a path that is computed on the way. The core sleeps while the
 * driver waits, and wakes by the stage's interrupts. What it finds goes to the console, as "= name value"; "> step" begins a step.
 */
#include "machine_slide.h"
#include "posicast_driver.h"
#include "posicast_homing.h"
#include "posicast_stream.h"

#define X MACHINE_SLIDE_AXIS_X
#define Y MACHINE_SLIDE_AXIS_Y
#define BOTH 3u
#define COUNTS(n) ((int32_t)(n) * 256)
#define TICKS 2000u
#define OF_X(interrupt) POSICAST_AXIS_INTERRUPT(X, POSICAST_INTERRUPT_##interrupt)
#define OF_Y(interrupt) POSICAST_AXIS_INTERRUPT(Y, POSICAST_INTERRUPT_##interrupt)
#define WATCHED (OF_X(MOVE_DONE) | OF_Y(MOVE_DONE) | OF_X(INDEX_SEEN) | OF_X(FAULTED) | OF_Y(STOPPING))

#include CORE

static posicast_stage stage;
/* Events from interrupts since they were last cleared, and the number of each kind. */
static volatile uint32_t happened, ticks_seen, events_seen, nothing_seen;

static void print(const char *text)
{
    while (*text != 0)
        put(*text++);
}

static void step(const char *name)
{
    print("> ");
    print(name);
    print("\n");
}

static void result(const char *name, int32_t value)
{
    static const char digits[] = "0123456789abcdef";
    int shift;

    print("= ");
    print(name);
    print(" ");
    for (shift = 28; shift >= 0; shift -= 4)
        put(digits[(uint32_t)value >> shift & 15u]);
    print("\n");
}

static void end(int32_t status)
{
    result("end", status);
    for (;;)
        ;
}

void interrupt(void);

void interrupt(void)
{
    uint32_t now;

    mark_handler(1);
    if (has_trapped())
        end(3);
    now = posicast_take_interrupts(&stage);
    happened |= now;
    ticks_seen += (now & POSICAST_STAGE_INTERRUPT_STATE_TICK_MSK) != 0;
    events_seen += (now & WATCHED) != 0;
    nothing_seen += now == 0;
    mark_handler(0);
}

static void need(const char *what, posicast_result got, posicast_result wanted)
{
    if (got == wanted)
        return;
    print("! ");
    print(what);
    print("\n");
    result("got", (int32_t)got);
    result("causes_x", (int32_t)posicast_causes(&stage, X));
    result("causes_y", (int32_t)posicast_causes(&stage, Y));
    end(2);
}

#define STACK_MARK 0x57ac57acu
#define STACK_WORDS 1024u
extern uint32_t __stack_top[];

/* The memory below the current end of the stack is marked; what is overwritten later was used. */
static void mark_stack(void)
{
    uint32_t *word = __stack_top - STACK_WORDS;
    uint32_t *here = __builtin_frame_address(0);

    while (word < here - 32)
        *word++ = STACK_MARK;
}

static int32_t stack_bytes(void)
{
    const uint32_t *word = __stack_top - STACK_WORDS;

    while (*word == STACK_MARK)
        word++;
    return (int32_t)((uintptr_t)__stack_top - (uintptr_t)word);
}

static void queue_both(int32_t x, int32_t y)
{
    step("queue x");
    need("queue x", posicast_queue_move(&stage, X, x, &machine_slide.axis[X].limits), POSICAST_OK);
    step("queue y");
    need("queue y", posicast_queue_move(&stage, Y, y, &machine_slide.axis[Y].limits), POSICAST_OK);
    happened = 0;
    step("start");
    need("start", posicast_start(&stage, BOTH), POSICAST_OK);
}

static void positions(const char *x, const char *y)
{
    posicast_snapshot at;

    step("snapshot");
    posicast_take_snapshot(&stage, &at);
    step("");
    result(x, at.position[X]);
    result(y, at.position[Y]);
}

static void homing(void)
{
    /* The index is position 1000. */
    posicast_homing how = {machine_slide.axis[X].limits, COUNTS(60), COUNTS(-40), 1000};

    /* 0.3 counts per tick. */
    how.limits.velocity = ((int64_t)3 << 32) / 10;
    happened = 0;
    step("home");
    need("home", posicast_home(&stage, X, &how, TICKS), POSICAST_OK);
    step("");
    result("home_events", (int32_t)(happened & OF_X(INDEX_SEEN)));
    result("origin", posicast_origin(&stage, X));
}

static void move(void)
{
    queue_both(COUNTS(90), COUNTS(-70));
    step("move");
    need("rest", posicast_wait_at_rest(&stage, BOTH, TICKS), POSICAST_OK);
    step("");
    result("move_events", (int32_t)(happened & WATCHED));
    positions("x_moved", "y_moved");
}

static void fault(void)
{
    queue_both(COUNTS(-60), COUNTS(40));
    step("fault");
    need("a fault", posicast_wait_at_rest(&stage, 1u << X, TICKS), POSICAST_FAULT);
    need("the stop", posicast_wait_ticks(&stage, 100), POSICAST_OK);
    step("");
    result("fault_events", (int32_t)(happened & WATCHED));
    result("fault_causes_x", (int32_t)posicast_causes(&stage, X));
    result("fault_causes_y", (int32_t)posicast_causes(&stage, Y));
    result("stopped_at", posicast_command_position(&stage, X));
    /* The drive is repaired at this step. */
    step("mend");
    need("on again", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_OK);
    queue_both(COUNTS(-60), COUNTS(40));
    step("move");
    need("rest again", posicast_wait_at_rest(&stage, BOTH, TICKS), POSICAST_OK);
    step("");
    result("left_causes", (int32_t)(posicast_causes(&stage, X) | posicast_causes(&stage, Y)));
    positions("x_again", "y_again");
}

/* Number of periods of acceleration, and of deceleration, and their length in ticks; then one period at rest. */
#define RAMP 5
#define PERIOD 100
#define AHEAD 2
/* Q16.16 counts per tick in a period: 0.02. The way is RAMP^2 * PERIOD * 0.02 = 50 counts. */
#define FASTER 1311

static void point_after(posicast_stream_point *point, int32_t sign, int32_t period)
{
    const int32_t faster = period <= RAMP ? FASTER : period <= 2 * RAMP ? -FASTER : 0;
    const int32_t before = point->velocity;

    point->velocity += sign * faster;
    point->position += (before + point->velocity) * PERIOD / 2 / 256;
}

static void path(void)
{
    static posicast_stream stream;
    posicast_stream_point point[2] = {{0, 0}, {0, 0}};
    uint32_t first_tick = 0;
    int32_t period;

    point[X].position = posicast_command_position(&stage, X);
    point[Y].position = posicast_command_position(&stage, Y);
    need("a stream", posicast_stream_open(&stream, &stage, BOTH, POSICAST_STREAM_CUBIC, 20), POSICAST_OK);
    for (period = 1; period <= 2 * RAMP + 1; period++) {
        while (period > AHEAD && ticks_seen - first_tick < (uint32_t)((period - AHEAD - 1) * PERIOD))
            sleep(0);
        point_after(&point[X], 1, period);
        point_after(&point[Y], -1, period);
        if (period == RAMP)
            step("a point");
        need("a point", posicast_stream_write(&stream, point, PERIOD), POSICAST_OK);
        if (period == RAMP)
            step("");
        if (period == AHEAD) {
            need("start the stream", posicast_stream_start(&stream), POSICAST_OK);
            first_tick = ticks_seen;
        }
    }
    need("the end", posicast_wait_at_rest(&stage, BOTH, TICKS), POSICAST_OK);
    result("path_x", posicast_command_position(&stage, X) - point[X].position);
    result("path_y", posicast_command_position(&stage, Y) - point[Y].position);
    result("late", (int32_t)(stream.axis[X].late_ticks + stream.axis[Y].late_ticks));
}

int main(void)
{
    posicast_result opened;

    mark_stack();
    step("open");
    opened = posicast_open(&stage, STAGE_BASE);
    step("");
    if (opened == POSICAST_OTHER_MACHINE) {
        result("found", (int32_t)stage.refused.found);
        result("wanted", (int32_t)stage.refused.wanted);
        end(0);
    }
    need("open", opened, POSICAST_OK);
    stage.pause = sleep;
    posicast_enable_interrupts(&stage, POSICAST_STAGE_INTERRUPT_STATE_TICK_MSK | WATCHED);
    let_through(STAGE_IRQ);
    step("switch on");
    need("switch on", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_OK);
    homing();
    move();
    fault();
    path();
    step("ten ticks");
    need("ten ticks", posicast_wait_ticks(&stage, 10), POSICAST_OK);
    step("off");
    need("off", posicast_switch_off(&stage, BOTH, TICKS), POSICAST_OK);
    step("");
    result("ticks", (int32_t)ticks_seen);
    result("events", (int32_t)events_seen);
    result("nothing", (int32_t)nothing_seen);
    result("stack", stack_bytes());
    end(0);
    return 0;
}
