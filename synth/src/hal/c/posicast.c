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
#include "posicast_load.h"
#include "posicast_path.h"
#include "posicast_stream.h"
#include "posicast_wait.h"
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
#include "posicast_capture.h"
#endif

MODULE_AUTHOR("posicast");
MODULE_DESCRIPTION("a posicast stage");
MODULE_LICENSE("Dual MIT/GPL");

static char *stage = "";
RTAPI_MP_STRING(stage, "the stage's registers: uio:/dev/uio0, or unix:PATH of a simulated stage");

/* Points that wait in the FIFO beside the one that plays, when all is well. */
#define AHEAD 2u
/* Servo periods without a point that an axis may go on at its velocity, before it makes a quick stop. */
#define LATE_PERIODS 2u
/* Servo periods until an axis must be on, and ticks until it must be off when the component is unloaded. */
#define ON_PERIODS 5000u
#define OFF_TICKS  20000u
/* A bit of `cause` beyond those of the stage. */
#define CAUSE_LINK 0x80000000u

#define LINK_IS_BROKEN "the link to the stage is broken; its watchdog stops the axes. Load the component anew"

typedef enum { OFF, CLEAR, SWITCH_ON, FOLLOW, FAULT } phase;

typedef struct {
    double origin;      /* counts since reset at which LinuxCNC's position is 0 */
    int32_t shift;      /* counts from the position register to LinuxCNC's position, while that was preset for an index to come */
    uint32_t index_setup;
    int seeks_index;
    int limits_wait;    /* homed, but not yet at rest inside its travel */
    uint32_t shaper;
} axis_state;

static int component;
static posicast_pins *hal;
static posicast_stage hardware;
static posicast_stream stream;
static posicast_path path;
static axis_state axes[POSICAST_AXES_MAX];
static posicast_snapshot now;
static phase at_phase;
static uint32_t causes[POSICAST_AXES_MAX], status[POSICAST_AXES_MAX];
static uint32_t period_ticks, periods_in_phase, tick_before, ahead_ticks, watchdog_ms;
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
/* Whether the line of [capture] is low while the probe touches. */
static int touches_low;
#endif

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

/* LinuxCNC shows errors of this level to the operator. A link that breaks in the middle of a period looks like many another failure. */
static void fail(const char *why)
{
    uint32_t axis;

    if (at_phase != FAULT)
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: %s\n", posicast_link_is_broken() ? LINK_IS_BROKEN : why);
    for (axis = 0; axis < hardware.axes && at_phase != FAULT; axis++) {
        /* An axis may have stopped since posicast.read. */
        if (!posicast_link_is_broken())
            causes[axis] = posicast_causes(&hardware, axis);
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

/*
 * The approach goes past a contact, where the travel may end, and the shaper has it in its memory for a while: the soft limits begin
 * once the axis rests inside its travel.
 */
static void limit_travel(uint32_t axis)
{
    const int32_t *travel = posicast_hal_travel[axis];
    const int32_t command = posicast_command_position(&hardware, axis);
    const int64_t at = command - (int64_t)posicast_origin(&hardware, axis) * 256;

    if (at < travel[0] || at > travel[1] || command != (int32_t)IORD_POSICAST_AXIS_SHAPED_POSITION(0, axis))
        return;
    (void)posicast_limit_travel(&hardware, axis, travel[0], travel[1]);
    axes[axis].limits_wait = 0;
}

#if POSICAST_HOMED_AXES
/* LinuxCNC arms the index by index-enable, and the component takes it back where the position was set to 0 at the index. */
static void follow_index(uint32_t axis)
{
    axis_state *of = &axes[axis];
    hal_bit_t *index_enable = hal->axis[axis].index_enable;

    now.position[axis] += of->shift;
    if (*index_enable && !of->seeks_index) {
        const int32_t before = posicast_origin(&hardware, axis);

        of->index_setup = (uint32_t)IORD_POSICAST_AXIS_INDEX(0, axis);
        /* It acts at once, and again at the index; LinuxCNC sees the second alone. */
        IOWR_POSICAST_AXIS_PRESET(0, axis, 0u);
        IOWR_POSICAST_AXIS_INDEX(0, axis, (of->index_setup & ~POSICAST_AXIS_INDEX_INDEX_ALWAYS_MSK) |
                                              POSICAST_AXIS_INDEX_INDEX_PRESETS_MSK);
        IOWR_POSICAST_AXIS_INDEX_ARM(0, axis, 0u);
        IOWR_POSICAST_AXIS_HOMED(0, axis, 0u);
        of->limits_wait = 0;
        of->shift += posicast_origin(&hardware, axis) - before;
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
        of->shift = 0;
        now.position[axis] = (int32_t)IORD_POSICAST_AXIS_POSITION(0, axis);
        of->limits_wait = posicast_hal_travel[axis][0] < posicast_hal_travel[axis][1];
        *index_enable = 0;
    }
}
#endif

#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
static int captures_falls_alone(void)
{
    const uint32_t falls = POSICAST_STAGE_CAPTURE_CONTROL_CAPTURE_FALLS_MSK, rises = POSICAST_STAGE_CAPTURE_CONTROL_CAPTURE_RISES_MSK;

    return ((uint32_t)IORD_POSICAST_STAGE_CAPTURE_CONTROL(0) & (falls | rises)) == falls;
}

/*
 * The probe touches while its line has the level that an edge of [capture] leads to. A touch that is over within a servo period is shown
 * for one.
 */
static void follow_probe(void)
{
    const uint32_t state_now = (uint32_t)IORD_POSICAST_STAGE_CAPTURE_STATE(0);
    const int is_high = (state_now & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_LEVEL_MSK) != 0;
    int touched = is_high != touches_low && state_now & POSICAST_STAGE_CAPTURE_STATE_CAPTURE_LEVEL_KNOWN_MSK;
    uint32_t left = FIELD(state_now, POSICAST_STAGE_CAPTURE_STATE_CAPTURE_ENTRIES);
    posicast_edge edge;

    for (; left > 0 && posicast_take_edge(&hardware, &edge) == POSICAST_OK; left--) {
        uint32_t axis;

        if (edge.rising == touches_low)
            continue;
        touched = 1;
        *hal->probe_edges += 1;
        for (axis = 0; axis < hardware.axes; axis++)
            *hal->axis[axis].probed = (edge.positions[axis] + axes[axis].shift) / posicast_hal_counts[axis];
    }
    *hal->probe_input = touched;
}
#endif

static void show(uint32_t axis)
{
    posicast_axis_pins *pin = &hal->axis[axis];
    const double counts = posicast_hal_counts[axis];
    const double per_second = POSICAST_HAL_MACHINE.tick_hz / 65536.0 / counts;

    *pin->cause = causes[axis] | (posicast_link_is_broken() ? CAUSE_LINK : 0u);
    *pin->fault = at_phase == FAULT;
    if (posicast_link_is_broken())
        return;
    *pin->pos_fb = now.position[axis] / counts;
    *pin->vel_fb = now.velocity[axis] * per_second;
#if POSICAST_LOOP_AXES
    if (POSICAST_LOOP_AXES >> axis & 1u)
        *pin->following_error = (int32_t)IORD_POSICAST_AXIS_ERROR(0, axis) / 65536.0 / counts;
#endif
#if POSICAST_STEPS_AXES
    if (POSICAST_STEPS_AXES >> axis & 1u)
        *pin->following_error = (int16_t)IORD_POSICAST_AXIS_OWED_STEPS(0, axis) / counts;
#endif
    *pin->home = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_HOME_MSK) != 0;
    *pin->limit_plus = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_LIMIT_PLUS_N_MSK) == 0;
    *pin->limit_minus = (status[axis] & POSICAST_AXIS_STATUS_LEVEL_LIMIT_MINUS_N_MSK) == 0;
}

static void read_stage(void *argument, long period)
{
    uint32_t axis;
    int ok = 1;

    (void)argument;
    (void)period;
    posicast_take_snapshot(&hardware, &now);
    for (axis = 0; axis < hardware.axes; axis++) {
        status[axis] = posicast_status(&hardware, axis);
        causes[axis] = posicast_causes(&hardware, axis);
        ok = ok && status[axis] & POSICAST_AXIS_STATUS_LEVEL_EMERGENCY_STOP_N_MSK;
        if (!posicast_link_is_broken()) {
#if POSICAST_HOMED_AXES
            if (POSICAST_HOMED_AXES >> axis & 1u)
                follow_index(axis);
#endif
            if (axes[axis].limits_wait)
                limit_travel(axis);
        }
    }
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
    if (!posicast_link_is_broken())
        follow_probe();
#endif
    if (posicast_link_is_broken() && at_phase != FAULT)
        fail(LINK_IS_BROKEN);
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
    posicast_link_run((uint32_t)period);
}

/* While the component is loaded: a simulated stage runs on, a real one needs time. */
static void let_time_pass(void *context)
{
    const struct timespec pause = {0, 100000};

    (void)context;
    posicast_link_run(50000);
    (void)nanosleep(&pause, NULL);
}

static int load(void)
{
    posicast_result result;
    uint32_t axis;
    int link = posicast_link_open(stage), status_of;

    if (link != 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: stage=%s: error %d; give stage=uio:/dev/uio0 or stage=unix:PATH\n", stage, -link);
        return link;
    }
    hal = hal_malloc(sizeof *hal);
    if (hal == NULL)
        return -ENOMEM;
    result = posicast_open(&hardware, 0);
    hardware.pause = let_time_pass;
    if (result != POSICAST_OK) {
        posicast_say_refused(&hardware, stage, &POSICAST_HAL_MACHINE);
        return -ENODEV;
    }
    if (!posicast_is_of_machine(&hardware, &POSICAST_HAL_MACHINE)) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: %s is not the stage of %s\n", stage, POSICAST_HAL_MACHINE.name);
        return -ENODEV;
    }
    result = posicast_prepare(&hardware, &POSICAST_HAL_MACHINE);
    if (result != POSICAST_OK) {
        rtapi_print_msg(RTAPI_MSG_ERR, "posicast: the stage cannot be prepared: result %d\n", (int)result);
        return -EIO;
    }
    for (axis = 0; axis < hardware.axes; axis++)
        axes[axis].origin = posicast_origin(&hardware, axis);
    watchdog_ms = hal->watchdog_ms =
        (uint32_t)(1000.0 / POSICAST_HAL_MACHINE.tick_hz *
                   FIELD(IORD_POSICAST_AXIS_WATCHDOG(0, 0), POSICAST_AXIS_WATCHDOG_WATCHDOG_TICKS));
    period_ticks = (uint32_t)(POSICAST_HAL_MACHINE.tick_hz * POSICAST_HAL_SERVO_NS * 1e-9 + 0.5);
#ifdef POSICAST_STAGE_CAPTURE_STATE_REG
    touches_low = captures_falls_alone();
    posicast_capture_begin(&hardware);
#endif
    /* In the servo thread nothing waits for time to pass. */
    hardware.pause = NULL;
    status_of = posicast_make_pins(hal, component, hardware.axes);
    if (status_of == 0)
        status_of = hal_export_funct("posicast.read", read_stage, NULL, 1, 0, component);
    if (status_of == 0)
        status_of = hal_export_funct("posicast.write", write_stage, NULL, 1, 0, component);
    return status_of;
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
        (void)posicast_switch_off(&hardware, posicast_all_axes(&hardware), OFF_TICKS);
    }
    posicast_link_close();
    hal_exit(component);
}
