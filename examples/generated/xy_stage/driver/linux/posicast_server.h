/*
 * Serves a stage's registers to a host over UDP: the frames of the host link (docs/uart_bridge.md), one in each datagram.
 *
 *   token, 4 bytes | number, 4 bytes | frame         little-endian, in both directions
 *
 *   host                                     server
 *   0 | n |            may I?                T | n |            yes: T is your token
 *                                            0 | n |            no: another host is here
 *   T | 1, 2, .. | request                   T | same | reply   a repetition has the same number
 *   T | k |            I leave               0 | k |            T is no token, or no longer
 *
 * The network may lose, double, delay and swap datagrams. A request is executed once, and never after a later one: what has a smaller number
 * than the last request is ignored, and the last request only gets its reply again. A token is used once; that of a host that left, or of
 * a server that was started before, does nothing.
 *
 * One host at a time. Another one may come when the first has left or is silent for POSICAST_SERVER_SILENCE_MS. There is no password and no
 * encryption: whoever reaches the address can move the machine.
 */
#ifndef POSICAST_SERVER_H
#define POSICAST_SERVER_H

#include <stdint.h>

#include "posicast_frames.h"

/* Time after which the present host counts as dead. */
#define POSICAST_SERVER_SILENCE_MS 2000

typedef struct {
    posicast_frames frames;
    int socket;
    /* Of the present host; 0: none. */
    uint32_t token;
    /* Number of its last request, and when it was heard. */
    uint32_t number;
    int64_t heard_ms;
    /* A token for the host that asked with this number. It becomes the present host by its first request. */
    uint32_t offered, offered_to;
    uint32_t next_token;
} posicast_server;

/*
 * Serves the registers at `base`, word addresses below `address_limit`, at a numeric address of this computer and a port. Port "0" lets the
 * system choose. Returns 0, or -1 with errno.
 */
int posicast_server_open(posicast_server *server, uintptr_t base, uint32_t address_limit, const char *address,
                         const char *port);

/* Returns the port, or -1 with errno. */
int posicast_server_port(const posicast_server *server);

/* Waits for a datagram for at most this many milliseconds (-1 means for ever) and answers it. Returns 0, or -1 with errno. */
int posicast_server_answer(posicast_server *server, int milliseconds);

void posicast_server_close(posicast_server *server);

#endif
