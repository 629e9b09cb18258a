//! Files that `generate` adds for Platform Designer and Quartus: a machine's stage and blocks as components, its
//! system and projects.

use crate::failure::Failure;
use crate::hardware::Stage;
use crate::machine;
use crate::observer::Observer;
use crate::warning::Warning;
use posicast_hdl::linked_stage::emit_bridge;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_synth::package::Package;
use posicast_synth::sopc::{Board, BridgeUnit, Design, InlineUnit, Unit};
use posicast_testbench::blocks::Block;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::linked_stage::LinkedStageBlock;
use std::path::Path;

/// Key of the board.
const BOARD_KEY: &str = "target.board";
/// Table of the machine file with the line to a host.
const LINK_KEY: &str = "link";

/// The board that the machine file at `path` names.
///
/// # Errors
/// [`Failure`] with the line, for an unknown board, or one whose device is of another family than the file's.
pub(crate) fn board(machine: &Machine, path: &Path) -> Result<Option<Board>, Failure> {
    let Some(name) = machine.target.as_ref().and_then(|target| target.board.as_deref()) else {
        return Ok(None);
    };
    let refused = |reason: &dyn std::fmt::Display| machine::at_key(path, 0, BOARD_KEY, reason);
    let board: Board = name.parse().map_err(|error| refused(&error))?;
    let family = machine::family(machine)?;
    if board.family() != family {
        let device = board.family().device().name;
        let allowed = board.family();
        let message = format!("{board} has an {device}, of family {allowed}, and target.family is {family}");
        return Err(
            Failure::input(machine::place(path, 0, BOARD_KEY, message)).with_help(format!(
                "write `family = \"{allowed}\"`, or leave out `board` if the device is on another"
            )),
        );
    }
    Ok(Some(board))
}

/// Adds the files to the folder; `path` is the machine file.
pub(crate) fn add(
    package: &mut Package,
    (machine, path): (&Machine, &Path),
    board: Option<Board>,
    (stage, link): (Option<&Stage>, Option<&LinkedStageBlock>),
    components: &[ComponentBlock],
    inline: Option<InlineUnit>,
    observer: &dyn Observer,
) -> Result<(), Failure> {
    let tops: Vec<String> = components.iter().map(Block::top).collect();
    let stage_top = stage.map(|stage| stage.block.top());
    let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let stage = match stage.zip(stage_top.as_deref()) {
        Some((stage, top)) => Some(unit(&stage.block, top, axes)?),
        None => None,
    };
    let components: Result<Vec<Unit<'_>>, Failure> = components
        .iter()
        .zip(&tops)
        .map(|(block, top)| unit(block, top, Vec::new()))
        .collect();
    let is_active_low = |axis: &&AxisSection| axis.pwm.as_ref().is_some_and(|pwm| pwm.active_low);
    let active_low = machine.axes.iter().filter(is_active_low);
    let design = Design {
        machine: &machine.name,
        clock_hz: machine.clock.frequency_hz,
        board,
        stage,
        link: link.map(|link| bridge(link, machine)).transpose()?,
        active_low_axes: active_low.map(|axis| axis.name.as_str()).collect(),
        components: components?,
        inline,
        bus: machine.target.as_ref().and_then(|target| target.bus),
    };
    if let Some(board) = board.filter(|board| design.stage.is_some() && !design.runs_on(*board)) {
        let text = format!(
            "no project for {board}: its oscillator and clock.frequency_hz differ; README.md gives the difference"
        );
        Warning::new(0, BOARD_KEY, text).tell(path, observer);
    }
    for error in design.without_link_project() {
        let text = format!("no project without a processor: {error}");
        Warning::new(0, LINK_KEY, text).tell(path, observer);
    }
    for file in design.files().map_err(Failure::because)? {
        package
            .add(&file.path, file.text.as_bytes())
            .map_err(Failure::because)?;
    }
    Ok(())
}

/// The top with the line, and the bridge in it.
fn bridge(link: &LinkedStageBlock, machine: &Machine) -> Result<(String, BridgeUnit), Failure> {
    let modules = emit_bridge(link.config(), &machine.name).map_err(Failure::because)?;
    let bridge = BridgeUnit {
        config: *link.config(),
        modules: modules.into_iter().map(|module| module.name).collect(),
    };
    Ok((link.top(), bridge))
}

/// A component with the names of its modules.
fn unit<'a>(block: &'a ComponentBlock, top: &'a str, axes: Vec<&'a str>) -> Result<Unit<'a>, Failure> {
    let modules = block.modules().map_err(Failure::because)?;
    Ok(Unit {
        top,
        component: block.component(),
        modules: modules.into_iter().map(|module| module.name).collect(),
        axes,
    })
}
