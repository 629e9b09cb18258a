/*
 * A program that measures an axis without a sensor at its load: it shakes the motor, and traces the drive's command and the
 * motor's encoder in every tick.
 */
#include "measure.h"

int main(void)
{
    /* It traces two signals at every tick. */
    const posicast_trace trace = {2, {TRACED(COMMAND), TRACED(CAPTURED_POSITION), 0, 0}, 0, 0, 0, 0, 0};
    /* The amplitude is 250 counts, with a bit every 1.2 ms. */
    const posicast_excitation shake = {POSICAST_AXIS_EXCITATION_EXCITATION_KIND_PRBS, 250u << 8, 12, 0, 1100};
    posicast_stage stage;

    measure(&stage, &trace, &shake);
    write_rows(&stage, "command", "captured_position");
    return 0;
}
