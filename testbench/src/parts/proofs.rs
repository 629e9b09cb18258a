//! The proofs of the small blocks that connect others.

use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_group::InlineGroupConfig;
use posicast_blocks::schedule::ScheduleConfig;
use posicast_blocks::{
    absolute_feedback as feedback_model, divider_share as share_model, group as group_model,
    lasting_deviation as lasting_model, probe_line as probe_model, realign as realign_model,
    sample_select as select_model, schedule as schedule_model, setting_banks as banks_model, time_base as time_model,
};
use posicast_hdl::{
    absolute_feedback, divider_share, group, inline_group, lasting_deviation, probe_line, realign, sample_select,
    schedule, setting_banks, time_base,
};

use crate::Error;
use crate::formal::{Engine, INDUCTION, Task, refused};
use crate::stage::example_settings;

pub(crate) fn group(axes: usize) -> Result<Task, Error> {
    let list = |name: &str| {
        let lines: Vec<String> = (0..axes).rev().map(|axis| format!("{name}_{axis}")).collect();
        format!("{{{}}}", lines.join(", "))
    };
    let macros = [
        ("AXES", axes.to_string()),
        ("CAN_START", list("can_start")),
        ("WANTS_GROUP_STOP", list("wants_group_stop")),
        ("EMERGENCY_STOP", list("emergency_stop")),
        ("AXIS_START", list("axis_start")),
        ("GROUP_STOP", list("group_stop")),
        ("FEED_HOLD", list("feed_hold")),
        ("RESTS", list("rests")),
        ("HOLD_FEED", list("hold_feed")),
    ];
    let block = (group::emit(axes, "")?, group_model::ports(axes));
    Ok(Task::new("group", &format!("{axes} axes"), Engine::Pdr, block).properties(&macros, include_str!("group.sv")))
}

/// The size of an inline group in words.
pub(crate) fn group_size(config: InlineGroupConfig) -> String {
    let registers = if config.with_registers { " with registers" } else { "" };
    format!("{} axes{registers}", config.axes)
}

pub(crate) fn inline_group(config: InlineGroupConfig) -> Result<Task, Error> {
    let axes = config.axes;
    let list = |name: &str| {
        let lines: Vec<String> = (0..axes).rev().map(|axis| format!("{name}_{axis}")).collect();
        format!("{{{}}}", lines.join(", "))
    };
    let macros = [
        ("AXIS_SETTLED", list("axis_settled")),
        ("AXIS_FAULT", list("axis_fault")),
    ];
    let block = (inline_group::emit(config, "")?, config.ports());
    let task = Task::new("inline_group", &group_size(config), Engine::Pdr, block);
    Ok(task.properties(&macros, include_str!("inline_group.sv")))
}

pub(crate) fn absolute_feedback() -> Result<Task, Error> {
    let block = (absolute_feedback::emit("")?, feedback_model::ports());
    Ok(Task::new("absolute_feedback", "", INDUCTION, block).properties(&[], include_str!("absolute_feedback.sv")))
}

pub(crate) fn lasting_deviation() -> Result<Task, Error> {
    let block = (lasting_deviation::emit("")?, lasting_model::ports());
    Ok(Task::new("lasting_deviation", "", INDUCTION, block).properties(&[], include_str!("lasting_deviation.sv")))
}

pub(crate) fn probe_line() -> Result<Task, Error> {
    let block = (probe_line::emit("")?, probe_model::ports());
    Ok(Task::new("probe_line", "", INDUCTION, block).properties(&[], include_str!("probe_line.sv")))
}

pub(crate) fn realign() -> Result<Task, Error> {
    let block = (realign::emit("")?, realign_model::ports());
    Ok(Task::new("realign", "", INDUCTION, block).properties(&[], include_str!("realign.sv")))
}

pub(crate) fn schedule(clocks: u32) -> Result<Task, Error> {
    let config = ScheduleConfig::new(clocks).map_err(refused)?;
    let block = (schedule::emit(&config, "")?, schedule_model::ports());
    let size = format!("control after {clocks} clocks");
    Ok(
        Task::new("schedule", &size, Engine::Induction { clocks: 2 }, block).properties(
            &[("CONTROL_CLOCKS", format!("17'd{clocks}"))],
            include_str!("schedule.sv"),
        ),
    )
}

/// Both counters begin with the same value, as after a reset or shortly before they wrap around.
pub(crate) fn time_base(tick_clocks: u64, begin: &'static str) -> Result<Task, Error> {
    let config = DividerConfig::new(tick_clocks).map_err(refused)?;
    let block = (time_base::emit(&config, "")?, time_model::ports());
    let size = format!("{tick_clocks} clocks per tick, counters from {begin}");
    let macros = [
        ("TICK_CLOCKS", format!("17'd{tick_clocks}")),
        ("BEGIN", begin.to_owned()),
    ];
    let task = Task::new("time_base", &size, INDUCTION, block).properties(&macros, include_str!("time_base.sv"));
    Ok(Task {
        begins: vec![("time_stamp_q", begin), ("tick_count_q", begin)],
        ..task
    })
}

pub(crate) fn divider_share(channels: usize) -> Result<Task, Error> {
    let valid: Vec<String> = (0..channels)
        .map(|channel| format!("quotient_valid_{channel}"))
        .collect();
    let reversed: Vec<&str> = valid.iter().rev().map(String::as_str).collect();
    let macros = [
        ("CHANNELS", format!("4'd{channels}")),
        ("VALID", format!("{{{}}}", reversed.join(", "))),
    ];
    let block = (divider_share::emit(channels, "")?, share_model::ports(channels));
    Ok(
        Task::new("divider_share", &format!("{channels} channels"), Engine::Pdr, block)
            .properties(&macros, include_str!("divider_share.sv")),
    )
}

pub(crate) fn sample_select(channels: usize) -> Result<Task, Error> {
    const WORD_BITS: u32 = 32;
    let words = |before: &str| -> Vec<String> {
        (0..channels)
            .rev()
            .map(|channel| format!("{before}x_{channel}"))
            .collect()
    };
    let list = |before: &str| format!("{{{}}}", words(before).join(", "));
    let macros = [
        ("WORD_BITS", WORD_BITS.to_string()),
        ("CHANNELS", channels.to_string()),
        ("HOST_WORDS", list("host_")),
        ("PIN_WORDS", list("pin_")),
        ("WORDS", list("")),
    ];
    let block = (
        sample_select::emit(WORD_BITS, channels, "")?,
        select_model::ports(WORD_BITS as usize, channels),
    );
    let size = format!("{WORD_BITS} bits, {channels} channels");
    Ok(Task::new("sample_select", &size, INDUCTION, block).properties(&macros, include_str!("sample_select.sv")))
}

pub(crate) fn setting_banks() -> Result<Task, Error> {
    let block = (setting_banks::emit(&example_settings()?, "")?, banks_model::ports());
    Ok(
        Task::new("setting_banks", "32 rows, contents left out", Engine::Pdr, block)
            .properties(&[], include_str!("setting_banks.sv")),
    )
}
