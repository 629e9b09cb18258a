/* The arithmetic of posicast_segments.h. */
#include "posicast_segments.h"

/* So many ticks of the largest words are still far from the end of 64 bits. */
#define SHORT_TICKS 256

/* Floor of value / 2^bits; C leaves the shift of a negative number to the compiler. */
static int64_t shifted_down(int64_t value, unsigned bits)
{
    return value >= 0 ? value >> bits : ~(~value >> bits);
}

/* Adds with wrapping, as the hardware does; in C only sums of unsigned numbers wrap. */
static int64_t wrapping_sum(int64_t a, int64_t b)
{
    return (int64_t)((uint64_t)a + (uint64_t)b);
}

static int64_t magnitude(int64_t value)
{
    return value < 0 ? -value : value;
}

static int fits(int64_t value, unsigned bits)
{
    const int64_t half = (int64_t)1 << (bits - 1);

    return value >= -half && value < half;
}

/* Rounds half up to a word with fewer fraction bits; the largest result stays below the end of the word. */
static int32_t half_up(int64_t value, unsigned bits)
{
    const int64_t rounded = shifted_down(value + ((int64_t)1 << (bits - 1)), bits);

    return rounded > INT32_MAX ? INT32_MAX : (int32_t)rounded;
}

static int64_t extended(int32_t word, unsigned fraction)
{
    return (int64_t)word * ((int64_t)1 << (POSICAST_FRACTION_BITS - fraction));
}

/* Returns the jerk of a segment: 40 bits, two's complement. */
static int64_t jerk_of(const posicast_entry *entry)
{
    const int64_t upper = (int64_t)((entry->words[1] & 0xffu) ^ 0x80u) - 0x80;

    return upper * ((int64_t)1 << 32) + (int64_t)entry->words[0];
}

posicast_entry posicast_segment(int64_t jerk, uint32_t ticks, uint32_t flags)
{
    const uint64_t bits = (uint64_t)jerk;
    posicast_entry entry;

    entry.words[0] = (uint32_t)bits;
    entry.words[1] = (uint32_t)(bits >> 32);
    entry.words[2] = 0;
    entry.words[3] = ticks | flags;
    return entry;
}

posicast_entry posicast_point(posicast_motion at, uint32_t ticks, uint32_t flags)
{
    posicast_entry entry;

    entry.words[0] = (uint32_t)at.position;
    entry.words[1] = (uint32_t)at.velocity;
    entry.words[2] = (uint32_t)at.acceleration;
    entry.words[3] = ticks | flags | POSICAST_ENTRY_POINT;
    return entry;
}

posicast_entry posicast_cubic(int32_t velocity, int32_t acceleration, int32_t jerk, uint32_t ticks, uint32_t flags)
{
    posicast_entry entry;

    entry.words[0] = (uint32_t)jerk;
    entry.words[1] = (uint32_t)velocity;
    entry.words[2] = (uint32_t)acceleration;
    entry.words[3] = ticks | flags | POSICAST_ENTRY_CUBIC;
    return entry;
}

uint32_t posicast_entry_ticks(const posicast_entry *entry)
{
    return entry->words[3] & POSICAST_TICKS_MAX;
}

posicast_integrator posicast_resting_at(int32_t position)
{
    posicast_integrator at;

    at.position = extended(position, POSICAST_POSITION_FRACTION);
    at.velocity = 0;
    at.acceleration = 0;
    return at;
}

int posicast_begin(posicast_integrator *at, const posicast_entry *entry)
{
    if (!(entry->words[3] & POSICAST_ENTRY_CUBIC))
        return posicast_integrate(at, entry);
    at->velocity = extended((int32_t)entry->words[1], POSICAST_VELOCITY_FRACTION);
    at->acceleration = extended((int32_t)entry->words[2], POSICAST_ACCELERATION_FRACTION);
    at->position = wrapping_sum(at->position, at->velocity);
    return 1;
}

int posicast_integrate(posicast_integrator *at, const posicast_entry *entry)
{
    const int is_cubic = (entry->words[3] & POSICAST_ENTRY_CUBIC) != 0;
    int64_t sum;

    if (entry->words[3] & POSICAST_ENTRY_POINT) {
        at->position = extended((int32_t)entry->words[0], POSICAST_POSITION_FRACTION);
        at->velocity = extended((int32_t)entry->words[1], POSICAST_VELOCITY_FRACTION);
        at->acceleration = extended((int32_t)entry->words[2], POSICAST_ACCELERATION_FRACTION);
        return 1;
    }
    sum = at->acceleration + (is_cubic ? (int64_t)(int32_t)entry->words[0] : jerk_of(entry));
    if (!fits(sum, POSICAST_ACCELERATION_BITS))
        return 0;
    at->acceleration = sum;
    sum = at->velocity + at->acceleration;
    if (!fits(sum, POSICAST_VELOCITY_BITS))
        return 0;
    at->velocity = sum;
    at->position = wrapping_sum(at->position, at->velocity);
    return 1;
}

/* The closed form of a cubic, where no sum on its way can come near the end of its word: 0 where that is not certain. */
static int jump_over(posicast_integrator *at, const posicast_entry *entry)
{
    const int64_t n = (int64_t)posicast_entry_ticks(entry);
    const int64_t jerk = (int32_t)entry->words[0];
    const int64_t velocity = extended((int32_t)entry->words[1], POSICAST_VELOCITY_FRACTION);
    const int64_t acceleration = extended((int32_t)entry->words[2], POSICAST_ACCELERATION_FRACTION);
    const int64_t pairs = n * (n - 1) / 2;

    if (n > SHORT_TICKS ||
        !fits(magnitude(acceleration) + (n - 1) * magnitude(jerk), POSICAST_ACCELERATION_BITS) ||
        !fits(magnitude(velocity) + (n - 1) * magnitude(acceleration) + pairs * magnitude(jerk), POSICAST_VELOCITY_BITS))
        return 0;
    at->position = wrapping_sum(at->position, n * velocity + pairs * acceleration + pairs * (n + 1) / 3 * jerk);
    at->velocity = velocity + (n - 1) * acceleration + pairs * jerk;
    at->acceleration = acceleration + (n - 1) * jerk;
    return 1;
}

int posicast_play(posicast_integrator *at, const posicast_entry *entry)
{
    uint32_t left = posicast_entry_ticks(entry);
    int all_fit;

    if ((entry->words[3] & POSICAST_ENTRY_CUBIC) && jump_over(at, entry))
        return 1;
    all_fit = posicast_begin(at, entry);
    while (all_fit && --left > 0)
        all_fit = posicast_integrate(at, entry);
    return all_fit;
}

void posicast_extrapolate(posicast_integrator *at)
{
    at->acceleration = 0;
    at->position = wrapping_sum(at->position, at->velocity);
}

void posicast_integrate_stop(posicast_integrator *at, int64_t deceleration)
{
    int64_t change = -at->velocity;

    if (deceleration == 0) {
        at->velocity = 0;
        at->acceleration = 0;
        return;
    }
    if (change > deceleration)
        change = deceleration;
    else if (change < -deceleration)
        change = -deceleration;
    at->acceleration = change;
    at->velocity += change;
    at->position = wrapping_sum(at->position, at->velocity);
}

posicast_motion posicast_rounded(const posicast_integrator *at)
{
    const unsigned bits = POSICAST_FRACTION_BITS - POSICAST_POSITION_FRACTION;
    const uint64_t rounded = (uint64_t)at->position + ((uint64_t)1 << (bits - 1));
    posicast_motion shown;

    shown.position = (int32_t)(uint32_t)(rounded >> bits);
    shown.velocity = half_up(at->velocity, POSICAST_FRACTION_BITS - POSICAST_VELOCITY_FRACTION);
    shown.acceleration = half_up(at->acceleration, POSICAST_FRACTION_BITS - POSICAST_ACCELERATION_FRACTION);
    return shown;
}
