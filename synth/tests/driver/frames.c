/* Answers frames of the test, which come and go as words of the pipe. */
#include "pipe.h"
#include "posicast_frames.h"

/* Words beyond the registers: the limit of addresses, bytes of the next frame, bytes of its reply and their end. */
#define LIMIT       0x10000u
#define FRAME_BYTES 0x10001u
#define FRAME       0x20000u
#define REPLY       0x30000u
#define REPLY_END   0x40000u

int main(void)
{
    static uint8_t frame[512];
    posicast_frames frames;
    uint32_t count, at;
    size_t bytes;

    posicast_frames_begin(&frames, BASE, posicast_read(BASE, LIMIT));
    while ((count = posicast_read(BASE, FRAME_BYTES)) <= sizeof frame) {
        for (at = 0; at < count; at++)
            frame[at] = (uint8_t)posicast_read(BASE, FRAME + at);
        bytes = posicast_frames_answer(&frames, frame, count);
        for (at = 0; at < bytes; at++)
            posicast_write(BASE, REPLY + at, frames.reply[at]);
        posicast_write(BASE, REPLY_END, frames.dropped);
    }
    return 0;
}
