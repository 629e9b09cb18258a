/* Data of xy_stage from its machine file. Written by posicast. */
#ifndef MACHINE_XY_STAGE_H
#define MACHINE_XY_STAGE_H

#include "posicast_machine.h"

/* Axes, as the driver counts them. */
#define MACHINE_XY_STAGE_AXIS_X 0u
#define MACHINE_XY_STAGE_AXIS_Y 1u

extern const posicast_machine machine_xy_stage;

#endif
