//! The list of proofs.

use posicast_hdl::emit::Module;
use posicast_hdl::{divider_share, group, pulse_counter, pwm, registers, schedule, segments, sliding_mode, time_base};
use posicast_model::rtl::component::Component;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_model::rtl::schedule::ScheduleConfig;
use posicast_model::rtl::segments as segments_model;
use posicast_model::rtl::sliding_mode as controller_model;
use posicast_model::rtl::{divider_share as share_model, group as group_model};
use posicast_model::rtl::{
    pulse_counter as counter_model, pwm as pwm_model, schedule as schedule_model, time_base as time_model,
};

use super::task::{Engine, INDUCTION, Task, part, refused};
use super::{axis, blocks, shapers, trace};
use crate::Error;

/// All tasks.
///
/// # Errors
/// [`Error::Block`] where a block cannot be written as Verilog.
pub fn all() -> Result<Vec<Task>, Error> {
    let two_low = ActiveLow {
        a_high: true,
        b_low: true,
        ..ActiveLow::default()
    };
    let mut tasks = vec![
        pwm(
            PwmConfig::new(ActiveLow::default(), 2, 1).map_err(refused)?,
            "16-bit period, all active high",
        )?,
        pwm(
            PwmConfig::new(two_low, 25, 50).map_err(refused)?.on_time_base(),
            "16-bit period, two pins active low, on a time base",
        )?,
        Task::new(
            "pulse_counter",
            "32-bit count",
            INDUCTION,
            (pulse_counter::emit("")?, counter_model::ports()),
        )
        .properties(&[], include_str!("../../formal/pulse_counter.sv")),
        registers_task()?,
    ];
    tasks.extend(axis::tasks()?);
    tasks.extend(trace::tasks()?);
    for axes in [2, 4] {
        tasks.push(group_task(axes)?);
    }
    for clocks in [2, 400] {
        tasks.push(schedule_task(clocks)?);
    }
    tasks.push(time_base_task(17, "32'd0")?);
    tasks.push(time_base_task(127, "32'd0")?);
    tasks.push(time_base_task(17, "32'hfffffff0")?);
    for channels in [1, 2, 3, 8] {
        tasks.push(divider_share_task(channels)?);
    }
    tasks.push(
        Task::new(
            "segments",
            "64 entries",
            Engine::Pdr,
            (segments::emit("")?, segments_model::ports()),
        )
        .properties(&[], include_str!("../../formal/segments.sv")),
    );
    tasks.push(segments_range_task()?);
    tasks.push(sliding_mode_task()?);
    tasks.push(part_of_controller(
        "scaled_product",
        "51 bits, any product",
        include_str!("../../formal/scaled_product.sv"),
    )?);
    tasks.push(part_of_controller(
        "accumulator",
        "52 bits",
        include_str!("../../formal/accumulator.sv"),
    )?);
    tasks.push(part_of_controller(
        "limiter",
        "32 bits",
        include_str!("../../formal/limiter.sv"),
    )?);
    tasks.extend(shapers::tasks()?);
    tasks.extend(blocks::tasks()?);
    Ok(tasks)
}

/// The tasks of a block.
///
/// # Errors
/// Those of [`all`], and [`Error::Option`] for a block that has no tasks.
pub fn named(name: &str) -> Result<Vec<Task>, Error> {
    let all = all()?;
    let names: Vec<&str> = all.iter().map(|task| task.name).collect();
    if !names.contains(&name) {
        let names = names.join(", ");
        return Err(Error::Option(format!(
            "no proofs for `{name}`: there are some for {names}"
        )));
    }
    Ok(all.into_iter().filter(|task| task.name == name).collect())
}

fn pwm(config: PwmConfig, size: &str) -> Result<Task, Error> {
    let active_low = config.active_low();
    let bit = |low: bool| u8::from(low);
    let off = format!(
        "4'b{}{}{}{}",
        bit(active_low.b_low),
        bit(active_low.b_high),
        bit(active_low.a_low),
        bit(active_low.a_high)
    );
    let macros = [
        ("PINS_OFF", off),
        ("DEAD_TIME_FLOOR", format!("10'd{}", config.dead_time_floor_clocks())),
        (
            "MINIMUM_PULSE_FLOOR",
            format!("10'd{}", config.minimum_pulse_floor_clocks()),
        ),
        ("ON_TIME_BASE", format!("1'b{}", bit(config.is_on_time_base()))),
    ];
    let block = (pwm::emit(&config, "")?, pwm_model::ports());
    Ok(Task::new("pwm", size, INDUCTION, block).properties(&macros, include_str!("../../formal/pwm.sv")))
}

/// The register bank of the PWM's component, which has fields of every kind, an interrupt, and byte enables.
fn registers_task() -> Result<Task, Error> {
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).map_err(refused)?;
    let component = Component::pwm(config, BridgeMode::Unipolar, 2500).map_err(refused)?;
    let block = (
        vec![registers::emit(component.map(), "")?],
        component.map().ports().to_vec(),
    );
    Ok(Task::new("registers", "bank of pwm", Engine::Pdr, block)
        .properties(&[], include_str!("../../formal/registers.sv")))
}

/// The ends of the position word.
fn segments_range_task() -> Result<Task, Error> {
    let counts = |counts: i32| format!("24'sd{counts}");
    let macros = [
        ("REACH_COUNTS", counts(segments_model::REACH_COUNTS)),
        ("STAND_COUNTS", counts(segments_model::STAND_COUNTS)),
    ];
    let block = (segments::emit("")?, segments_model::ports());
    Ok(Task::new("segments_range", "any position", INDUCTION, block)
        .properties(&macros, include_str!("../../formal/segments_range.sv")))
}

fn group_task(axes: usize) -> Result<Task, Error> {
    let list = |name: &str| {
        let lines: Vec<String> = (0..axes).rev().map(|axis| format!("{name}_{axis}")).collect();
        format!("{{{}}}", lines.join(", "))
    };
    let inputs: Vec<String> = group_model::ports(axes)
        .iter()
        .filter(|port| port.name.ends_with(|c: char| c.is_ascii_digit()))
        .map(|port| format!("input wire {}", port.name))
        .collect();
    let macros = [
        ("AXES", axes.to_string()),
        ("PER_AXIS", inputs.join(", ")),
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
    Ok(Task::new("group", &format!("{axes} axes"), Engine::Pdr, block)
        .properties(&macros, include_str!("../../formal/group.sv")))
}

fn schedule_task(clocks: u32) -> Result<Task, Error> {
    let config = ScheduleConfig::new(clocks).map_err(refused)?;
    let block = (schedule::emit(&config, "")?, schedule_model::ports());
    let size = format!("control after {clocks} clocks");
    Ok(
        Task::new("schedule", &size, Engine::Induction { clocks: 2 }, block).properties(
            &[("CONTROL_CLOCKS", format!("17'd{clocks}"))],
            include_str!("../../formal/schedule.sv"),
        ),
    )
}

/// Both counters begin with the same value: as after a reset, or shortly before they wrap.
fn time_base_task(tick_clocks: u64, begin: &'static str) -> Result<Task, Error> {
    let config = DividerConfig::new(tick_clocks).map_err(refused)?;
    let block = (time_base::emit(&config, "")?, time_model::ports());
    let size = format!("{tick_clocks} clocks per tick, counters from {begin}");
    let macros = [
        ("TICK_CLOCKS", format!("17'd{tick_clocks}")),
        ("BEGIN", begin.to_owned()),
    ];
    let task =
        Task::new("time_base", &size, INDUCTION, block).properties(&macros, include_str!("../../formal/time_base.sv"));
    Ok(Task {
        begins: vec![("time_stamp_q", begin), ("tick_count_q", begin)],
        ..task
    })
}

/// The controller's Verilog with free products, which nothing drives, except that one times a word is the word.
fn controller_of_any_products() -> Result<Vec<Module>, Error> {
    let mut modules = sliding_mode::emit("")?;
    for module in &mut modules {
        if module.name.starts_with("smul_") {
            let cut = (module.text)
                .replace("product <= a_q * b_q;", "product <= b_q == 18'sd1 ? a_q : anything;")
                .replace(
                    "    reg signed [17:0] b_q;",
                    "    reg signed [17:0] b_q;\n    wire signed [35:0] anything;",
                );
            if cut == module.text {
                return Err(refused(format!("`{}` has no product of its own name", module.name)));
            }
            module.text = cut;
        }
    }
    Ok(modules)
}

/// The sequence of the controller.
fn sliding_mode_task() -> Result<Task, Error> {
    let block = (controller_of_any_products()?, controller_model::ports());
    let macros = [("PASS_CLOCKS", format!("10'd{}", controller_model::CONTROL_CLOCKS))];
    Ok(Task::new("sliding_mode", "any products", INDUCTION, block)
        .properties(&macros, include_str!("../../formal/sliding_mode.sv")))
}

/// A part of the controller by itself, for a lemma about its arithmetic.
fn part_of_controller(name: &'static str, size: &str, properties: &str) -> Result<Task, Error> {
    let part = part(controller_of_any_products()?, name)?;
    Ok(Task::new(name, size, INDUCTION, part).properties(&[], properties))
}

fn divider_share_task(channels: usize) -> Result<Task, Error> {
    let valid: Vec<String> = (0..channels)
        .map(|channel| format!("quotient_valid_{channel}"))
        .collect();
    let reversed: Vec<&str> = valid.iter().rev().map(String::as_str).collect();
    let macros = [
        ("CHANNELS", format!("4'd{channels}")),
        ("PER_CHANNEL", format!("input wire {}", valid.join(", input wire "))),
        ("VALID", format!("{{{}}}", reversed.join(", "))),
    ];
    let block = (divider_share::emit(channels, "")?, share_model::ports(channels));
    Ok(
        Task::new("divider_share", &format!("{channels} channels"), Engine::Pdr, block)
            .properties(&macros, include_str!("../../formal/divider_share.sv")),
    )
}
