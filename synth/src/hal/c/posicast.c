/*
 * A posicast stage in LinuxCNC: loadrt posicast stage=uio:/dev/uio0
 *
 *   posicast.read ─► motion-controller ─► posicast.write        in the servo thread, in this order
 *
 * The axes go on and off together, as LinuxCNC's machine does. No function waits: switching on takes as many servo periods as it takes.
 *
 *   OFF ─► CLEAR ─► SWITCH_ON ─► FOLLOW        FAULT, from each of them, until `enable` is low
 *          faults    brakes       one point per axis and servo period
 *
 * docs/linuxcnc.md has the pins.
 */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

#include <errno.h>
#include <stddef.h>
#include <time.h>

#include "posicast_driver.h"
#include "posicast_hal_machine.h"
#include "posicast_homing.h"
#include "posicast_link.h"
#include "posicast_path.h"
#include "posicast_stream.h"
#include "posicast_wait.h"

MODULE_AUTHOR("posicast");
MODULE_DESCRIPTION("a posicast stage");
MODULE_LICENSE("Dual MIT/GPL");

static char *stage = "";
RTAPI_MP_STRING(stage, "the stage's registers: uio:/dev/uio0, or unix:PATH of a simulated stage");

/* Points that wait in the FIFO beside the one that plays, when all is well. */
#define AHEAD 2u
/* Servo periods without a point that an axis may go on at its velocity, before it makes a quick stop. */
#define LATE_PERIODS 2u
/* Bank of the table that does not shape, and of the machine's own. */
#define UNSHAPED 1u
#define SHAPED 0u
/* Waits while the component is loaded, and servo periods until an axis must be on. */
#define LOAD_TICKS 20000u
#define ON_PERIODS 5000u
/* A bit of `cause` beyond those of the stage. */
#define CAUSE_LINK 0x80000000u

typedef enum { OFF, CLEAR, SWITCH_ON, FOLLOW, FAULT } phase;

typedef struct {
    hal_float_t *pos_cmd, *vel_cmd, *pos_fb, *vel_fb, *following_error;
    hal_bit_t *enable, *fault, *index_enable, *home, *limit_plus, *limit_minus;
    hal_u32_t *cause, *shaper;
} axis_pins;

typedef struct {
    axis_pins axis[POSICAST_AXES_MAX];
    hal_bit_t *ok;
    hal_u32_t *phase, *level, *late_ticks, *accesses;
    hal_u32_t watchdog_ms;
} pins;

typedef struct {
    double origin;      /* counts since reset at which LinuxCNC's position is 0 */
    uint32_t index_setup;
    int seeks_index;
    uint32_t shaper;
} axis_state;

static int component;
static pins *hal;
static posicast_stage hardware;
static posicast_stream stream;
static posicast_path path;
static axis_state axes[POSICAST_AXES_MAX];
static posicast_snapshot now;
static phase at_phase;
static uint32_t causes[POSICAST_AXES_MAX], status[POSICAST_AXES_MAX];
static uint32_t period_ticks, periods_in_phase, tick_before, ahead_ticks, watchdog_ms;

static void enter(phase next)
{
    at_phase = next;
    periods_in_phase = 0;
}

static uint32_t state(uint32_t axis)
{
    return state_of(status[axis]);
}

static void set_enable(int on)
{
    uint32_t axis;

    for (axis = 0; axis < hardware.axes; axis++) {
        const uint32_t word = (uint32_t)IORD_POSICAST_AXIS_CONTROL(0, axis);

        IOWR_POSICAST_AXIS_CONTROL(0, axis, on ? word | POSICAST_AXIS_CONTROL_ENABLE_MSK
                                               : word & ~POSICAST_AXIS_CONTROL_ENABLE_MSK);
    }
}

/* LinuxCNC shows errors of this level to the operator. */
static void fail(const char *why)
{
    uint32_t axis;

    if (at_phase != FAULT)
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: %s\n", why);
    for (axis = 0; axis < hardware.axes && at_phase != FAULT; axis++) {
        if (causes[axis] != 0)
            rtapi_print_msg(RTAPI_MSG_ERR, "posicast: axis %s: %s\n", POSICAST_HAL_MACHINE.axis[axis].name,
                            posicast_cause_name(causes[axis]));
    }
    enter(FAULT);
}

static int every_axis(uint32_t wanted_state, uint32_t mask)
{
    uint32_t axis;

    for (axis = 0; axis < hardware.axes; axis++) {
        if (state(axis) != wanted_state || (status[axis] & mask) != mask)
            return 0;
    }
    return 1;
}

/* LinuxCNC arms the index by index-enable, and the component takes it back where the position was set to 0 at the index. */
static void follow_index(uint32_t axis)
{
    axis_state *of = &axes[axis];
    hal_bit_t *index_enable = hal->axis[axis].index_enable;

    if (*index_enable && !of->seeks_index) {
        of->index_setup = (uint32_t)IORD_POSICAST_AXIS_INDEX(0, axis);
        IOWR_POSICAST_AXIS_PRESET(0, axis, 0u);
        IOWR_POSICAST_AXIS_INDEX(0, axis, (of->index_setup & ~POSICAST_AXIS_INDEX_INDEX_ALWAYS_MSK) |
                                              POSICAST_AXIS_INDEX_INDEX_PRESETS_MSK);
        IOWR_POSICAST_AXIS_INDEX_ARM(0, axis, 0u);
        of->seeks_index = 1;
        return;
    }
    if (!of->seeks_index || (*index_enable && status[axis] & POSICAST_AXIS_STATUS_INDEX_ARMED_MSK))
        return;
    /* Found, or given up: a later index must not move the origin. */
    IOWR_POSICAST_AXIS_INDEX(0, axis, of->index_setup);
    of->seeks_index = 0;
    if (*index_enable) {
        of->origin = posicast_origin(&hardware, axis);
        now.position[axis] = (int32_t)IORD_POSICAST_AXIS_POSITION(0, axis);
        if (posicast_hal_travel[axis][0] < posicast_hal_travel[axis][1])
            (void)posicast_limit_travel(&hardware, axis, posicast_hal_travel[axis][0], posicast_hal_travel[axis][1]);
        *index_enable = 0;
    }
}

static void show(uint32_t axis)
{
    axis_pins *pin = &hal->axis[axis];
    const double counts = posicast_hal_counts[axis];
    const double per_second = POSICAST_HAL_MACHINE.tick_hz / 65536.0 / counts;

    *pin->cause = causes[axis] | (posicast_link_is_broken() ? CAUSE_LINK : 0u);
    *pin->fault = at_phase == FAULT;
    if (posicast_link_is_broken())
        return;
    *pin->pos_fb = now.position[axis] / counts;
    *pin->vel_fb = now.velocity[axis] * per_second;
    *pin->following_error = (int32_t)IORD_POSICAST_AXIS_ERROR(0, axis) / 65536.0 / counts;
    *pin->home = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_HOME_MSK) != 0;
    *pin->limit_plus = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_LIMIT_PLUS_N_MSK) == 0;
    *pin->limit_minus = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_LIMIT_MINUS_N_MSK) == 0;
}

static void read_stage(void *argument, long period)
{
    uint32_t axis;
    int ok = 1;

    (void)argument;
    posicast_link_run((uint32_t)period);
    posicast_take_snapshot(&hardware, &now);
    for (axis = 0; axis < hardware.axes; axis++) {
        status[axis] = posicast_status(&hardware, axis);
        causes[axis] = posicast_causes(&hardware, axis);
        ok = ok && status[axis] & POSICAST_AXIS_STATUS_LEVEL_EMERGENCY_STOP_N_MSK;
        if (!posicast_link_is_broken())
            follow_index(axis);
    }
    if (posicast_link_is_broken() && at_phase != FAULT)
        fail("the link to the stage is broken; its watchdog stops the axes. Load the component anew");
    for (axis = 0; axis < hardware.axes; axis++)
        show(axis);
    *hal->ok = ok && !posicast_link_is_broken();
}

/* Points of rest fill the FIFO; the stream starts with the next point. */
static void begin(void)
{
    double positions[POSICAST_AXES_MAX];
    posicast_stream_point points[POSICAST_AXES_MAX];
    uint32_t axis, ahead;
    posicast_result result = posicast_stream_open(&stream, &hardware, posicast_all_axes(&hardware), POSICAST_STREAM_CUBIC,
                                                  LATE_PERIODS * period_ticks);

    for (axis = 0; axis < hardware.axes; axis++) {
        points[axis].position = posicast_command_position(&hardware, axis);
        points[axis].velocity = 0;
        positions[axis] = points[axis].position / 256.0;
    }
    for (ahead = 0; ahead < AHEAD && result == POSICAST_OK; ahead++)
        result = posicast_stream_write(&stream, points, period_ticks);
    if (result != POSICAST_OK) {
        fail("the axes do not take a path");
        return;
    }
    stream.started = 1;
    posicast_path_begin(&path, hardware.axes, period_ticks, positions);
    ahead_ticks = 0;
    tick_before = now.tick_count;
    enter(FOLLOW);
}

static void follow(void)
{
    static posicast_stream_point points[POSICAST_AXES_MAX];
    double positions[POSICAST_AXES_MAX];
    posicast_result result = POSICAST_OK;
    uint32_t axis;

    for (axis = 0; axis < hardware.axes; axis++)
        positions[axis] = *hal->axis[axis].pos_cmd * posicast_hal_counts[axis] + axes[axis].origin;
    ahead_ticks -= now.tick_count - tick_before;
    tick_before = now.tick_count;
    /* The entry of this period is not written yet. */
    posicast_path_command(&path, positions, (int32_t)(ahead_ticks + period_ticks + stream.axis[0].late_ticks));
    while (result == POSICAST_OK && posicast_path_point(&path, points)) {
        result = posicast_stream_write(&stream, points, period_ticks);
        ahead_ticks += period_ticks;
    }
    for (axis = 0; axis < hardware.axes; axis++)
        *hal->axis[axis].vel_cmd =
            points[axis].velocity * (POSICAST_HAL_MACHINE.tick_hz / 65536.0) / posicast_hal_counts[axis];
    *hal->level = stream.axis[0].level;
    *hal->late_ticks = stream.axis[0].late_ticks;
    if (result == POSICAST_BAD_ARGUMENT)
        fail("the path is faster than the words of an entry, or leaves them");
    else if (result == POSICAST_FULL)
        fail("the FIFO is full: the servo thread runs faster than SERVO_PERIOD");
    else if (result != POSICAST_OK)
        fail("an axis has stopped");
}

/* Another table, by a handover: no jump, also while the axis moves. A swap that waits is asked for again later. */
static void follow_shaper(uint32_t axis)
{
    const uint32_t wanted = *hal->axis[axis].shaper ? UNSHAPED : SHAPED;

    if (wanted == axes[axis].shaper || status[axis] & POSICAST_AXIS_STATUS_SWAP_PENDING_MSK)
        return;
    IOWR_POSICAST_AXIS_SWAP(0, axis, AS_FIELD(wanted, POSICAST_AXIS_SWAP_SWAP_BANK) |
                                         AS_FIELD(POSICAST_AXIS_SWAP_SWAP_HOW_HANDOVER, POSICAST_AXIS_SWAP_SWAP_HOW));
    axes[axis].shaper = wanted;
}

static void follow_watchdog(void)
{
    const double ticks = hal->watchdog_ms * POSICAST_HAL_MACHINE.tick_hz / 1000.0;
    uint32_t axis;

    if (hal->watchdog_ms == watchdog_ms)
        return;
    watchdog_ms = hal->watchdog_ms;
    for (axis = 0; axis < hardware.axes; axis++) {
        const uint32_t word = (uint32_t)IORD_POSICAST_AXIS_WATCHDOG(0, axis);

        IOWR_POSICAST_AXIS_WATCHDOG(0, axis, (word & ~POSICAST_AXIS_WATCHDOG_WATCHDOG_TICKS_MSK) |
                                                 AS_FIELD(ticks > 65535.0 ? 65535u : (uint32_t)ticks,
                                                          POSICAST_AXIS_WATCHDOG_WATCHDOG_TICKS));
    }
}

static void write_stage(void *argument, long period)
{
    uint32_t axis, any_cause = 0;
    int on = 1;

    (void)argument;
    (void)period;
    for (axis = 0; axis < hardware.axes; axis++) {
        on = on && *hal->axis[axis].enable;
        any_cause |= causes[axis];
    }
    periods_in_phase++;
    /* A broken link stays a fault. */
    if (!on && at_phase != OFF && !posicast_link_is_broken()) {
        set_enable(0);
        enter(OFF);
    }
    switch (at_phase) {
    case OFF:
        if (on) {
            set_enable(0);
            enter(CLEAR);
        }
        break;
    case CLEAR:
        if (every_axis(POSICAST_AXIS_STATUS_STATE_READY, 0)) {
            set_enable(1);
            enter(SWITCH_ON);
            break;
        }
        for (axis = 0; axis < hardware.axes; axis++)
            IOWR_POSICAST_AXIS_CLEAR_FAULTS(0, axis, 0u);
        if (periods_in_phase > ON_PERIODS)
            fail("the axes do not get ready");
        break;
    case SWITCH_ON:
        if (every_axis(POSICAST_AXIS_STATUS_STATE_HOLD, POSICAST_AXIS_STATUS_CAN_START_MSK))
            begin();
        else if (any_cause || periods_in_phase > ON_PERIODS)
            fail("the axes cannot be switched on");
        break;
    case FOLLOW:
        if (any_cause)
            fail("fault");
        else
            follow();
        break;
    case FAULT:
        break;
    }
    for (axis = 0; axis < hardware.axes; axis++) {
        follow_shaper(axis);
        *hal->axis[axis].fault = at_phase == FAULT;
        if (at_phase != FOLLOW)
            *hal->axis[axis].vel_cmd = 0.0;
    }
    follow_watchdog();
    posicast_kick(&hardware);
    *hal->phase = at_phase;
    *hal->accesses = posicast_link_accesses();
}

/* While the component is loaded: a simulated stage runs on, a real one needs time. */
static void let_time_pass(void *context)
{
    const struct timespec pause = {0, 100000};

    (void)context;
    posicast_link_run(50000);
    (void)nanosleep(&pause, NULL);
}

/* The stage is that of the machine file if its tables are. */
static int is_of_machine(void)
{
    static posicast_tap taps[256];
    const posicast_machine *machine = &POSICAST_HAL_MACHINE;
    uint32_t axis, tap, count;

    if (hardware.axes != machine->axes) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: the stage has %u axes, %s of the machine file %u\n", hardware.axes,
                        machine->name, machine->axes);
        return 0;
    }
    for (axis = 0; axis < machine->axes; axis++) {
        const posicast_table *table = &machine->axis[axis].table;
        int same = posicast_read_table(&hardware, axis, SHAPED, taps, 256, &count, LOAD_TICKS) == POSICAST_OK &&
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

/* Switches the axes off, where another program left them on, and loads the table that does not shape. */
static posicast_result prepare(void)
{
    posicast_result result = posicast_switch_off(&hardware, posicast_all_axes(&hardware), LOAD_TICKS);
    uint32_t axis;

    if (result == POSICAST_FAULT)
        result = POSICAST_OK;
    for (axis = 0; axis < hardware.axes && result == POSICAST_OK; axis++) {
        const uint32_t fraction = POSICAST_HAL_MACHINE.axis[axis].table.coefficient_fraction;
        const posicast_tap unity = {0, (int32_t)1 << fraction};
        const posicast_table unshaped = {&unity, 1, fraction};

        result = posicast_use_table(&hardware, axis, SHAPED, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
        if (result == POSICAST_OK)
            result = posicast_load_table(&hardware, axis, UNSHAPED, &unshaped, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
        if (result == POSICAST_OK)
            result = posicast_use_table(&hardware, axis, SHAPED, POSICAST_AXIS_SWAP_SWAP_HOW_AT_ONCE, LOAD_TICKS);
        axes[axis].origin = posicast_origin(&hardware, axis);
    }
    watchdog_ms = hal->watchdog_ms = (uint32_t)(1000.0 / POSICAST_HAL_MACHINE.tick_hz *
        FIELD(IORD_POSICAST_AXIS_WATCHDOG(0, 0), POSICAST_AXIS_WATCHDOG_WATCHDOG_TICKS));
    return result;
}

static int make_pins(void)
{
    uint32_t axis;
    int status_of = 0;

    for (axis = 0; axis < hardware.axes && status_of == 0; axis++) {
        axis_pins *pin = &hal->axis[axis];
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
    }
    if (status_of == 0)
        status_of = hal_pin_bit_newf(HAL_OUT, &hal->ok, component, "posicast.ok");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &hal->phase, component, "posicast.phase");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &hal->level, component, "posicast.level");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &hal->late_ticks, component, "posicast.late-ticks");
    if (status_of == 0)
        status_of = hal_pin_u32_newf(HAL_OUT, &hal->accesses, component, "posicast.accesses");
    if (status_of == 0)
        status_of = hal_param_u32_newf(HAL_RW, &hal->watchdog_ms, component, "posicast.watchdog-ms");
    if (status_of == 0)
        status_of = hal_export_funct("posicast.read", read_stage, NULL, 1, 0, component);
    if (status_of == 0)
        status_of = hal_export_funct("posicast.write", write_stage, NULL, 1, 0, component);
    return status_of;
}

static int load(void)
{
    posicast_result result;
    int link = posicast_link_open(stage);

    if (link != 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: stage=%s: error %d; give stage=uio:/dev/uio0 or stage=unix:PATH\n", stage, -link);
        return link;
    }
    hal = hal_malloc(sizeof *hal);
    if (hal == NULL)
        return -ENOMEM;
    result = posicast_open(&hardware, 0);
    hardware.pause = let_time_pass;
    if (result != POSICAST_OK || !is_of_machine()) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: %s is not the stage of %s\n", stage, POSICAST_HAL_MACHINE.name);
        return -ENODEV;
    }
    result = prepare();
    if (result != POSICAST_OK) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: the stage cannot be prepared: result %d\n", (int)result);
        return -EIO;
    }
    period_ticks = (uint32_t)(POSICAST_HAL_MACHINE.tick_hz * POSICAST_HAL_SERVO_NS * 1e-9 + 0.5);
    /* In the servo thread nothing waits for time to pass. */
    hardware.pause = NULL;
    return make_pins();
}

int rtapi_app_main(void)
{
    int result;

    component = hal_init("posicast");
    if (component < 0)
        return component;
    result = load();
    if (result == 0)
        result = hal_ready(component);
    if (result != 0) {
        posicast_link_close();
        hal_exit(component);
    }
    return result;
}

/* LinuxCNC has stopped the threads: the axes stop and go off. */
void rtapi_app_exit(void)
{
    if (!posicast_link_is_broken()) {
        hardware.pause = let_time_pass;
        (void)posicast_switch_off(&hardware, posicast_all_axes(&hardware), LOAD_TICKS);
    }
    posicast_link_close();
    hal_exit(component);
}
