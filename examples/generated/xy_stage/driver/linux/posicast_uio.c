/* The functions of posicast_uio.h. */
#define _POSIX_C_SOURCE 200809L

#include "posicast_uio.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stddef.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define PAUSE_NS 100000L

/* Lets other programs run while the driver polls. */
static void sleep_a_little(void *context)
{
    const struct timespec pause = {0, PAUSE_NS};

    (void)context;
    (void)nanosleep(&pause, NULL);
}

int posicast_uio_open(posicast_uio *device, const char *path)
{
    device->memory = MAP_FAILED;
    device->stage.refused.name = NULL;
    device->file = open(path, O_RDWR | O_CLOEXEC);
    if (device->file < 0)
        return -1;
    /* The first mapping of the device has a whole number of pages. */
    device->memory = mmap(NULL, POSICAST_STAGE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, device->file, 0);
    if (device->memory == MAP_FAILED) {
        posicast_uio_close(device);
        return -1;
    }
    if (posicast_open(&device->stage, (uintptr_t)device->memory) != POSICAST_OK) {
        posicast_uio_close(device);
        errno = ENODEV;
        return -1;
    }
    device->stage.pause = sleep_a_little;
    return 0;
}

void posicast_uio_close(posicast_uio *device)
{
    const int because = errno;

    if (device->memory != MAP_FAILED)
        (void)munmap(device->memory, POSICAST_STAGE_BYTES);
    if (device->file >= 0)
        (void)close(device->file);
    device->memory = MAP_FAILED;
    device->file = -1;
    errno = because;
}

int posicast_uio_wait(posicast_uio *device, int milliseconds, uint32_t *interrupts)
{
    const uint32_t unmask = 1;
    uint32_t count;
    struct pollfd waiting;
    int ready;

    *interrupts = 0;
    waiting.fd = device->file;
    waiting.events = POLLIN;
    waiting.revents = 0;
    /* The kernel masks the line in each interrupt. */
    if (write(device->file, &unmask, sizeof unmask) != (ssize_t)sizeof unmask)
        return -1;
    ready = poll(&waiting, 1, milliseconds);
    if (ready < 0)
        return -1;
    if (ready == 0) {
        errno = ETIMEDOUT;
        return -1;
    }
    if (read(device->file, &count, sizeof count) != (ssize_t)sizeof count)
        return -1;
    *interrupts = posicast_take_interrupts(&device->stage);
    return 0;
}
