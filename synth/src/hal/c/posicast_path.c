/* The functions of posicast_path.h. */
#include "posicast_path.h"

#include <string.h>

/* How fast the measured level counts, per servo period, and how strongly it changes the step, per tick. */
#define FILTER   0.02
#define GAIN     0.0005
/* No crystal is off by more; servo threads that stop are. */
#define STEP_MOST 0.002
/* When a point is due if all is well: half a period before it would have to wait for the next command. */
#define DUE -1.5

static int32_t rounded(double value)
{
    /* Rotary axes turn on: the word wraps as in the hardware. */
    return (int32_t)(uint32_t)(int64_t)(value + (value < 0 ? -0.5 : 0.5));
}

static double clamped(double value, double most)
{
    return value > most ? most : value < -most ? -most : value;
}

void posicast_path_begin(posicast_path *path, uint32_t axes, uint32_t ticks, const double *positions)
{
    uint32_t past;

    path->axes = axes;
    path->ticks = ticks;
    path->step = 1.0;
    path->due = DUE + 1.0;
    path->too_many = 0.0;
    for (past = 0; past < 4; past++)
        memcpy(path->commands[past], positions, axes * sizeof *positions);
}

void posicast_path_command(posicast_path *path, const double *positions, int32_t too_many)
{
    uint32_t axis;

    memmove(path->commands[1], path->commands[0], 3 * sizeof path->commands[0]);
    for (axis = 0; axis < path->axes; axis++) {
        if (positions[axis] - positions[axis] == 0.0)
            path->commands[0][axis] = positions[axis];
    }
    path->due -= 1.0;
    /* Whole points come and go; what is between them is in `due`. */
    path->too_many += FILTER * (too_many - path->ticks * (path->due - DUE) - path->too_many);
    path->step = 1.0 + clamped(GAIN * path->too_many, STEP_MOST);
}

/* Between the commands of two and of one period ago, whose velocities are those of the commands around them. */
int posicast_path_point(posicast_path *path, posicast_stream_point *points)
{
    const double part = path->due + 2.0;
    uint32_t axis;

    if (path->due > -1.0)
        return 0;
    for (axis = 0; axis < path->axes; axis++) {
        const double from = path->commands[2][axis], to = path->commands[1][axis];
        const double v0 = (to - path->commands[3][axis]) / 2.0, v1 = (path->commands[0][axis] - from) / 2.0;
        const double c2 = 3.0 * (to - from) - 2.0 * v0 - v1, c3 = v0 + v1 - 2.0 * (to - from);
        const double velocity = v0 + part * (2.0 * c2 + part * 3.0 * c3);

        points[axis].position = rounded(256.0 * (from + part * (v0 + part * (c2 + part * c3))));
        points[axis].velocity = rounded(65536.0 * velocity * path->step / path->ticks);
    }
    path->due += path->step;
    return 1;
}
