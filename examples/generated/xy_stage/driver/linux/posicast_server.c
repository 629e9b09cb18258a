/* The functions of posicast_server.h. */
#define _POSIX_C_SOURCE 200809L

#include "posicast_server.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define HEADER_BYTES 8u
/* More than the longest datagram: a longer one is cut off, and its checksum does not hold. */
#define DATAGRAM_BYTES 512u

typedef struct {
    struct sockaddr_storage address;
    socklen_t length;
} peer;

static int64_t now_ms(void)
{
    struct timespec now = {0, 0};

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static uint32_t word_at(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    int place;

    for (place = 0; place < 4; place++, word >>= 8)
        bytes[place] = (uint8_t)word;
}

/* Tokens of a server that ran before must not come again, also on a computer whose clock starts at 0. */
static int draw_token(uint32_t *token)
{
    const int file = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    ssize_t count;

    if (file < 0)
        return -1;
    count = read(file, token, sizeof *token);
    (void)close(file);
    return count == (ssize_t)sizeof *token ? 0 : -1;
}

static int open_socket(const char *address, const char *port)
{
    struct addrinfo wanted, *found;
    int file;

    memset(&wanted, 0, sizeof wanted);
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = SOCK_DGRAM;
    wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
    if (getaddrinfo(address, port, &wanted, &found) != 0) {
        errno = EINVAL;
        return -1;
    }
    file = socket(found->ai_family, found->ai_socktype, found->ai_protocol);
    if (file >= 0 && bind(file, found->ai_addr, found->ai_addrlen) != 0) {
        const int because = errno;

        (void)close(file);
        errno = because;
        file = -1;
    }
    freeaddrinfo(found);
    return file;
}

int posicast_server_open(posicast_server *server, uintptr_t base, uint32_t address_limit, const char *address,
                         const char *port)
{
    memset(server, 0, sizeof *server);
    posicast_frames_begin(&server->frames, base, address_limit);
    server->socket = -1;
    if (draw_token(&server->next_token) != 0)
        return -1;
    server->socket = open_socket(address, port);
    return server->socket < 0 ? -1 : 0;
}

int posicast_server_port(const posicast_server *server)
{
    peer own;

    own.length = sizeof own.address;
    if (getsockname(server->socket, (struct sockaddr *)&own.address, &own.length) != 0)
        return -1;
    return own.address.ss_family == AF_INET6 ? ntohs(((struct sockaddr_in6 *)&own.address)->sin6_port)
                                             : ntohs(((struct sockaddr_in *)&own.address)->sin_port);
}

void posicast_server_close(posicast_server *server)
{
    if (server->socket >= 0)
        (void)close(server->socket);
    server->socket = -1;
}

static void reply(const posicast_server *server, const peer *to, uint32_t token, uint32_t number, size_t frame_bytes)
{
    uint8_t datagram[HEADER_BYTES + sizeof server->frames.reply];

    put_word(datagram, token);
    put_word(datagram + 4, number);
    memcpy(datagram + HEADER_BYTES, server->frames.reply, frame_bytes);
    /* A reply that cannot be sent is a lost one. */
    (void)sendto(server->socket, datagram, HEADER_BYTES + frame_bytes, 0, (const struct sockaddr *)&to->address,
                 to->length);
}

static int is_occupied(const posicast_server *server)
{
    return server->token != 0 && now_ms() - server->heard_ms < POSICAST_SERVER_SILENCE_MS;
}

/* A host asks for a token. The present host stays until the new one uses it: the datagram may be an old one. */
static void offer(posicast_server *server, const peer *to, uint32_t number)
{
    if (is_occupied(server)) {
        reply(server, to, 0, number, 0);
        return;
    }
    if (server->offered == 0 || server->offered_to != number) {
        server->next_token += server->next_token == UINT32_MAX ? 2u : 1u;
        server->offered = server->next_token;
        server->offered_to = number;
    }
    reply(server, to, server->offered, number, 0);
}

static void take(posicast_server *server, const peer *from, const uint8_t *datagram, size_t bytes)
{
    const uint32_t token = word_at(datagram), number = word_at(datagram + 4);
    size_t frame_bytes;

    if (token == 0) {
        offer(server, from, number);
        return;
    }
    if (token == server->offered && !is_occupied(server)) {
        posicast_frames_begin(&server->frames, server->frames.base, server->frames.address_limit);
        server->token = token;
        server->number = 0;
        server->offered = 0;
    }
    if (token != server->token) {
        reply(server, from, 0, number, 0);
        return;
    }
    /* It was overtaken: its host has its reply, or has given up. */
    if ((int32_t)(number - server->number) < 0)
        return;
    server->heard_ms = now_ms();
    if (bytes == HEADER_BYTES) {
        server->token = 0;
        return;
    }
    /* Sequence numbers of frames come again after 255 requests, which may all have been lost. */
    if (number != server->number)
        server->frames.last_sequence = 0;
    frame_bytes = posicast_frames_answer(&server->frames, datagram + HEADER_BYTES, bytes - HEADER_BYTES);
    if (frame_bytes == 0)
        return;
    server->number = number;
    reply(server, from, token, number, frame_bytes);
}

int posicast_server_answer(posicast_server *server, int milliseconds)
{
    uint8_t datagram[DATAGRAM_BYTES];
    struct pollfd waiting;
    peer from;
    ssize_t bytes;

    waiting.fd = server->socket;
    waiting.events = POLLIN;
    waiting.revents = 0;
    if (poll(&waiting, 1, milliseconds) < 0)
        return errno == EINTR ? 0 : -1;
    if (waiting.revents == 0)
        return 0;
    from.length = sizeof from.address;
    bytes = recvfrom(server->socket, datagram, sizeof datagram, 0, (struct sockaddr *)&from.address, &from.length);
    if (bytes < 0)
        return errno == EINTR || errno == EAGAIN || errno == ECONNREFUSED ? 0 : -1;
    if ((size_t)bytes >= HEADER_BYTES)
        take(server, &from, datagram, (size_t)bytes);
    return 0;
}
