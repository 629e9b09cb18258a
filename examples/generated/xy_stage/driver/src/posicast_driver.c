/* The functions of posicast_driver.h. */
#include "posicast_driver.h"

#include <stddef.h>

#include "posicast_wait.h"

/* Number of ticks until a start has led to RUN or been refused. */
#define START_TICKS 4u
/* Number of ticks until the PWM has run for a whole period with a new duty. */
#define SELF_TEST_TICKS 4u

/* Only an axis with a controller has direct mode. */
#if POSICAST_LOOP_AXES
#define DIRECT_ENABLE POSICAST_AXIS_CONTROL_DIRECT_ENABLE_MSK
#else
#define DIRECT_ENABLE 0u
#endif

static void clear_faults(const posicast_stage *stage, uint32_t axis)
{
    IOWR_POSICAST_AXIS_CLEAR_FAULTS(stage->base, axis, 0);
}

/* Until an axis is READY. It forgets only what is over, and only with its outputs off: so it is told again and again. */
static posicast_result wait_ready(const posicast_stage *stage, uint32_t axis, posicast_patience *left)
{
    while (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_READY) {
        const uint32_t causes = posicast_causes(stage, axis);
        posicast_result result;

        if (causes != 0)
            clear_faults(stage, axis);
        result = posicast_pass_time(stage, left);
        if (result != POSICAST_OK)
            return result == POSICAST_TIMEOUT && causes != 0 ? POSICAST_FAULT : result;
    }
    return POSICAST_OK;
}

/* Waits until an axis that was switched on can start. An axis in HOLD may still have the group stop of another: it is cleared. */
static posicast_result wait_holding(const posicast_stage *stage, uint32_t axis, posicast_patience *left)
{
    for (;;) {
        const uint32_t word = posicast_status(stage, axis);
        posicast_result result;

        if (state_of(word) == POSICAST_AXIS_STATUS_STATE_FAULT)
            return POSICAST_FAULT;
        if (state_of(word) == POSICAST_AXIS_STATUS_STATE_HOLD) {
            if (FIELD(word, POSICAST_AXIS_STATUS_CAN_START))
                return POSICAST_OK;
            if (posicast_causes(stage, axis) != 0)
                clear_faults(stage, axis);
        }
        result = posicast_pass_time(stage, left);
        if (result != POSICAST_OK)
            return result;
    }
}

static void set_control(const posicast_stage *stage, uint32_t axis, uint32_t clear, uint32_t set)
{
    const uint32_t word = (uint32_t)IORD_POSICAST_AXIS_CONTROL(stage->base, axis);

    IOWR_POSICAST_AXIS_CONTROL(stage->base, axis, (word & ~clear) | set);
}

static posicast_result refuse(posicast_stage *stage, posicast_result why, const char *name, uint32_t found, uint32_t wanted)
{
    stage->refused.name = name;
    stage->refused.found = found;
    stage->refused.wanted = wanted;
    return why;
}

posicast_result posicast_open(posicast_stage *stage, uintptr_t base)
{
    uint32_t found;

    stage->base = base;
    stage->axes = 0;
    stage->tick_clocks = 0;
    stage->pause = NULL;
    stage->context = NULL;
    (void)refuse(stage, POSICAST_OK, NULL, 0, 0);
    found = (uint32_t)IORD_POSICAST_STAGE_MAGIC(base);
    if (found != POSICAST_STAGE_MAGIC_RESET)
        return refuse(stage, POSICAST_NOT_FOUND, "MAGIC", found, POSICAST_STAGE_MAGIC_RESET);
    found = (uint32_t)IORD_POSICAST_STAGE_VERSION(base);
    /* A larger minor version has registers that this driver does not use. */
    if (found < POSICAST_STAGE_VERSION_RESET || FIELD(found, POSICAST_STAGE_VERSION_MAJOR) !=
                                                    FIELD(POSICAST_STAGE_VERSION_RESET, POSICAST_STAGE_VERSION_MAJOR))
        return refuse(stage, POSICAST_VERSION, "VERSION", found, POSICAST_STAGE_VERSION_RESET);
#ifdef POSICAST_STAGE_MACHINE_CRC_RESET
    found = (uint32_t)IORD_POSICAST_STAGE_MACHINE_CRC(base);
    if (found != POSICAST_STAGE_MACHINE_CRC_RESET)
        return refuse(stage, POSICAST_OTHER_MACHINE, "MACHINE_CRC", found, POSICAST_STAGE_MACHINE_CRC_RESET);
#endif
    found = (uint32_t)IORD_POSICAST_STAGE_AXES(base);
    if (found != POSICAST_STAGE_AXES_RESET)
        return refuse(stage, POSICAST_OTHER_MACHINE, "AXES", found, POSICAST_STAGE_AXES_RESET);
    stage->axes = found;
    found = (uint32_t)IORD_POSICAST_STAGE_TICK_CLOCKS(base);
    if (found != POSICAST_STAGE_TICK_CLOCKS_RESET)
        return refuse(stage, POSICAST_OTHER_MACHINE, "TICK_CLOCKS", found, POSICAST_STAGE_TICK_CLOCKS_RESET);
    stage->tick_clocks = found;
    return POSICAST_OK;
}

uint32_t posicast_all_axes(const posicast_stage *stage)
{
    return (1u << stage->axes) - 1u;
}

uint32_t posicast_state(const posicast_stage *stage, uint32_t axis)
{
    return state_of(posicast_status(stage, axis));
}

posicast_result posicast_switch_on(const posicast_stage *stage, uint32_t axes, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t axis, off = 0;
    posicast_result result = POSICAST_OK;

    if (!are_axes(stage, axes))
        return POSICAST_BAD_ARGUMENT;
    for (axis = 0; axis < stage->axes; axis++) {
        const uint32_t state = posicast_state(stage, axis);

        if (!has(axes, axis))
            continue;
        if (state == POSICAST_AXIS_STATUS_STATE_RUN || state == POSICAST_AXIS_STATUS_STATE_QUICK_STOP)
            return POSICAST_WRONG_STATE;
        if (state != POSICAST_AXIS_STATUS_STATE_HOLD)
            off |= 1u << axis;
    }
    /* READY must see it low first, so that an axis whose fault is cleared does not switch on by itself. */
    for (axis = 0; axis < stage->axes; axis++) {
        if (has(off, axis))
            set_control(stage, axis, POSICAST_AXIS_CONTROL_ENABLE_MSK | DIRECT_ENABLE, 0);
    }
    for (axis = 0; axis < stage->axes && result == POSICAST_OK; axis++) {
        if (has(off, axis))
            result = wait_ready(stage, axis, &left);
    }
    for (axis = 0; axis < stage->axes && result == POSICAST_OK; axis++) {
        if (has(off, axis))
            set_control(stage, axis, 0, POSICAST_AXIS_CONTROL_ENABLE_MSK);
    }
    for (axis = 0; axis < stage->axes && result == POSICAST_OK; axis++) {
        if (has(axes, axis))
            result = wait_holding(stage, axis, &left);
    }
    return result;
}

posicast_result posicast_switch_off(const posicast_stage *stage, uint32_t axes, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t axis;

    if (!are_axes(stage, axes))
        return POSICAST_BAD_ARGUMENT;
    for (axis = 0; axis < stage->axes; axis++) {
        if (has(axes, axis))
            set_control(stage, axis, POSICAST_AXIS_CONTROL_ENABLE_MSK | DIRECT_ENABLE, 0);
    }
    for (axis = 0; axis < stage->axes; axis++) {
        while (has(axes, axis)) {
            const uint32_t state = posicast_state(stage, axis);
            posicast_result result;

            if (state == POSICAST_AXIS_STATUS_STATE_OFF || state == POSICAST_AXIS_STATUS_STATE_READY)
                break;
            result = posicast_pass_time(stage, &left);
            if (result != POSICAST_OK)
                return state == POSICAST_AXIS_STATUS_STATE_FAULT && result == POSICAST_TIMEOUT ? POSICAST_FAULT : result;
        }
    }
    return POSICAST_OK;
}

posicast_result posicast_write_entry(const posicast_stage *stage, uint32_t axis, const posicast_entry *entry)
{
    return posicast_write_entries(stage, axis, entry, 1);
}

posicast_result posicast_write_entries(const posicast_stage *stage, uint32_t axis, const posicast_entry *entries,
                                       uint32_t count)
{
    const uint32_t refusals = POSICAST_AXIS_FLAGS_SEGMENT_REFUSED_MSK | POSICAST_AXIS_FLAGS_SEGMENT_MALFORMED_MSK;
    uint32_t place, before;
    posicast_result result;

    if (!is_axis(stage, axis) || count == 0 || count > POSICAST_FIFO_ENTRIES)
        return POSICAST_BAD_ARGUMENT;
    for (place = 0; place < count; place++) {
        if (posicast_entry_ticks(&entries[place]) == 0)
            return POSICAST_BAD_ARGUMENT;
    }
    if (FIELD(IORD_POSICAST_AXIS_FIFO(stage->base, axis), POSICAST_AXIS_FIFO_FIFO_LEVEL) + count > POSICAST_FIFO_ENTRIES)
        return POSICAST_FULL;
    if (!keeps_entries(posicast_status(stage, axis)))
        return POSICAST_REFUSED;
    before = posicast_flags(stage, axis);
    for (place = 0; place < count; place++)
        posicast_put_entry(stage, axis, &entries[place], place + 1 < count);
    /* Level and flags are then those after these entries. */
    result = posicast_refused_since(stage, axis, refusals, before);
    return result == POSICAST_OK && !keeps_entries(posicast_status(stage, axis)) ? POSICAST_REFUSED : result;
}

posicast_result posicast_queue_move(const posicast_stage *stage, uint32_t axis, int32_t end,
                                    const posicast_limits *limits)
{
    posicast_entry entries[POSICAST_PLAN_ROOM];
    uint32_t count;
    posicast_result result;

    if (!is_axis(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_HOLD ||
        !FIELD(IORD_POSICAST_AXIS_FIFO(stage->base, axis), POSICAST_AXIS_FIFO_SEGMENTS_EMPTY))
        return POSICAST_WRONG_STATE;
    result = posicast_plan_move(posicast_command_position(stage, axis), end, limits, entries, POSICAST_PLAN_ROOM,
                                &count);
    return result == POSICAST_OK && count > 0 ? posicast_write_entries(stage, axis, entries, count) : result;
}

posicast_result posicast_start(const posicast_stage *stage, uint32_t axes)
{
    posicast_patience left = posicast_patience_for(stage, START_TICKS);
    uint32_t axis;
    posicast_result result;

    if (!are_axes(stage, axes))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_STAGE_FLAGS(stage->base, POSICAST_STAGE_FLAGS_START_REFUSED_MSK);
    for (axis = 0; axis < stage->axes; axis++) {
        if (has(axes, axis))
            IOWR_POSICAST_AXIS_EVENTS(stage->base, axis, POSICAST_AXIS_EVENTS_REFUSED_MSK);
    }
    IOWR_POSICAST_STAGE_START(stage->base, AS_FIELD(axes, POSICAST_STAGE_START_START_AXES));
    result = posicast_wait_flags(stage);
    if (result != POSICAST_OK)
        return result;
    if ((uint32_t)IORD_POSICAST_STAGE_FLAGS(stage->base) & POSICAST_STAGE_FLAGS_START_REFUSED_MSK)
        return POSICAST_REFUSED;
    /* The start itself comes with the next tick, in which an axis may still refuse it. */
    for (axis = 0; axis < stage->axes; axis++) {
        while (has(axes, axis) && FIELD(posicast_status(stage, axis), POSICAST_AXIS_STATUS_CAN_START)) {
            result = posicast_pass_time(stage, &left);
            /* A very short move is already over and can start again. */
            if (result == POSICAST_TIMEOUT)
                break;
            if (result != POSICAST_OK)
                return result;
        }
        if (has(axes, axis) &&
            (uint32_t)IORD_POSICAST_AXIS_EVENTS(stage->base, axis) & POSICAST_AXIS_EVENTS_REFUSED_MSK)
            return POSICAST_REFUSED;
    }
    return POSICAST_OK;
}

/*
 * Waits until the commands stand still, with no entries left or, if `held`, with those that a feed hold keeps; then until the
 * shaped commands stand still.
 */
static posicast_result wait_standing(const posicast_stage *stage, uint32_t axes, int held, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);
    uint32_t axis, longest = 0;

    for (axis = 0; axis < stage->axes; axis++) {
        uint32_t settle;

        while (has(axes, axis)) {
            const uint32_t fifo = (uint32_t)IORD_POSICAST_AXIS_FIFO(stage->base, axis);
            posicast_result result;

            if (posicast_causes(stage, axis) != 0)
                return POSICAST_FAULT;
            if (held && FIELD(fifo, POSICAST_AXIS_FIFO_FEED_HELD))
                break;
            if (posicast_state(stage, axis) == POSICAST_AXIS_STATUS_STATE_HOLD &&
                FIELD(fifo, POSICAST_AXIS_FIFO_SEGMENTS_EMPTY))
                break;
            result = posicast_pass_time(stage, &left);
            if (result != POSICAST_OK)
                return result;
        }
        settle = FIELD(IORD_POSICAST_AXIS_SETTLE(stage->base, axis), POSICAST_AXIS_SETTLE_SETTLE_TICKS);
        if (has(axes, axis) && settle > longest)
            longest = settle;
    }
    return posicast_wait_ticks(stage, longest);
}

posicast_result posicast_wait_at_rest(const posicast_stage *stage, uint32_t axes, uint32_t ticks)
{
    return are_axes(stage, axes) ? wait_standing(stage, axes, 0, ticks) : POSICAST_BAD_ARGUMENT;
}

posicast_result posicast_feed_hold(const posicast_stage *stage, uint32_t axes)
{
    if (axes != 0 && !are_axes(stage, axes))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_STAGE_FEED_HOLD(stage->base, axes);
    return POSICAST_OK;
}

posicast_result posicast_wait_held(const posicast_stage *stage, uint32_t axes, uint32_t ticks)
{
    const uint32_t holds = (uint32_t)IORD_POSICAST_STAGE_FEED_HOLD(stage->base);

    if (!are_axes(stage, axes))
        return POSICAST_BAD_ARGUMENT;
    return (axes & ~holds) == 0 ? wait_standing(stage, axes, 1, ticks) : POSICAST_WRONG_STATE;
}

void posicast_stop(const posicast_stage *stage, uint32_t axes)
{
    uint32_t axis;

    for (axis = 0; axis < stage->axes; axis++) {
        if (has(axes, axis))
            IOWR_POSICAST_AXIS_STOP(stage->base, axis, 0);
    }
}

void posicast_take_snapshot(const posicast_stage *stage, posicast_snapshot *snapshot)
{
    uint32_t axis;

    IOWR_POSICAST_STAGE_SNAPSHOT(stage->base, 0);
    snapshot->time_stamp = (uint32_t)IORD_POSICAST_STAGE_SNAPSHOT_TIME_STAMP(stage->base);
    snapshot->tick_count = (uint32_t)IORD_POSICAST_STAGE_SNAPSHOT_TICK_COUNT(stage->base);
    for (axis = 0; axis < stage->axes; axis++) {
        snapshot->position[axis] = (int32_t)IORD_POSICAST_AXIS_SNAPSHOT_POSITION(stage->base, axis);
        snapshot->velocity[axis] = (int32_t)IORD_POSICAST_AXIS_SNAPSHOT_VELOCITY(stage->base, axis);
    }
}

int32_t posicast_command_position(const posicast_stage *stage, uint32_t axis)
{
    return (int32_t)IORD_POSICAST_AXIS_COMMAND_POSITION(stage->base, axis);
}

uint32_t posicast_causes(const posicast_stage *stage, uint32_t axis)
{
    return FIELD(IORD_POSICAST_AXIS_CAUSES(stage->base, axis), POSICAST_AXIS_CAUSES);
}

const char *posicast_cause_name(uint32_t causes)
{
    static const char *const names[] = POSICAST_CAUSE_NAMES;
    uint32_t bit;

    for (bit = 0; bit < sizeof names / sizeof names[0]; bit++) {
        if (causes >> bit & 1u)
            return names[bit];
    }
    return "none";
}

#if POSICAST_LOOP_AXES
posicast_result posicast_self_test(const posicast_stage *stage, uint32_t axis, int32_t duty,
                                   posicast_self_test_clocks *counted)
{
    const uint32_t test = POSICAST_AXIS_CONTROL_DIRECT_ENABLE_MSK | POSICAST_AXIS_CONTROL_SELF_TEST_MSK;
    posicast_result result = POSICAST_OK;
    uint32_t tick, clocks;

    if (!has_loop(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    if (posicast_state(stage, axis) != POSICAST_AXIS_STATUS_STATE_READY)
        return POSICAST_WRONG_STATE;
    set_control(stage, axis, 0, test);
    /* A duty expires after some time. */
    for (tick = 0; tick < SELF_TEST_TICKS && result == POSICAST_OK; tick++) {
        IOWR_POSICAST_AXIS_DIRECT(stage->base, axis, AS_FIELD(duty, POSICAST_AXIS_DIRECT_DIRECT_DUTY));
        result = posicast_wait_ticks(stage, 1);
    }
    clocks = (uint32_t)IORD_POSICAST_AXIS_SELF_TEST(stage->base, axis);
    /* Direct mode must end first: if only the other flag were cleared, the duty would reach the pins. */
    set_control(stage, axis, POSICAST_AXIS_CONTROL_DIRECT_ENABLE_MSK, 0);
    set_control(stage, axis, POSICAST_AXIS_CONTROL_SELF_TEST_MSK, 0);
    counted->a_high = FIELD(clocks, POSICAST_AXIS_SELF_TEST_SELF_TEST_HIGH);
    counted->a_low = FIELD(clocks, POSICAST_AXIS_SELF_TEST_SELF_TEST_LOW);
    return result;
}
#endif

void posicast_enable_interrupts(const posicast_stage *stage, uint32_t interrupts)
{
    IOWR_POSICAST_STAGE_INTERRUPT_ENABLE(stage->base, interrupts);
}

uint32_t posicast_take_interrupts(const posicast_stage *stage)
{
    const uint32_t enabled = (uint32_t)IORD_POSICAST_STAGE_INTERRUPT_ENABLE(stage->base);
    const uint32_t happened = (uint32_t)IORD_POSICAST_STAGE_INTERRUPT_STATE(stage->base) & enabled;

    /* Only the interrupts that were read are cleared: later ones stay, and raise the line again. */
    IOWR_POSICAST_STAGE_INTERRUPT_STATE(stage->base, happened);
    return happened;
}
