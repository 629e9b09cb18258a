/*
 * Access to the registers: 32-bit words, by their number.
 *
 *   built with                    IORD and IOWR are
 *   POSICAST_HAL                  those of the HAL's io.h (Nios II, Nios V)
 *   POSICAST_ACCESS_FUNCTIONS     posicast_read and posicast_write, which the program defines
 *   neither                       volatile accesses at base + 4 * word
 *
 * These addresses must not be cached, and every access must have 32 bits: the hardware ignores parts of commands.
 */
#ifndef POSICAST_IO_H
#define POSICAST_IO_H

#include <stdint.h>

#if defined(POSICAST_HAL)

#include <io.h>

#elif defined(POSICAST_ACCESS_FUNCTIONS)

uint32_t posicast_read(uintptr_t base, uint32_t word);
void posicast_write(uintptr_t base, uint32_t word, uint32_t data);

#define IORD(base, word)       posicast_read((uintptr_t)(base), (uint32_t)(word))
#define IOWR(base, word, data) posicast_write((uintptr_t)(base), (uint32_t)(word), (uint32_t)(data))

#else

#define IORD(base, word)       (((volatile const uint32_t *)(base))[word])
#define IOWR(base, word, data) (((volatile uint32_t *)(base))[word] = (uint32_t)(data))

#endif

#endif
