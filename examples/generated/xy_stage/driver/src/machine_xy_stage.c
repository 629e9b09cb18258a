/* Tap tables, limits and controllers of xy_stage. Written by posicast. */
#include "machine_xy_stage.h"

static const posicast_tap taps_of_x[] = {
    {0, 25420},
    {38, 11870},
    {39, 18927},
    {77, 7146},
    {78, 2173},
};

static const posicast_tap taps_of_y[] = {
    {0, 25160},
    {54, 23540},
    {55, 7354},
    {108, 4959},
    {109, 4523},
};

static const posicast_axis_machine axes[] = {
    {
        "x",
        1000000.0, /* counts per m */
        /* velocity, acceleration, jerk: counts per tick, tick^2, tick^3, in LSB of 2^-32 */
        {INT64_C(107374182400), INT64_C(343597383), INT64_C(1717986)},
        {taps_of_x, 5, 16},
        {1u, {
            0x7c0000u, /* Surface */
            0x7c0000u, /* Boundary */
            0x7c0000u, /* Damping */
            0x7c0000u, /* Reaching */
            0x7c0000u, /* Switching */
            0x110aabu, /* Fade */
            0x614000u, /* Feedback */
            0x7c0000u, /* Acceleration */
            0x454000u, /* Velocity */
            0x7c0000u, /* Viscous */
            0x7c0000u, /* Coulomb */
            0x1f4000u, /* Limit */
            0x694000u, /* Duty */
            0x7c0000u, /* Derivative */
            0x315555u, /* Proportional */
            0x7c0000u, /* Integral */
        }},
    },
    {
        "y",
        1000000.0, /* counts per m */
        /* velocity, acceleration, jerk: counts per tick, tick^2, tick^3, in LSB of 2^-32 */
        {INT64_C(107374182400), INT64_C(343597383), INT64_C(1717986)},
        {taps_of_y, 5, 16},
        {1u, {
            0x7c0000u, /* Surface */
            0x7c0000u, /* Boundary */
            0x7c0000u, /* Damping */
            0x7c0000u, /* Reaching */
            0x7c0000u, /* Switching */
            0x110aabu, /* Fade */
            0x614000u, /* Feedback */
            0x7c0000u, /* Acceleration */
            0x454000u, /* Velocity */
            0x7c0000u, /* Viscous */
            0x7c0000u, /* Coulomb */
            0x1f4000u, /* Limit */
            0x694000u, /* Duty */
            0x7c0000u, /* Derivative */
            0x315555u, /* Proportional */
            0x7c0000u, /* Integral */
        }},
    },
};

const posicast_machine machine_xy_stage = {
    "xy_stage",
    10000.0, /* ticks per second */
    2, /* axes */
    axes,
};
