/*
 * Tests the arithmetic of the driver, without registers. Commands on standard input:
 *   m start end velocity acceleration jerk   plans a move; prints the result, the entries, and the state after them
 *   e w0 w1 w2 w3 ticks                      plays an entry; prints the state at each tick
 *   p position velocity ticks order          adds a point of a stream; prints the result, the entry, and the state after it
 *   s deceleration ticks                     the same for a stop
 *   0 position                               rests there
 */
#include <inttypes.h>
#include <stdio.h>

#include "posicast_plan.h"
#include "posicast_stream.h"

/* The arithmetic of streams is in the same file as their accesses to registers. */
uint32_t posicast_read(uintptr_t base, uint32_t word)
{
    (void)base;
    (void)word;
    return 0;
}

void posicast_write(uintptr_t base, uint32_t word, uint32_t data)
{
    (void)base;
    (void)word;
    (void)data;
}

static void show(int fits, const posicast_integrator *at)
{
    const posicast_motion word = posicast_rounded(at);

    printf("%d %" PRId64 " %" PRId64 " %" PRId64 " %" PRId32 " %" PRId32 " %" PRId32 "\n", fits, at->position,
           at->velocity, at->acceleration, word.position, word.velocity, word.acceleration);
}

static void plan(posicast_integrator *at)
{
    posicast_entry entries[POSICAST_PLAN_ROOM];
    posicast_limits limits;
    posicast_result result;
    int32_t start, end;
    uint32_t count, place, tick;
    int fits = 1;

    if (scanf("%" SCNd32 " %" SCNd32 " %" SCNd64 " %" SCNd64 " %" SCNd64, &start, &end, &limits.velocity,
              &limits.acceleration, &limits.jerk) != 5)
        return;
    result = posicast_plan_move(start, end, &limits, entries, POSICAST_PLAN_ROOM, &count);
    printf("%d %" PRIu32 "\n", result, count);
    if (result != POSICAST_OK)
        return;
    *at = posicast_resting_at(start);
    for (place = 0; place < count; place++) {
        const uint32_t *words = entries[place].words;

        for (tick = 0; fits && tick < posicast_entry_ticks(&entries[place]); tick++)
            fits = posicast_integrate(at, &entries[place]);
        printf("%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", words[0], words[1], words[2], words[3]);
        show(fits, at);
    }
}

static void stream(posicast_integrator *at)
{
    posicast_stream_point point;
    posicast_entry entry;
    posicast_result result;
    uint32_t ticks, order;
    int fits;

    if (scanf("%" SCNd32 " %" SCNd32 " %" SCNu32 " %" SCNu32, &point.position, &point.velocity, &ticks, &order) != 4)
        return;
    result = posicast_stream_entry(at, &point, ticks, (posicast_stream_order)order, &entry);
    printf("%d\n", result);
    if (result != POSICAST_OK)
        return;
    printf("%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", entry.words[0], entry.words[1], entry.words[2],
           entry.words[3]);
    fits = posicast_play(at, &entry);
    show(fits, at);
}

int main(void)
{
    posicast_integrator at = posicast_resting_at(0);
    posicast_entry entry;
    int64_t deceleration;
    uint32_t ticks;
    int32_t position;
    int fits;
    char kind;

    while (scanf(" %c", &kind) == 1) {
        if (kind == 'm') {
            plan(&at);
        } else if (kind == 'e' && scanf("%" SCNu32 " %" SCNu32 " %" SCNu32 " %" SCNu32 " %" SCNu32, &entry.words[0],
                                        &entry.words[1], &entry.words[2], &entry.words[3], &ticks) == 5) {
            fits = posicast_begin(&at, &entry);
            show(fits, &at);
            while (--ticks > 0) {
                fits = posicast_integrate(&at, &entry);
                show(fits, &at);
            }
        } else if (kind == 's' && scanf("%" SCNd64 " %" SCNu32, &deceleration, &ticks) == 2) {
            while (ticks-- > 0) {
                posicast_integrate_stop(&at, deceleration);
                show(1, &at);
            }
        } else if (kind == 'p') {
            stream(&at);
        } else if (kind == '0' && scanf("%" SCNd32, &position) == 1) {
            at = posicast_resting_at(position);
        }
        (void)fflush(stdout);
    }
    return 0;
}
