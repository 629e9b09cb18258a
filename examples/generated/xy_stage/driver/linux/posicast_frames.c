/* The functions of posicast_frames.h. */
#include "posicast_frames.h"

#include <string.h>

#include "posicast_io.h"

#define WRITES  1u
#define LISTS   2u
#define VERSION (1u << 4)

#define HEADER_BYTES       3u
#define REPLY_HEADER_BYTES 4u
#define CRC_BYTES          4u
#define POLYNOMIAL         0xedb88320u
/* The code that COBS does not use: no frame is so long. */
#define UNUSED_CODE 0xffu

enum { EXECUTED, UNKNOWN_COMMAND, WRONG_LENGTH, WRONG_ADDRESS, WRITE_WITHOUT_SEQUENCE };

static uint32_t crc_of(const uint8_t *bytes, size_t count)
{
    uint32_t crc = 0xffffffffu;
    int bit;

    for (; count > 0; count--) {
        crc ^= *bytes++;
        for (bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ ((crc & 1u) != 0 ? POLYNOMIAL : 0u);
    }
    return ~crc;
}

static uint32_t number(const uint8_t *bytes, uint32_t count)
{
    uint32_t value = 0;

    while (count-- > 0)
        value = value << 8 | bytes[count];
    return value;
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    int place;

    for (place = 0; place < 4; place++, word >>= 8)
        bytes[place] = (uint8_t)word;
}

/* Decodes COBS without its final 0. Returns the number of bytes, or 0 for anything else. `bytes` has room for a byte too many. */
static size_t decode(const uint8_t *frame, size_t count, uint8_t *bytes)
{
    size_t at = 0, length = 0;

    if (memchr(frame, 0, count) != NULL)
        return 0;
    while (at < count) {
        const size_t code = frame[at++];

        if (code == UNUSED_CODE || code - 1 > count - at || length + code > POSICAST_REQUEST_BYTES + 1)
            return 0;
        memcpy(bytes + length, frame + at, code - 1);
        length += code - 1;
        at += code - 1;
        if (at < count)
            bytes[length++] = 0;
    }
    return length;
}

static size_t encode(const uint8_t *bytes, size_t count, uint8_t *frame)
{
    size_t code_at = 0, length = 1, at;

    for (at = 0; at < count; at++) {
        if (bytes[at] == 0) {
            frame[code_at] = (uint8_t)(length - code_at);
            code_at = length;
        }
        frame[length++] = bytes[at];
    }
    frame[code_at] = (uint8_t)(length - code_at);
    frame[length++] = 0;
    return length;
}

/* The address of a word of a request; `word` points to what is written there. */
static uint32_t address_of(const uint8_t *bytes, uint32_t index, const uint8_t **word)
{
    const uint8_t *const first = bytes + HEADER_BYTES;
    const uint32_t entry = (bytes[1] & WRITES) != 0 ? 6u : 2u;

    if ((bytes[1] & LISTS) != 0) {
        *word = first + entry * index + 2;
        return number(first + entry * index, 2);
    }
    *word = first + 2 + 4 * index;
    /* Addresses have 16 bits. */
    return (number(first, 2) + index) & 0xffffu;
}

static uint8_t status_of(const posicast_frames *frames, const uint8_t *bytes, size_t length)
{
    const uint32_t count = bytes[2];
    const int writes = (bytes[1] & WRITES) != 0, lists = (bytes[1] & LISTS) != 0;
    const uint8_t *word;
    uint32_t index;

    if ((bytes[1] & ~(WRITES | LISTS)) != VERSION)
        return UNKNOWN_COMMAND;
    if (count == 0 || count > POSICAST_FRAME_WORDS ||
        length != HEADER_BYTES + CRC_BYTES + 2u * (lists ? count : 1u) + 4u * (writes ? count : 0u))
        return WRONG_LENGTH;
    if (writes && bytes[0] == 0)
        return WRITE_WITHOUT_SEQUENCE;
    for (index = 0; index < count; index++) {
        if (address_of(bytes, index, &word) >= frames->address_limit)
            return WRONG_ADDRESS;
    }
    return EXECUTED;
}

static void execute(posicast_frames *frames, const uint8_t *bytes, size_t length)
{
    uint8_t reply[POSICAST_REPLY_BYTES];
    size_t put = REPLY_HEADER_BYTES;
    const uint8_t *word;
    uint32_t index, address;

    reply[0] = bytes[0];
    reply[1] = status_of(frames, bytes, length);
    reply[3] = frames->dropped;
    for (index = 0; reply[1] == EXECUTED && index < bytes[2]; index++) {
        address = address_of(bytes, index, &word);
        if ((bytes[1] & WRITES) != 0) {
            IOWR(frames->base, address, number(word, 4));
        } else {
            put_word(reply + put, (uint32_t)IORD(frames->base, address));
            put += 4;
        }
    }
    reply[2] = (uint8_t)((put - REPLY_HEADER_BYTES) / 4);
    put_word(reply + put, crc_of(reply, put));
    frames->reply_bytes = encode(reply, put + CRC_BYTES, frames->reply);
}

void posicast_frames_begin(posicast_frames *frames, uintptr_t base, uint32_t address_limit)
{
    memset(frames, 0, sizeof *frames);
    frames->base = base;
    frames->address_limit = address_limit;
}

size_t posicast_frames_answer(posicast_frames *frames, const uint8_t *frame, size_t bytes)
{
    uint8_t decoded[POSICAST_REQUEST_BYTES + 1];
    size_t length;

    while (bytes > 0 && *frame == 0) {
        frame++;
        bytes--;
    }
    if (bytes == 0)
        return 0;
    if (frame[bytes - 1] == 0)
        bytes--;
    length = decode(frame, bytes, decoded);
    if (length < HEADER_BYTES + CRC_BYTES || length > POSICAST_REQUEST_BYTES ||
        crc_of(decoded, length - CRC_BYTES) != number(decoded + length - CRC_BYTES, CRC_BYTES)) {
        frames->dropped++;
        return 0;
    }
    if (decoded[0] == 0 || decoded[0] != frames->last_sequence)
        execute(frames, decoded, length);
    frames->last_sequence = decoded[0];
    return frames->reply_bytes;
}
