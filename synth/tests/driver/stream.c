/* A program that computes its path while it moves, a point per axis and millisecond: some early, some late, one never. */
#include <string.h>

#include "pipe.h"
#include "posicast_stream.h"

#define PERIOD 10u
#define AHEAD 3u
#define RADIUS 80.0
/* 1/200 of a turn. */
#define COSINE 0.99950656036573156
#define SINE 0.03141075907812829
#define TURN 200u

static posicast_stream stream;
static uint32_t first_tick, periods;
static double cosine = 1.0, sine = 0.0;

static uint32_t now(const posicast_stage *stage)
{
    return (uint32_t)IORD_POSICAST_STAGE_TICK_COUNT(stage->base);
}

static int32_t rounded(double value)
{
    return (int32_t)(value + (value < 0 ? -0.5 : 0.5));
}

/* Continues along a circle that begins and ends at 0, 0. */
static void next(posicast_stream_point *point)
{
    const double before = cosine, speed = RADIUS * 0.031415926535897932 / PERIOD;

    cosine = before * COSINE - sine * SINE;
    sine = sine * COSINE + before * SINE;
    point[X].position = rounded(256.0 * RADIUS * (1.0 - cosine));
    point[X].velocity = rounded(65536.0 * speed * sine);
    point[Y].position = rounded(256.0 * RADIUS * sine);
    point[Y].velocity = rounded(65536.0 * speed * cosine);
}

static void wait_for_period(const posicast_stage *stage)
{
    while (now(stage) - first_tick < PERIOD * periods)
        pause_here(NULL);
}

static posicast_result write_next(const posicast_stage *stage)
{
    posicast_stream_point point[2];

    wait_for_period(stage);
    periods++;
    next(point);
    return posicast_stream_write(&stream, point, PERIOD);
}

static void begin(const posicast_stage *stage)
{
    uint32_t ahead;

    cosine = 1.0;
    sine = 0.0;
    periods = 0;
    need("open a stream", posicast_stream_open(&stream, stage, BOTH, POSICAST_STREAM_CUBIC, 25), POSICAST_OK);
    first_tick = now(stage) - AHEAD * PERIOD;
    for (ahead = 0; ahead < AHEAD; ahead++)
        need("a point ahead", write_next(stage), POSICAST_OK);
    need("start the stream", posicast_stream_start(&stream), POSICAST_OK);
    first_tick = now(stage) - AHEAD * PERIOD;
}

static void turn(const posicast_stage *stage)
{
    posicast_stream_point rest[2] = {{0, 0}, {0, 0}};
    uint32_t before, most = 0;

    need("no such axes", posicast_stream_open(&stream, stage, 4, POSICAST_STREAM_CUBIC, 25), POSICAST_BAD_ARGUMENT);
    need("too patient", posicast_stream_open(&stream, stage, BOTH, POSICAST_STREAM_CUBIC, 256), POSICAST_BAD_ARGUMENT);
    begin(stage);
    while (periods < TURN) {
        /* In the middle, the program is three periods late, which is more than it was ahead. */
        if (periods == TURN / 2)
            while (now(stage) - first_tick < PERIOD * (periods + AHEAD + 1) + 4)
                pause_here(NULL);
        wait_for_period(stage);
        before = accesses;
        need("a point", write_next(stage), POSICAST_OK);
        most = accesses - before > most ? accesses - before : most;
    }
    result("most_accesses", most);
    /* Returns to the beginning of the circle and rests there. */
    need("the end", posicast_stream_write(&stream, rest, PERIOD), POSICAST_OK);
    need("a rest", posicast_stream_write(&stream, rest, PERIOD), POSICAST_OK);
    need("rest", posicast_wait_at_rest(stage, BOTH, TICKS), POSICAST_OK);
    result("late_x", stream.axis[X].late_ticks);
    result("late_y", stream.axis[Y].late_ticks);
    result("turned_to_x", posicast_command_position(stage, X));
    result("turned_to_y", posicast_command_position(stage, Y));
    result("turn_causes", posicast_causes(stage, X) | posicast_causes(stage, Y));
    /* It continues by itself from where it was held. */
    rest[X].position = COUNTS(1);
    need("on from a rest", posicast_stream_write(&stream, rest, PERIOD), POSICAST_OK);
    need("a rest", posicast_stream_write(&stream, rest, PERIOD), POSICAST_OK);
    need("a while", posicast_wait_ticks(stage, 4 * PERIOD), POSICAST_OK);
    result("went_on_to_x", posicast_command_position(stage, X));
}

static void too_early(const posicast_stage *stage)
{
    posicast_stream_point here[2] = {{COUNTS(1), 0}, {0, 0}};
    posicast_stream_point far[2] = {{COUNTS(1), 0}, {COUNTS(4000000), 0}};
    uint32_t written = 0;

    need("rest", posicast_wait_at_rest(stage, BOTH, TICKS), POSICAST_OK);
    need("open a stream", posicast_stream_open(&stream, stage, BOTH, POSICAST_STREAM_LINEAR, 0), POSICAST_OK);
    need("farther than an axis goes", posicast_stream_write(&stream, far, PERIOD), POSICAST_BAD_ARGUMENT);
    result("level_after_far", IORD_POSICAST_AXIS_FIFO(stage->base, X) & POSICAST_AXIS_FIFO_FIFO_LEVEL_MSK);
    while (posicast_stream_write(&stream, here, PERIOD) == POSICAST_OK)
        written++;
    result("written_early", written);
    need("open with entries", posicast_stream_open(&stream, stage, BOTH, POSICAST_STREAM_LINEAR, 0),
         POSICAST_WRONG_STATE);
    IOWR_POSICAST_AXIS_FLUSH(stage->base, X, 0);
    IOWR_POSICAST_AXIS_FLUSH(stage->base, Y, 0);
    need("a while", posicast_wait_ticks(stage, 2), POSICAST_OK);
}

static void missing(const posicast_stage *stage)
{
    posicast_snapshot at;
    int32_t before;

    begin(stage);
    while (periods < TURN / 8)
        need("a point", write_next(stage), POSICAST_OK);
    before = posicast_rounded(&stream.axis[X].at).position;
    need("a stop", posicast_wait_at_rest(stage, 1u << X, TICKS), POSICAST_FAULT);
    need("the stop to end", posicast_wait_ticks(stage, 400), POSICAST_OK);
    result("missing_causes", posicast_causes(stage, X) & posicast_causes(stage, Y));
    result("named", strcmp(posicast_cause_name(posicast_causes(stage, X)), "segments") == 0);
    result("beyond", posicast_command_position(stage, X) - before);
    need("a point too late", write_next(stage), POSICAST_REFUSED);
    need("switch on again", posicast_switch_on(stage, BOTH, TICKS), POSICAST_OK);
    posicast_take_snapshot(stage, &at);
    result("causes_after", posicast_causes(stage, X) | posicast_causes(stage, Y));
}

int main(void)
{
    posicast_stage stage;

    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    stage.pause = pause_here;
    need("switch on", posicast_switch_on(&stage, BOTH, TICKS), POSICAST_OK);
    turn(&stage);
    too_early(&stage);
    missing(&stage);
    return 0;
}
