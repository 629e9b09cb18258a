/* Of the HAL: accesses end in two functions of the test. */
#ifndef IO_H
#define IO_H
#include "alt_types.h"
alt_u32 stub_read(alt_u32 address);
void stub_write(alt_u32 address, alt_u32 data);
#define IORD(base, word)       stub_read((alt_u32)(base) + 4u * (word))
#define IOWR(base, word, data) stub_write((alt_u32)(base) + 4u * (word), (data))
#endif
