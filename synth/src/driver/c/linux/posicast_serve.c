/*
 * posicast_serve DEVICE ADDRESS PORT: serves the stage of a UIO device over UDP (posicast_server.h), for example
 *
 *   posicast_serve /dev/uio0 192.0.2.10 4210        and at the host: posicast host udp://192.0.2.10:4210 status --machine machine.toml
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "posicast_server.h"
#include "posicast_uio.h"

static int fail(const char *what)
{
    (void)fprintf(stderr, "posicast_serve: %s: %s\n", what, strerror(errno));
    return 3;
}

int main(int argc, char **argv)
{
    posicast_uio device;
    posicast_server server;
    int result;

    if (argc != 4) {
        (void)fputs("usage: posicast_serve DEVICE ADDRESS PORT\n"
                    "  DEVICE   the UIO device of the stage, such as /dev/uio0\n"
                    "  ADDRESS  an address of this computer, in numbers; only hosts that reach it can operate the machine\n"
                    "  PORT     a UDP port\n",
                    stderr);
        return 2;
    }
    if (posicast_uio_open(&device, argv[1]) != 0) {
        if (device.stage.refused.name != NULL)
            (void)fprintf(stderr, "posicast_serve: %s of the stage is 0x%08lx, and 0x%08lx in its machine file\n",
                          device.stage.refused.name, (unsigned long)device.stage.refused.found,
                          (unsigned long)device.stage.refused.wanted);
        return fail(argv[1]);
    }
    if (posicast_server_open(&server, (uintptr_t)device.memory, POSICAST_STAGE_BYTES / 4u, argv[2], argv[3]) != 0) {
        result = fail(argv[2]);
        posicast_uio_close(&device);
        return result;
    }
    do
        result = posicast_server_answer(&server, -1);
    while (result == 0);
    result = fail("the network");
    posicast_server_close(&server);
    posicast_uio_close(&device);
    return result;
}
