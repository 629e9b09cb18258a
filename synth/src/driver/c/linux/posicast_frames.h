/*
 * The frames of the host link in a program: the request of a host in, its reply out. It answers like the hardware's bridge
 * (docs/uart_bridge.md), with whose model the tests compare it. Written by posicast.
 *
 *   request   sequence | command | count | addresses and words | CRC-32
 *   reply     sequence | status  | count | dropped | words     | CRC-32        both in COBS, and a 0 ends them
 */
#ifndef POSICAST_FRAMES_H
#define POSICAST_FRAMES_H

#include <stddef.h>
#include <stdint.h>

/* Most words of a request; bytes of the longest request and of the longest reply, before COBS. */
#define POSICAST_FRAME_WORDS   @MOST_WORDS@u
#define POSICAST_REQUEST_BYTES @MOST_REQUEST_BYTES@u
#define POSICAST_REPLY_BYTES   @MOST_REPLY_BYTES@u
/* What COBS and the final 0 add to a frame. */
#define POSICAST_FRAME_MORE 2u

typedef struct {
    /* Of IORD and IOWR. */
    uintptr_t base;
    /* A request with a word address of this or above is refused. */
    uint32_t address_limit;
    /* Sequence number of the last request, and its reply as it was sent: for a repetition of the request. */
    uint8_t last_sequence;
    size_t reply_bytes;
    uint8_t reply[POSICAST_REPLY_BYTES + POSICAST_FRAME_MORE];
    /* Frames that were damaged, modulo 256. */
    uint8_t dropped;
} posicast_frames;

/* The state after a reset. */
void posicast_frames_begin(posicast_frames *frames, uintptr_t base, uint32_t address_limit);

/*
 * Takes a frame and executes its request: all of it or nothing, and a repetition not again. Zeros before the frame and the one behind it
 * may be missing. Returns the number of bytes in `reply`, or 0 for a damaged frame, which does nothing.
 */
size_t posicast_frames_answer(posicast_frames *frames, const uint8_t *frame, size_t bytes);

#endif
