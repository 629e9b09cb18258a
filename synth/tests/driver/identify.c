/* A program that measures an axis through its own loop: it excites the motor, traces motor and scale, and writes the log. */
#include "measure.h"

int main(void)
{
    /* It traces two signals at every second tick. */
    const posicast_trace trace = {2, {TRACED(CAPTURED_POSITION), TRACED(DEVIATION), 0, 0}, 1, 0, 0, 0, 0};
    /* The amplitude is 60 counts, with a bit every 1.5 ms. */
    const posicast_excitation shake = {POSICAST_AXIS_EXCITATION_EXCITATION_KIND_PRBS, 60u << 8, 15, 0, 1500};
    posicast_stage stage;

    measure(&stage, &trace, &shake);
    need("its end", posicast_excitation_wait(&stage, X, 5 * TICKS), POSICAST_OK);
    write_rows(&stage, "captured_position", "deviation");
    return 0;
}
