/*
 * A stage under Linux, from user space, through the kernel's generic UIO driver (uio_pdrv_genirq):
 *
 *   the device tree contains its address: NAME.dtso
 *   modprobe uio_pdrv_genirq of_id=posicast,stage-1.0   (its `compatible`)
 *   posicast_uio_open(&device, "/dev/uio0")
 */
#ifndef POSICAST_UIO_H
#define POSICAST_UIO_H

#include <stdint.h>

#include "posicast_driver.h"

typedef struct {
    posicast_stage stage;
    int file;
    void *memory;
} posicast_uio;

/*
 * Maps the registers and finds the stage. Returns 0, or -1 with errno; ENODEV means that there is no stage that this driver
 * suits: `stage.refused` says what differs.
 */
int posicast_uio_open(posicast_uio *device, const char *path);

void posicast_uio_close(posicast_uio *device);

/*
 * Waits for enabled interrupts for at most this many milliseconds (-1 means for ever), and clears them. Returns 0, or -1 with
 * errno; ETIMEDOUT means that there were none.
 */
int posicast_uio_wait(posicast_uio *device, int milliseconds, uint32_t *interrupts);

#endif
