/* Functions that compilers call even without a library. */
#include <stddef.h>

void *memcpy(void *to, const void *from, size_t bytes);
void *memset(void *to, int value, size_t bytes);

void *memcpy(void *to, const void *from, size_t bytes)
{
    unsigned char *into = to;
    const unsigned char *source = from;

    while (bytes-- > 0)
        *into++ = *source++;
    return to;
}

void *memset(void *to, int value, size_t bytes)
{
    unsigned char *into = to;

    while (bytes-- > 0)
        *into++ = (unsigned char)value;
    return to;
}
