/*
 * Motion as in the hardware: entries of the command FIFO, and the integrator that plays them.
 *
 *   a := a + j      Q8.32  counts per tick^2       j: Q8.32 counts per tick^3
 *   v := v + a      Q16.32 counts per tick
 *   p := p + v      Q32.32 counts, modulo 2^64
 *
 * The integers are the same as in the hardware, so the program knows every position to the last bit. No function here accesses a
 * register.
 */
#ifndef POSICAST_SEGMENTS_H
#define POSICAST_SEGMENTS_H

#include <stdint.h>

#include "posicast_stage_regs.h"

/* An entry of the FIFO, as words. */
typedef struct {
    uint32_t words[POSICAST_ENTRY_WORDS];
} posicast_entry;

/* State of a command, in LSB of 2^-32. */
typedef struct {
    int64_t position;
    int64_t velocity;
    int64_t acceleration;
} posicast_integrator;

/* State of a command in the formats of the registers: Q24.8, Q16.16, Q8.24. */
typedef struct {
    int32_t position;
    int32_t velocity;
    int32_t acceleration;
} posicast_motion;

/* Returns an entry with a constant jerk (Q8.32) for 1 to POSICAST_TICKS_MAX ticks. `flags` is 0 or POSICAST_ENTRY_NOTIFY. */
posicast_entry posicast_segment(int64_t jerk, uint32_t ticks, uint32_t flags);

/* Returns an entry that sets a state at once and holds it for this many ticks. `flags` is 0 or POSICAST_ENTRY_NOTIFY. */
posicast_entry posicast_point(posicast_motion at, uint32_t ticks, uint32_t flags);

/*
 * A path of third order from wherever the command then is, for so many ticks: the first one takes velocity (Q16.16) and acceleration (Q8.24) and
 * moves by that velocity, each further one adds the jerk (Q0.32). No such entry makes the position jump.
 */
posicast_entry posicast_cubic(int32_t velocity, int32_t acceleration, int32_t jerk, uint32_t ticks, uint32_t flags);

/* Ticks of an entry. */
uint32_t posicast_entry_ticks(const posicast_entry *entry);

/* Returns the state at rest at this command position in Q24.8 counts. */
posicast_integrator posicast_resting_at(int32_t position);

/* The first tick of an entry, and another one; only of a cubic do they differ. 0 where a sum does not fit its word: there the hardware flags an overflow and stops. */
int posicast_begin(posicast_integrator *at, const posicast_entry *entry);
int posicast_integrate(posicast_integrator *at, const posicast_entry *entry);

/* All ticks of an entry. */
int posicast_play(posicast_integrator *at, const posicast_entry *entry);

/* One tick without an entry: on at the same velocity, as FIFO_CONTROL.extrapolation allows it. */
void posicast_extrapolate(posicast_integrator *at);

/* One tick of a quick stop with this deceleration, Q8.32; 0: at once. */
void posicast_integrate_stop(posicast_integrator *at, int64_t deceleration);

/* Returns the state that the hardware shows: each word is rounded once, half up. */
posicast_motion posicast_rounded(const posicast_integrator *at);

#endif
