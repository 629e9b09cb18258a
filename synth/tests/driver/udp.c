/* The server for Linux at an address of this computer; its registers are at the other end of the pipe. */
#include "pipe.h"
#include "posicast_server.h"

/* A word that no stage has: not 0 when the test is over. */
#define IS_OVER 0xffffffu

int main(void)
{
    posicast_server server;

    if (posicast_server_open(&server, BASE, POSICAST_STAGE_BYTES / 4u, "127.0.0.1", "0") != 0)
        return 4;
    set_line("port", posicast_server_port(&server));
    while (posicast_read(BASE, IS_OVER) == 0) {
        pause_here(NULL);
        if (posicast_server_answer(&server, 1) != 0)
            return 5;
    }
    posicast_server_close(&server);
    return 0;
}
