//! The C driver of a stage, as files of the output folder.
//!
//! ```text
//! driver/inc/*_regs.h            registers of the stage and of each component, from their maps
//! driver/inc, src/posicast_*     the core: bare metal, C99, the same for every machine
//! driver/inc, src/machine_NAME.* the machine's tap tables and limits
//! driver/TOP_sw.tcl, HAL/        for the HAL of Nios II and Nios V, with the enhanced interrupt API
//! driver/bare_metal/             a program without an operating system: first moves, and its Makefile
//! driver/linux/                  user space over UIO, the overlay of the device tree, and a server for hosts in the network
//! ```
//!
//! Sources that are the same for every machine are in `c/` and copied. Everything that depends on the machine is
//! derived from one description: macros from the [`RegisterMap`], numbers of the command FIFO from the model's
//! constants, tables from the stage's configuration. The core contains no name of an axis: it works on windows, by
//! number.
//!
//! An inline shaper with a line has a smaller driver: `posicast_inline.h` and `.c`, and the header of its registers.
//!
//! `docs/driver.md` says how a program uses it.

mod bare_metal;
mod family;
mod fixed;
mod inline;
mod linux;
mod machine;
mod macros;
mod registers;
mod stage_registers;
mod system;

pub use family::AxisFamily;
pub use inline::inline_files;

use posicast_blocks::registers::RegisterMap;
use posicast_blocks::stage::StageConfig;
use posicast_machine::motion::TickLimits;
use posicast_machine::unit::AxisUnit;

/// Folder of the driver in the output folder.
pub const FOLDER: &str = "driver";

/// A file to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DriverFile {
    /// Its path in the output folder, with `/` between the parts.
    pub path: String,
    /// Its contents.
    pub text: String,
}

/// Data from which the driver of a stage is written.
#[derive(Debug, Clone, Copy)]
pub struct StageDriver<'a> {
    /// The machine's name.
    pub machine: &'a str,
    /// The stage's top module, which is the class of the HAL's driver.
    pub top: &'a str,
    /// The stage's registers.
    pub map: &'a RegisterMap,
    /// The stage's configuration.
    pub config: &'a StageConfig,
    /// Tick rate in Hz.
    pub tick_hz: f64,
    /// Data of each axis of the stage, in its order.
    pub axes: &'a [AxisData],
    /// The table families of the axes whose modes move.
    pub families: &'a [AxisFamily<'a>],
}

/// Data of an axis for the driver, in addition to its hardware.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisData {
    /// Unit of its figures in the machine file.
    pub unit: AxisUnit,
    /// Counts of its loop per unit of the machine file.
    pub counts_per_unit: f64,
    /// Limits of its moves.
    pub limits: TickLimits,
}

/// The driver of a stage.
pub fn stage_files(driver: &StageDriver<'_>) -> Vec<DriverFile> {
    let axes = &driver.config.axes;
    let mut files = fixed::files(fixed::With {
        bring_up: axes.iter().any(|axis| axis.bring_up.is_some()),
        error_table: axes.iter().any(|axis| axis.error_table.is_some()),
        correction: axes.iter().any(|axis| axis.corrects),
        family: !driver.families.is_empty(),
        compare: axes.iter().any(|axis| axis.compare.is_some()),
        capture: driver.config.capture.is_some(),
    });
    files.push(file("inc/posicast_stage_regs.h", stage_registers::header(driver)));
    files.extend(machine::files(driver));
    files.extend(bare_metal::files(driver));
    files.extend(linux::files());
    let system = system::files(driver, &files);
    files.extend(system);
    files
}

/// The header with the macros of a component's registers, named after its top module.
pub fn component_header(top: &str, map: &RegisterMap) -> DriverFile {
    file(&format!("inc/{top}_regs.h"), registers::header(top, map))
}

fn file(path: &str, text: String) -> DriverFile {
    DriverFile {
        path: format!("{FOLDER}/{path}"),
        text,
    }
}
