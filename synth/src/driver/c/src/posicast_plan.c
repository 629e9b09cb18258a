/* The planner of posicast_plan.h. It plans without signs; in the end every jerk gets the sign of the distance. */
#include "posicast_plan.h"

/* Number of changes of the jerk in one move, and in a move with all superposed moves. */
#define MOVE_CHANGES 8u
#define CORRECTIONS_MAX 3u
#define CHANGES_MAX (MOVE_CHANGES * (1u + CORRECTIONS_MAX))

/* Half an LSB of a command word, in LSB of 2^-32. */
#define HALF_A_WORD ((uint64_t)1 << (POSICAST_FRACTION_BITS - POSICAST_POSITION_FRACTION - 1))

/* Numbers of ticks with jerk, with constant acceleration and with constant velocity. */
typedef struct {
    uint64_t jerk;
    uint64_t constant;
    uint64_t cruise;
} stretches;

/* Ticks, in order, at which the jerk changes, and the changes. */
typedef struct {
    uint64_t tick[CHANGES_MAX];
    int64_t change[CHANGES_MAX];
    uint32_t count;
} jerk_changes;

/* Multiplies; the result saturates instead of wrapping, so that it grows with both factors. */
static uint64_t product(uint64_t a, uint64_t b)
{
    return a != 0 && b > UINT64_MAX / a ? UINT64_MAX : a * b;
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Returns the largest n with n * n <= square. */
static uint64_t root(uint64_t square)
{
    uint64_t low = 0, beyond = (uint64_t)1 << 32;

    while (beyond - low > 1) {
        const uint64_t middle = low + (beyond - low) / 2;

        if (middle <= square / middle)
            low = middle;
        else
            beyond = middle;
    }
    return low;
}

/* Returns the distance that one LSB of jerk covers, in LSB. */
static uint64_t reach(uint64_t jerk, uint64_t constant, uint64_t cruise)
{
    const uint64_t ramp = jerk + constant;

    return product(product(jerk, ramp), ramp + jerk + cruise);
}

/* Returns the shortest durations that cover the distance with `jerk`, within the limits. */
static stretches fastest(uint64_t needed, uint64_t jerk, const posicast_limits *limits)
{
    const uint64_t by_acceleration = (uint64_t)limits->acceleration / jerk;
    const uint64_t by_velocity = root((uint64_t)limits->velocity / jerk);
    stretches of = {1, 0, 0};
    uint64_t most = least(least(by_acceleration, by_velocity), POSICAST_TICKS_MAX);
    uint64_t ramp;

    while (of.jerk < most) {
        const uint64_t middle = of.jerk + (most - of.jerk) / 2;

        if (reach(middle, 0, 0) >= needed)
            most = middle;
        else
            of.jerk = middle + 1;
    }
    /* The velocity at the top is jerk * of.jerk * ramp. */
    ramp = (uint64_t)limits->velocity / jerk / of.jerk;
    most = ramp > of.jerk ? least(ramp - of.jerk, POSICAST_TICKS_MAX) : 0;
    while (of.constant < most) {
        const uint64_t middle = of.constant + (most - of.constant) / 2;

        if (reach(of.jerk, middle, 0) >= needed)
            most = middle;
        else
            of.constant = middle + 1;
    }
    ramp = of.jerk + of.constant;
    if (reach(of.jerk, of.constant, 0) < needed) {
        const uint64_t per_tick = of.jerk * ramp;

        of.cruise = (needed + per_tick - 1) / per_tick - ramp - of.jerk;
    }
    return of;
}

static void add_change(jerk_changes *all, uint64_t tick, int64_t change)
{
    uint32_t place = all->count, later;

    while (place > 0 && all->tick[place - 1] > tick)
        place--;
    if (place > 0 && all->tick[place - 1] == tick) {
        all->change[place - 1] += change;
        return;
    }
    for (later = all->count; later > place; later--) {
        all->tick[later] = all->tick[later - 1];
        all->change[later] = all->change[later - 1];
    }
    all->tick[place] = tick;
    all->change[place] = change;
    all->count++;
}

/* Superposes a move with this jerk on the others. */
static void add_move(jerk_changes *all, const stretches *of, int64_t jerk)
{
    static const int times[MOVE_CHANGES] = {1, -1, -1, 1, -1, 1, 1, -1};
    const uint64_t lengths[MOVE_CHANGES] = {0,          of->jerk, of->constant, of->jerk,
                                            of->cruise, of->jerk, of->constant, of->jerk};
    uint64_t tick = 0;
    uint32_t place;

    for (place = 0; place < MOVE_CHANGES; place++) {
        tick += lengths[place];
        add_change(all, tick, jerk * times[place]);
    }
}

/* Adds moves of the same duration, each with the longest jerk that one LSB of it allows, until almost no distance is left. */
static void add_corrections(jerk_changes *all, uint64_t duration, uint64_t missing, int sign)
{
    uint32_t correction;

    for (correction = 0; correction < CORRECTIONS_MAX && missing >= HALF_A_WORD; correction++) {
        stretches of = {1, 0, 0};
        uint64_t beyond = duration / 4 + 1, per_jerk;

        while (beyond - of.jerk > 1) {
            const uint64_t middle = of.jerk + (beyond - of.jerk) / 2;

            if (reach(middle, 0, duration - 4 * middle) <= missing)
                of.jerk = middle;
            else
                beyond = middle;
        }
        of.cruise = duration - 4 * of.jerk;
        per_jerk = reach(of.jerk, 0, of.cruise);
        if (missing < per_jerk)
            return;
        add_move(all, &of, sign * (int64_t)(missing / per_jerk));
        missing %= per_jerk;
    }
}

static posicast_result as_entries(const jerk_changes *all, int32_t end, posicast_entry *entries, uint32_t room,
                                  uint32_t *count)
{
    const posicast_motion target = {end, 0, 0};
    int64_t jerk = 0;
    uint32_t place;

    *count = 0;
    for (place = 0; place + 1 < all->count; place++) {
        const uint64_t ticks = all->tick[place + 1] - all->tick[place];

        jerk += all->change[place];
        if (ticks > POSICAST_TICKS_MAX)
            return POSICAST_TOO_LONG;
        if (*count == room)
            return POSICAST_FULL;
        entries[(*count)++] = posicast_segment(jerk, (uint32_t)ticks, 0);
    }
    if (*count == room)
        return POSICAST_FULL;
    entries[(*count)++] = posicast_point(target, 1, POSICAST_ENTRY_NOTIFY);
    return POSICAST_OK;
}

posicast_result posicast_plan_move(int32_t start, int32_t end, const posicast_limits *limits, posicast_entry *entries,
                                   uint32_t room, uint32_t *count)
{
    const int64_t way = (int64_t)end - (int64_t)start;
    const int sign = way < 0 ? -1 : 1;
    uint64_t distance, jerk;
    stretches of;
    jerk_changes all;

    *count = 0;
    if (limits->velocity <= 0 || limits->acceleration <= 0 || limits->jerk <= 0)
        return POSICAST_BAD_ARGUMENT;
    if (way == 0)
        return POSICAST_OK;
    distance = (uint64_t)(way * sign) << (POSICAST_FRACTION_BITS - POSICAST_POSITION_FRACTION);
    /* A tick with jerk also has acceleration and velocity. */
    jerk = least((uint64_t)limits->jerk, least((uint64_t)limits->acceleration, (uint64_t)limits->velocity));
    jerk = least(jerk, ((uint64_t)1 << (POSICAST_ACCELERATION_BITS - 1)) - 1);
    of = fastest((distance + jerk - 1) / jerk, jerk, limits);
    if (of.cruise > POSICAST_TICKS_MAX)
        return POSICAST_TOO_LONG;

    all.count = 0;
    jerk = distance / reach(of.jerk, of.constant, of.cruise);
    add_move(&all, &of, sign * (int64_t)jerk);
    add_corrections(&all, 4 * of.jerk + 2 * of.constant + of.cruise,
                    distance - jerk * reach(of.jerk, of.constant, of.cruise), sign);
    return as_entries(&all, end, entries, room, count);
}
