/* The functions of posicast_bring_up.h. */
#include "posicast_bring_up.h"

#include "posicast_wait.h"

#define MOST(name) (name##_MSK >> name##_OFST)

static int has_bring_up(const posicast_stage *stage, uint32_t axis)
{
    return is_axis(stage, axis) && has(POSICAST_BRING_UP_AXES, axis);
}

static int is_idle(const posicast_stage *stage, uint32_t axis)
{
    return FIELD(IORD_POSICAST_AXIS_TRACE_STATUS(stage->base, axis), POSICAST_AXIS_TRACE_STATUS_TRACE_STATE) == 0;
}

static uint32_t events(const posicast_stage *stage, uint32_t axis)
{
    return (uint32_t)IORD_POSICAST_AXIS_BRING_UP_EVENTS(stage->base, axis);
}

/* Returns the configured number of signals in a row. */
static uint32_t signals_of(const posicast_stage *stage, uint32_t axis)
{
    const uint32_t setup = (uint32_t)IORD_POSICAST_AXIS_TRACE_SETUP(stage->base, axis);

    switch (FIELD(setup, POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS)) {
    case POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS_ONE:
        return 1;
    case POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS_TWO:
        return 2;
    default:
        return POSICAST_TRACE_SIGNALS_MAX;
    }
}

static uint32_t mode_of(uint32_t signals)
{
    switch (signals) {
    case 1:
        return POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS_ONE;
    case 2:
        return POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS_TWO;
    default:
        return POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS_FOUR;
    }
}

static int trace_fits(const posicast_trace *trace)
{
    uint32_t place;

    for (place = 0; place < POSICAST_TRACE_SIGNALS_MAX; place++) {
        if (place < trace->signals && trace->select[place] > MOST(POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_0))
            return 0;
    }
    return (trace->signals == 1 || trace->signals == 2 || trace->signals == POSICAST_TRACE_SIGNALS_MAX) &&
           trace->decimation <= MOST(POSICAST_AXIS_TRACE_RATE_TRACE_DECIMATION) &&
           trace->pre_trigger <= MOST(POSICAST_AXIS_TRACE_RATE_TRACE_PRE_TRIGGER) &&
           trace->trigger_mode <= MOST(POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_MODE) &&
           trace->trigger_select <= MOST(POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_SELECT);
}

posicast_result posicast_trace_arm(const posicast_stage *stage, uint32_t axis, const posicast_trace *trace)
{
    uint32_t setup, place;

    if (!has_bring_up(stage, axis) || !trace_fits(trace))
        return POSICAST_BAD_ARGUMENT;
    setup = AS_FIELD(trace->trigger_select, POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_SELECT) |
            AS_FIELD(trace->trigger_mode, POSICAST_AXIS_TRACE_SETUP_TRACE_TRIGGER_MODE) |
            AS_FIELD(mode_of(trace->signals), POSICAST_AXIS_TRACE_SETUP_TRACE_SIGNALS);
    for (place = 0; place < trace->signals; place++)
        setup |= trace->select[place] << POSICAST_AXIS_TRACE_SETUP_TRACE_SELECT_1_OFST * place;
    /* A running signal would use the new settings. */
    IOWR_POSICAST_AXIS_TRACE_HALT(stage->base, axis, 0);
    IOWR_POSICAST_AXIS_TRACE_SETUP(stage->base, axis, setup);
    IOWR_POSICAST_AXIS_TRACE_RATE(stage->base, axis,
                                  AS_FIELD(trace->decimation, POSICAST_AXIS_TRACE_RATE_TRACE_DECIMATION) |
                                      AS_FIELD(trace->pre_trigger, POSICAST_AXIS_TRACE_RATE_TRACE_PRE_TRIGGER));
    IOWR_POSICAST_AXIS_TRACE_LEVEL(stage->base, axis, (uint32_t)trace->trigger_level);
    IOWR_POSICAST_AXIS_TRACE_ARM(stage->base, axis, 0);
    return posicast_wait_flags(stage);
}

posicast_result posicast_trace_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);

    if (!has_bring_up(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    while (!is_idle(stage, axis)) {
        const posicast_result result = posicast_pass_time(stage, &left);

        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

posicast_result posicast_trace_halt(const posicast_stage *stage, uint32_t axis)
{
    if (!has_bring_up(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_AXIS_TRACE_HALT(stage->base, axis, 0);
    /* The current row is completed first. */
    return posicast_wait_flags(stage);
}

posicast_result posicast_trace_rows(const posicast_stage *stage, uint32_t axis, uint32_t *rows, uint32_t *trigger_row)
{
    uint32_t word;

    if (!has_bring_up(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    word = (uint32_t)IORD_POSICAST_AXIS_TRACE_STATUS(stage->base, axis);
    *rows = FIELD(word, POSICAST_AXIS_TRACE_STATUS_TRACE_ROWS);
    *trigger_row = FIELD(word, POSICAST_AXIS_TRACE_STATUS_TRACE_TRIGGER_ROW);
    return POSICAST_OK;
}

posicast_result posicast_trace_read(const posicast_stage *stage, uint32_t axis, uint32_t row, int32_t *words)
{
    uint32_t rows, trigger_row, signals, place;
    posicast_result result = posicast_trace_rows(stage, axis, &rows, &trigger_row);

    if (result != POSICAST_OK)
        return result;
    if (!is_idle(stage, axis))
        return POSICAST_WRONG_STATE;
    if (row >= rows)
        return POSICAST_BAD_ARGUMENT;
    signals = signals_of(stage, axis);
    for (place = 0; place < signals && result == POSICAST_OK; place++) {
        IOWR_POSICAST_AXIS_TRACE_ADDRESS(
            stage->base, axis, AS_FIELD(row * signals + place, POSICAST_AXIS_TRACE_ADDRESS));
        /* The memory needs some clocks, like the flags. */
        result = posicast_wait_flags(stage);
        words[place] = (int32_t)IORD_POSICAST_AXIS_TRACE_DATA(stage->base, axis);
    }
    return result;
}

static int excitation_fits(const posicast_excitation *excitation)
{
    return excitation->kind >= POSICAST_AXIS_EXCITATION_EXCITATION_KIND_PRBS &&
           excitation->kind <= MOST(POSICAST_AXIS_EXCITATION_EXCITATION_KIND) &&
           excitation->amplitude <= MOST(POSICAST_AXIS_EXCITATION_EXCITATION_AMPLITUDE) &&
           excitation->period_ticks >= 1 &&
           excitation->period_ticks <= MOST(POSICAST_AXIS_EXCITATION_TIME_EXCITATION_PERIOD) &&
           excitation->sweep <= MOST(POSICAST_AXIS_EXCITATION_TIME_EXCITATION_SWEEP) &&
           excitation->duration_ticks >= 1 &&
           excitation->duration_ticks <= MOST(POSICAST_AXIS_EXCITATION_LENGTH_EXCITATION_DURATION);
}

posicast_result posicast_excite(const posicast_stage *stage, uint32_t axis, const posicast_excitation *excitation)
{
    posicast_result result = posicast_excitation_end(stage, axis);

    if (result != POSICAST_OK || !excitation_fits(excitation))
        return POSICAST_BAD_ARGUMENT;
    if (!FIELD(posicast_status(stage, axis), POSICAST_AXIS_STATUS_CAN_START))
        return POSICAST_WRONG_STATE;
    IOWR_POSICAST_AXIS_EXCITATION_TIME(
        stage->base, axis,
        AS_FIELD(excitation->period_ticks, POSICAST_AXIS_EXCITATION_TIME_EXCITATION_PERIOD) |
            AS_FIELD(excitation->sweep, POSICAST_AXIS_EXCITATION_TIME_EXCITATION_SWEEP));
    IOWR_POSICAST_AXIS_EXCITATION_LENGTH(
        stage->base, axis,
        AS_FIELD(excitation->duration_ticks, POSICAST_AXIS_EXCITATION_LENGTH_EXCITATION_DURATION));
    IOWR_POSICAST_AXIS_BRING_UP_EVENTS(stage->base, axis, POSICAST_AXIS_BRING_UP_EVENTS_EXCITATION_DONE_MSK);
    IOWR_POSICAST_AXIS_EXCITATION(stage->base, axis,
                                  AS_FIELD(excitation->kind, POSICAST_AXIS_EXCITATION_EXCITATION_KIND) |
                                      AS_FIELD(excitation->amplitude, POSICAST_AXIS_EXCITATION_EXCITATION_AMPLITUDE) |
                                      POSICAST_AXIS_EXCITATION_EXCITATION_ENABLE_MSK);
    return posicast_wait_flags(stage);
}

posicast_result posicast_excitation_wait(const posicast_stage *stage, uint32_t axis, uint32_t ticks)
{
    posicast_patience left = posicast_patience_for(stage, ticks);

    if (!has_bring_up(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    while (!(events(stage, axis) & POSICAST_AXIS_BRING_UP_EVENTS_EXCITATION_DONE_MSK)) {
        posicast_result result;

        if (posicast_causes(stage, axis) != 0)
            return POSICAST_FAULT;
        result = posicast_pass_time(stage, &left);
        if (result != POSICAST_OK)
            return result;
    }
    return POSICAST_OK;
}

posicast_result posicast_excitation_end(const posicast_stage *stage, uint32_t axis)
{
    if (!has_bring_up(stage, axis))
        return POSICAST_BAD_ARGUMENT;
    IOWR_POSICAST_AXIS_EXCITATION(stage->base, axis, 0);
    return POSICAST_OK;
}
