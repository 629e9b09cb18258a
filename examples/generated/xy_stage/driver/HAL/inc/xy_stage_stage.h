/* Of alt_sys_init.c: an instance of xy_stage_stage is a posicast_stage_hal under the instance's name. Written by posicast. */
#ifndef XY_STAGE_STAGE_H
#define XY_STAGE_STAGE_H

#include "posicast_stage_hal.h"

#define XY_STAGE_STAGE_INSTANCE(name, device) posicast_stage_hal device
#define XY_STAGE_STAGE_INIT(name, device) \
    posicast_stage_hal_init(&device, name##_BASE, name##_IRQ_INTERRUPT_CONTROLLER_ID, name##_IRQ)

#endif
