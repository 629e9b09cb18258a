/* The functions of posicast_link.h, and the accesses that the driver makes through them (posicast_io.h). */
#include "posicast_link.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "posicast_io.h"
#include "posicast_stage_regs.h"

/* Requests to a simulated stage: two words, of which the first has the kind above the number of a register. */
#define ASK_READ  0x10000000u
#define ASK_WRITE 0x20000000u
#define ASK_RUN   0x30000000u

/* How long a simulated stage may take for an answer: it is busy, or it is gone. */
#define ANSWER_SECONDS 10

/* How often an answer is looked for before the thread sleeps: some hundred microseconds. */
#define AWAKE_LOOKS 200

/* Writes wait here for the next request that has an answer. */
static struct {
    uint32_t words[2 * 256];
    size_t count;
} waiting;

static volatile uint32_t *registers;
static int socket_file = -1;
static int broken;
static uint32_t accesses;

static int is_prefix(const char *prefix, const char *text)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

static int open_uio(const char *path)
{
    const int file = open(path, O_RDWR | O_CLOEXEC);
    void *memory;

    if (file < 0)
        return -errno;
    memory = mmap(NULL, POSICAST_STAGE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (memory == MAP_FAILED)
        return -errno;
    registers = memory;
    return 0;
}

static int open_unix(const char *path)
{
    const struct timeval patience = {ANSWER_SECONDS, 0};
    struct sockaddr_un address = {AF_UNIX, {0}};

    if (strlen(path) >= sizeof address.sun_path)
        return -ENAMETOOLONG;
    strcpy(address.sun_path, path);
    socket_file = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket_file < 0 || connect(socket_file, (struct sockaddr *)&address, sizeof address) != 0 ||
        setsockopt(socket_file, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0)
        return -errno;
    return 0;
}

int posicast_link_open(const char *where)
{
    broken = 0;
    accesses = 0;
    waiting.count = 0;
    if (where != NULL && is_prefix("uio:", where))
        return open_uio(where + 4);
    if (where != NULL && is_prefix("unix:", where))
        return open_unix(where + 5);
    return -EINVAL;
}

void posicast_link_close(void)
{
    if (registers != NULL)
        munmap((void *)registers, POSICAST_STAGE_BYTES);
    if (socket_file >= 0)
        close(socket_file);
    registers = NULL;
    socket_file = -1;
}

int posicast_link_is_broken(void)
{
    return broken;
}

uint32_t posicast_link_accesses(void)
{
    const uint32_t since = accesses;

    accesses = 0;
    return since;
}

static void send_waiting(void)
{
    const char *at = (const char *)waiting.words;
    size_t left = waiting.count * sizeof waiting.words[0];

    waiting.count = 0;
    while (left > 0 && !broken) {
        const ssize_t sent = send(socket_file, at, left, MSG_NOSIGNAL);

        if (sent <= 0) {
            broken = 1;
            return;
        }
        at += sent;
        left -= (size_t)sent;
    }
}

static void ask(uint32_t what, uint32_t data)
{
    if (waiting.count == sizeof waiting.words / sizeof waiting.words[0])
        send_waiting();
    waiting.words[waiting.count++] = what;
    waiting.words[waiting.count++] = data;
}

/* A thread that sleeps is woken later than a stage at rest answers: so it sleeps only where the stage is busy. */
static uint32_t answer(void)
{
    uint32_t word = 0;
    ssize_t received = -1;
    int looks;

    send_waiting();
    for (looks = 0; looks < AWAKE_LOOKS && received < 0 && !broken; looks++)
        received = recv(socket_file, &word, sizeof word, MSG_DONTWAIT);
    if (received < 0 && !broken)
        received = recv(socket_file, &word, sizeof word, MSG_WAITALL);
    if (received != (ssize_t)sizeof word)
        broken = 1;
    return broken ? 0 : word;
}

void posicast_link_run(uint32_t nanoseconds)
{
    if (registers != NULL || broken)
        return;
    ask(ASK_RUN, nanoseconds);
    send_waiting();
}

uint32_t posicast_read(uintptr_t base, uint32_t word)
{
    (void)base;
    accesses++;
    if (registers != NULL)
        return registers[word];
    ask(ASK_READ | word, 0);
    return answer();
}

void posicast_write(uintptr_t base, uint32_t word, uint32_t data)
{
    (void)base;
    accesses++;
    if (registers != NULL)
        registers[word] = data;
    else
        ask(ASK_WRITE | word, data);
}
