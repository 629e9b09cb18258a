//! The tasks of the shapers: plain, small, for motion.

use posicast_hdl::shaper;
use posicast_model::rtl::shaper::{Motion, ShaperConfig, ports};
use posicast_model::taps::{COEFFICIENT_BITS, Tap, TapTable};

use super::task::{Engine, Task, part, refused};
use crate::Error;

const INDUCTION: Engine = Engine::Induction { clocks: 1 };

/// All of them.
pub(super) fn tasks() -> Result<Vec<Task>, Error> {
    let motion = [motion(true)?, motion(false)?];
    Ok([vec![plain()?, small()?], motion.concat()].concat())
}

/// Taps of delay and coefficient.
fn table(fraction: u32, taps: &[(u32, i32)]) -> Result<TapTable, Error> {
    let taps = taps.iter().map(|&(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    TapTable::new(fraction, taps.collect()).map_err(refused)
}

/// The plain shaper with the smallest memories; delays have 6 bits, the rest of a tap's word is its coefficient.
fn plain() -> Result<Task, Error> {
    let config = ShaperConfig::new(32, table(16, &[(0, 20_000), (3, 30_000), (7, 15_536)])?).map_err(refused)?;
    let macros = [
        ("FRACTION", config.coefficient_fraction().to_string()),
        ("MACHINE_TAPS", format!("7'd{}", config.table().taps().len())),
    ];
    let block = (shaper::emit(&config, "")?, ports(&config));
    let task = Task::new("shaper", "32 bits, 64 samples, 64 taps", INDUCTION, block)
        .properties(&macros, include_str!("../../formal/shaper.sv"));
    Ok(Task {
        leaves_products_open: true,
        ..task
    })
}

/// The plain shaper's kernel so small that memories and multiplier are in the proof.
fn small() -> Result<Task, Error> {
    const DELAY_BITS: u32 = 2;
    let config = ShaperConfig::new(16, table(4, &[(0, 9), (1, -3), (2, 10)])?).map_err(refused)?;
    let mask = (1 << COEFFICIENT_BITS) - 1;
    let words = config.table().taps().iter().rev().map(|tap| {
        let (delay, coefficient) = (tap.delay_samples, tap.coefficient & mask);
        format!("{DELAY_BITS}'d{delay}, {COEFFICIENT_BITS}'d{coefficient}")
    });
    let macros = [
        ("FRACTION", config.coefficient_fraction().to_string()),
        ("MACHINE_TAPS", format!("3'd{}", config.table().taps().len())),
        ("MACHINE_TABLE", format!("{{{}}}", words.collect::<Vec<_>>().join(", "))),
    ];
    let modules = shaper::emit_small(&config)?;
    let ports = modules.last().map_or_else(Vec::new, |top| top.ports.clone());
    let task = Task::new("shaper_small", "6 bits, 4 samples, 4 taps", INDUCTION, (modules, ports))
        .properties(&macros, include_str!("../../formal/shaper_small.sv"));
    Ok(Task {
        keeps_memories: true,
        ..task
    })
}

/// The shaper for motion with all channels, the smallest words and memories: its control, and the arithmetic of a part of it
/// on its own.
fn motion(modulo: bool) -> Result<[Task; 2], Error> {
    let table = table(16, &[(0, 20_000), (3, 30_000), (7, 15_536)])?;
    let longest = table.longest_delay_samples();
    let motion = Motion { channels: 3, modulo };
    let config = ShaperConfig::new(24, table).and_then(|config| config.for_motion(motion));
    let config = config.map_err(refused)?;
    let macros = [
        ("FRACTION", config.coefficient_fraction().to_string()),
        ("MACHINE_TAPS", format!("7'd{}", config.table().taps().len())),
        ("MACHINE_LONGEST", format!("6'd{longest}")),
        ("MODULO", format!("1'b{}", u8::from(modulo))),
    ];
    let size = if modulo {
        "3 channels of 24 bits, position wraps"
    } else {
        "3 channels of 24 bits"
    };
    let control = (shaper::emit(&config, "")?, ports(&config));
    let sums = part(control.0.clone(), "channel_sums")?;
    Ok([
        ("shaper_motion", control, include_str!("../../formal/shaper_motion.sv")),
        ("channel_sums", sums, include_str!("../../formal/channel_sums.sv")),
    ]
    .map(|(name, block, text)| Task {
        leaves_products_open: true,
        ..Task::new(name, size, INDUCTION, block).properties(&macros, text)
    }))
}
