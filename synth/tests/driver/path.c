/* The path of LinuxCNC's component with a stage whose clock differs: arguments are the difference in ppm and the number of servo periods. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "posicast_path.h"

#define TICKS 10u
#define AMPLITUDE 1000.0
/* Radians per servo period. */
#define RATE 0.02

static double wanted(double period)
{
    return AMPLITUDE * sin(RATE * period);
}

int main(int count, char **arguments)
{
    const double drift = count == 3 ? 1e-6 * atof(arguments[1]) : 0.0;
    const int periods = count == 3 ? atoi(arguments[2]) : 0;
    const double begin = 0.0;
    posicast_stream_point point;
    posicast_path path;
    double worst = 0.0, worst_velocity = 0.0, played = 0.0, ahead = 0.0;
    double level_low = 0.0, level_high = 0.0;
    int period, points = 0;

    posicast_path_begin(&path, 1, TICKS, &begin);
    for (period = 1; period <= periods; period++) {
        const double command = wanted(period);

        played = period * (double)TICKS * (1.0 + drift);
        ahead = points * (double)TICKS - floor(played) + TICKS;
        posicast_path_command(&path, &command, (int32_t)ahead);
        for (;;) {
            const double due = path.due, step = path.step;

            if (!posicast_path_point(&path, &point))
                break;
            points++;
            /* The first commands come out of a standstill. */
            if (period > 4) {
                worst = fmax(worst, fabs(point.position / 256.0 - wanted(period + due)));
                worst_velocity = fmax(worst_velocity, fabs(point.velocity / 65536.0 -
                                                           AMPLITUDE * RATE * cos(RATE * (period + due)) * step / TICKS));
            }
        }
        if (period > periods / 2) {
            level_low = fmin(level_low, ahead);
            level_high = fmax(level_high, ahead);
        }
    }
    /* In thousandths. */
    printf("= position %ld\n= velocity %ld\n= low %ld\n= high %ld\n", lround(worst * 1e3), lround(worst_velocity * 1e3),
           lround(level_low), lround(level_high));
    return 0;
}
