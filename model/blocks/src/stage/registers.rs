//! The register map of a stage: a window of its own, and one per axis, all alike.

use super::config::{Follower, StageAxis, StageConfig};
use super::{absolute, axis_settings, axis_words, bring_up, capture, compare, error_table, steps};
use crate::group::MOST_AXES;
use crate::registers::maps;
use crate::registers::{Access, Description, Field, FlagSource, Register, WINDOW_WORDS};

/// Interrupts of an axis: name and meaning. Their bit in the interrupt registers is `7 · axis + index`.
pub const AXIS_INTERRUPTS: [(&str, &str); 7] = [
    ("notify", "an entry with this flag has ended"),
    ("move_done", "a move has ended at rest, or a quick stop is over"),
    ("fifo_low", "at most `low_water` entries wait"),
    ("halted", "RUN or QUICK_STOP has become HOLD"),
    ("stopping", "a quick stop has begun"),
    ("faulted", "the axis is in FAULT"),
    ("index_seen", "an index was latched"),
];

/// Bit of an axis's interrupt in the interrupt registers; `None` where there is no interrupt with this name.
pub fn axis_interrupt_bit(axis: usize, name: &str) -> Option<u32> {
    let place = AXIS_INTERRUPTS.iter().position(|(interrupt, _)| *interrupt == name)?;
    Some((axis * AXIS_INTERRUPTS.len() + place) as u32)
}

/// All registers of the stage.
pub(super) fn stage(config: &StageConfig) -> Description {
    let about = "Stage: axes, from motion segments to the pins; window 0 is the stage's, then there is one window per \
        axis.";
    let parameter = |name: &str, bits, meaning: &str, value| Field::new(name, 0, bits, meaning).with_reset(value);
    let mut parameters = vec![
        parameter("axes", 3, "windows after this one", config.axes.len() as u32),
        parameter("tick_clocks", 17, "time from tick to tick", config.tick.tick_clocks()).with_unit("clocks"),
        parameter(
            "control_clocks",
            17,
            "time from the tick to the start of the controllers",
            config.timing().control_clocks(),
        )
        .with_unit("clocks"),
        parameter(
            "duty_clocks",
            17,
            match config.axes.iter().any(|axis| axis.closed_loop().is_some()) {
                true => "time from the tick to the new duty, which the PWM takes at its next boundary",
                false => "time from the tick to the start of the step generators",
            },
            config.timing().duty_clocks(),
        )
        .with_unit("clocks"),
    ];
    if let Some(crc) = config.machine_crc {
        parameters.push(parameter("machine_crc", 32, "CRC-32 of the machine file", crc));
    }
    let mut description = Description::new(super::STAGE, about, *b"STGE", (2, 2), parameters)
        .with_windows(config.axes.len() as u32 + 1)
        .with(
            "snapshot",
            0x08,
            Access::Snapshot,
            "freezes the words `SNAPSHOT_...` of all axes",
            vec![],
        );
    let windows: Vec<Vec<Register>> = config.axes.iter().map(axis_window).collect();
    let any = |of: fn(&Access) -> bool| windows.iter().flatten().any(|register| of(&register.access));
    let staged = any(|access| matches!(access, Access::Staged));
    let guarded = any(|access| matches!(access, Access::Guarded { .. }));
    if staged {
        description = description.with(
            "commit",
            0x09,
            Access::Commit {
                tick: "tick".to_owned(),
            },
            "applies the staged registers of all axes together at the next tick",
            vec![Field::flag("commit_waits", 0, "a commit waits")],
        );
    }
    let mut description = description
        .with(
            "start",
            0x0a,
            Access::command("start"),
            "starts all these axes in one tick, or none",
            vec![Field::new("start_axes", 0, MOST_AXES as u32, "bit k: axis k")],
        )
        .with(
            "flags",
            0x0b,
            Access::Sticky,
            "events since the flag was cleared",
            flags(staged, guarded),
        )
        .with_interrupts(0x0c, interrupts(config))
        .with(
            "feed_hold",
            0x0f,
            Access::Configuration,
            "feed hold: these axes stand once all of them rest in one tick, and keep their waiting entries",
            feed_holds(config),
        )
        .with_times(0x20, 0x40);
    if let Some(of) = &config.capture {
        description = capture::described(description, of, config);
    }
    for ((window, axis), registers) in (1..).zip(&config.axes).zip(windows) {
        let placed = registers
            .into_iter()
            .map(|register| axis_register(register, &axis.name, window * WINDOW_WORDS));
        description.registers.extend(placed);
    }
    description
}

/// Access of registers that change the loop's feedback: written only while the axis's drive is off.
pub(super) fn with_the_drive_off() -> Access {
    Access::Guarded {
        while_low: "drive_enable".to_owned(),
    }
}

/// The register with the axis's name as prefix, in the axis's window.
pub(crate) fn axis_register(mut register: Register, axis: &str, base: u32) -> Register {
    let named = |name: &mut String| *name = format!("{axis}_{name}");
    named(&mut register.name);
    register.offset += base;
    for field in &mut register.fields {
        named(&mut field.name);
    }
    match &mut register.access {
        Access::Shadow { of } => named(of),
        Access::Guarded { while_low } => named(while_low),
        Access::Command { strobe } => named(strobe),
        Access::Words { strobe, word, .. } => {
            named(strobe);
            named(word);
        }
        _ => {}
    }
    register
}

/// Flags of the stage: those of a commit only with `staged` registers, those of a guard only with `guarded` ones.
fn flags(staged: bool, guarded: bool) -> Vec<Field> {
    let commit = Field::flag("commit_rejected", 1, "a write was ignored because a commit waits")
        .set_by(FlagSource::CommitRejected);
    let guard = Field::flag("guard_refused", 3, "a write was ignored: the drive of its axis was on")
        .set_by(FlagSource::GuardRefused);
    let start = Field::flag("start_refused", 2, "an axis could not start, so none was started");
    [maps::partial_write(0)]
        .into_iter()
        .chain(staged.then_some(commit))
        .chain([start])
        .chain(guarded.then_some(guard))
        .collect()
}

fn feed_holds(config: &StageConfig) -> Vec<Field> {
    let axes = (0..).zip(&config.axes);
    axes.map(|(bit, axis)| Field::flag(&format!("{}_feed_hold", axis.name), bit, "its bit of `START`"))
        .collect()
}

fn interrupts(config: &StageConfig) -> Vec<Field> {
    let mut fields = Vec::new();
    for (index, axis) in (0..).zip(&config.axes) {
        for (place, (name, meaning)) in (0..).zip(AXIS_INTERRUPTS) {
            if axis.absolute().is_some() && name == absolute::LACKS_INTERRUPT {
                continue;
            }
            let bit = index * AXIS_INTERRUPTS.len() as u32 + place;
            fields.push(Field::flag(&format!("{}_{name}", axis.name), bit, meaning));
        }
    }
    for (index, axis) in config.axes.iter().enumerate() {
        if let Some(bit) = config.compare_interrupt_bit(index) {
            let (name, meaning) = compare::INTERRUPT;
            fields.push(Field::flag(&format!("{}_{name}", axis.name), bit, meaning));
        }
    }
    if config.capture.is_some() {
        let (name, bit, meaning) = capture::INTERRUPT;
        fields.push(Field::flag(name, bit, meaning));
    }
    fields.push(Field::flag("tick", 28, "a tick has passed"));
    fields.push(Field::flag(
        "start_refused",
        29,
        "an axis could not start, so none was started",
    ));
    fields
}

/// Names of the ports that these registers drive, and of those that they and the interrupts of a stage read.
pub(super) fn hardware(registers: &[Register]) -> (Vec<String>, Vec<String>) {
    let (driven, mut read) = driven_and_read(registers);
    let more = AXIS_INTERRUPTS.iter().map(|(name, _)| (*name).to_owned());
    read.extend(more.filter(|name| !read.contains(name)).collect::<Vec<_>>());
    (driven, read)
}

/// Names of the ports that these registers drive, and of those that they read; interrupts read more.
pub(crate) fn driven_and_read(registers: &[Register]) -> (Vec<String>, Vec<String>) {
    let (mut driven, mut read) = (Vec::new(), Vec::new());
    for register in registers {
        match &register.access {
            Access::Command { strobe } => driven.push(strobe.clone()),
            Access::Words { strobe, word, .. } => driven.extend([strobe.clone(), word.clone()]),
            _ => {}
        }
        let names = register.fields.iter().map(|field| field.name.clone());
        match &register.access {
            access if access.drives_fields() => driven.extend(names),
            Access::Live | Access::Sticky => read.extend(names),
            _ => {}
        }
    }
    (driven, read)
}

/// The registers of an axis, in words of its window, without the axis's name as prefix.
pub fn axis_window(axis: &StageAxis) -> Vec<Register> {
    let mut registers = axis_settings::registers(axis);
    registers.extend(axis_words::registers(axis));
    if let Some(scale) = &axis.scale {
        registers.extend(axis_words::of_scale(scale));
    }
    if axis.corrects {
        registers.extend(axis_words::of_correction());
    }
    if let Some(of) = &axis.error_table {
        registers.extend(error_table::registers(&of.table));
    }
    if axis.bring_up.is_some() {
        registers.extend(bring_up::registers());
    }
    if let Some(of) = &axis.compare {
        registers.extend(compare::registers(of));
    }
    match &axis.follower {
        Follower::Loop(of) => match &of.absolute {
            Some(of) => absolute::registers(of, registers),
            None => registers,
        },
        Follower::Steps(config) => steps::registers(config, axis.probe.is_some(), registers),
    }
}
