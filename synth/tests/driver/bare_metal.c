/* The program without an operating system; its accesses go over the pipe, and half a tick passes at each read. */
#define posicast_read read_at_once
#include "pipe.h"
#undef posicast_read

#define STAGE_BASE BASE
#define main bare_metal_main
#include "../bare_metal/main.c"
#undef main

uint32_t posicast_read(uintptr_t base, uint32_t word);
uint32_t posicast_read(uintptr_t base, uint32_t word)
{
    printf("p\n");
    return read_at_once(base, word);
}

int main(void)
{
    posicast_stage stage;

    result("ended", bare_metal_main());
    result("causes_x", first_moves_causes[X]);
    result("causes_y", first_moves_causes[Y]);
    need("open", posicast_open(&stage, BASE), POSICAST_OK);
    result("command_x", posicast_command_position(&stage, X));
    result("command_y", posicast_command_position(&stage, Y));
    return 0;
}
