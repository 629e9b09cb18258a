/*
 * The way from LinuxCNC to the registers of a stage:
 *
 *   uio:/dev/uio0    the hardware's registers, mapped by the kernel's UIO driver (driver/linux/NAME.dtso)
 *   unix:PATH        a simulated stage behind a Unix socket, which runs for exactly one servo period per period
 *
 * A link that fails stays broken: reads return 0, and writes go nowhere. The stage's watchdog then stops the axes.
 */
#ifndef POSICAST_LINK_H
#define POSICAST_LINK_H

#include <stdint.h>

/* Opens the link. Returns 0, or a negative errno. */
int posicast_link_open(const char *where);

void posicast_link_close(void);

/* Returns whether the link has failed since it was opened. */
int posicast_link_is_broken(void);

/* Returns how many registers were read and written since the last call. */
uint32_t posicast_link_accesses(void);

/* Lets a simulated stage run on for this time, while the caller goes on; real ones do so by themselves. */
void posicast_link_run(uint32_t nanoseconds);

#endif
