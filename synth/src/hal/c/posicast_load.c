/* The functions of posicast_load.h. */
#include "posicast_load.h"

#include <stddef.h>

/* Ticks of each wait. */
#define LOAD_TICKS 20000u

int posicast_make_pins(posicast_pins *pins, int component, uint32_t axes)
{
    uint32_t axis;
    int status_of = 0;

    for (axis = 0; axis < axes && status_of == 0; axis++) {
        posicast_axis_pins *pin = &pins->axis[axis];
        struct { const char *name; hal_pin_dir_t direction; hal_float_t **at; } floats[] = {
            {"pos-cmd", HAL_IN, &pin->pos_cmd}, {"vel-cmd", HAL_OUT, &pin->vel_cmd}, {"pos-fb", HAL_OUT, &pin->pos_fb},
            {"vel-fb", HAL_OUT, &pin->vel_fb}, {"following-error", HAL_OUT, &pin->following_error},
        };
        struct { const char *name; hal_pin_dir_t direction; hal_bit_t **at; } bits[] = {
            {"enable", HAL_IN, &pin->enable}, {"fault", HAL_OUT, &pin->fault}, {"index-enable", HAL_IO, &pin->index_enable},
            {"home", HAL_OUT, &pin->home}, {"limit-plus", HAL_OUT, &pin->limit_plus}, {"limit-minus", HAL_OUT, &pin->limit_minus},
        };
        size_t one;

        for (one = 0; one < sizeof floats / sizeof floats[0] && status_of == 0; one++)
            status_of = hal_pin_float_newf(floats[one].direction, floats[one].at, component, "posicast.%u.%s", axis, floats[one].name);
        for (one = 0; one < sizeof bits / sizeof bits[0] && status_of == 0; one++)
            status_of = hal_pin_bit_newf(bits[one].direction, bits[one].at, component, "posicast.%u.%s", axis, bits[one].name);
        if (status_of == 0)
            status_of = hal_pin_u32_newf(HAL_OUT, &pin->cause, component, "posicast.%u.cause", axis);
        if (status_of == 0)
            status_of = hal_pin_u32_newf(HAL_IN, &pin->shaper, component, "posicast.%u.unshaped", axis);
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
        if (status_of == 0)
            status_of = hal_pin_float_newf(HAL_OUT, &pin->probed, component, "posicast.%u.probed", axis);
#endif
    }
    if (status_of == 0)
        status_of = hal_pin_bit_newf(HAL_OUT, &pins->ok, component, "posicast.ok");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &pins->phase, component, "posicast.phase");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &pins->level, component, "posicast.level");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &pins->late_ticks, component, "posicast.late-ticks");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &pins->accesses, component, "posicast.accesses");
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
    if (status_of == 0)
        status_of = hal_pin_bit_newf(HAL_OUT, &pins->probe_input, component, "posicast.probe-input");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &pins->probe_edges, component, "posicast.probe-edges");
#endif
    if (status_of == 0)
        status_of = hal_param_u32_newf(HAL_RW, &pins->watchdog_ms, component, "posicast.watchdog-ms");
    return status_of;
}

void posicast_say_refused(const posicast_stage *stage, const char *where, const posicast_machine *machine)
{
    const posicast_refused *of = &stage->refused;

    rtapi_print_msg(RTAPI_MSG_ERR,
                    "posicast: %s: %s of the stage is 0x%08x, and 0x%08x by the machine file of %s: build the FPGA and this component "
                    "from one machine file\n",
                    where, of->name, of->found, of->wanted, machine->name);
}

int posicast_is_of_machine(const posicast_stage *stage, const posicast_machine *machine)
{
    static posicast_tap taps[256];
    uint32_t axis, tap, count = 0;

    for (axis = 0; axis < machine->axes; axis++) {
        const posicast_table *table = &machine->axis[axis].table;
        int same = posicast_read_table(stage, axis, SHAPED, taps, 256, &count, LOAD_TICKS) == POSICAST_OK &&
                   count == table->count;

        for (tap = 0; same && tap < count; tap++)
            same = taps[tap].delay_samples == table->taps[tap].delay_samples &&
                   taps[tap].coefficient == table->taps[tap].coefficient;
        if (!same) {
            rtapi_print_msg(RTAPI_MSG_ERR,
                            "posicast: axis %s: the stage has a table of %u taps, not that of %s (%u taps): build the FPGA "
                            "and this component from one machine file\n",
                            machine->axis[axis].name, count, machine->name, table->count);
            return 0;
        }
    }
    return 1;
}

posicast_result posicast_prepare(const posicast_stage *stage, const posicast_machine *machine)
{
    posicast_result result = posicast_switch_off(stage, posicast_all_axes(stage), LOAD_TICKS);
    uint32_t axis;

    if (result == POSICAST_FAULT)
        result = POSICAST_OK;
    for (axis = 0; axis < stage->axes && result == POSICAST_OK; axis++) {
        const uint32_t fraction = machine->axis[axis].table.coefficient_fraction;
        const posicast_tap unity = {0, (int32_t)1 << fraction};
        const posicast_table unshaped = {&unity, 1, fraction};

        result = posicast_use_table(stage, axis, SHAPED, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
        if (result == POSICAST_OK)
            result = posicast_load_table(stage, axis, UNSHAPED, &unshaped, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
        if (result == POSICAST_OK)
            result = posicast_use_table(stage, axis, SHAPED, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
    }
    return result;
}
