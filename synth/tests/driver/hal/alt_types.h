/* Of the HAL. */
#ifndef ALT_TYPES_H
#define ALT_TYPES_H
#include <stdint.h>
typedef uint32_t alt_u32;
typedef int32_t alt_32;
#endif
