//! Proofs of the shapers: the plain one, a small one, and the motion shaper.

use posicast_blocks::Port;
use posicast_blocks::shaper::{ShaperConfig, ShaperMotion, ports};
use posicast_hdl::emit::Module;
use posicast_hdl::shaper;
use posicast_taps::COEFFICIENT_BITS;

use super::tap_table as table;
use crate::Error;
use crate::formal::{INDUCTION, Task, part, refused};

/// Returns all of these proofs.
pub(crate) fn tasks() -> Result<Vec<Task>, Error> {
    Ok(vec![
        plain()?,
        small()?,
        motion()?,
        channel_sums(true)?,
        channel_sums(false)?,
    ])
}

/// The plain shaper with the smallest memories. Delays have 6 bits; the other bits of a tap's word are its coefficient.
fn plain() -> Result<Task, Error> {
    let config = ShaperConfig::new(32, table(16, &[(0, 20_000), (3, 30_000), (7, 15_536)])?).map_err(refused)?;
    let macros = [
        ("FRACTION", config.coefficient_fraction().to_string()),
        ("MACHINE_TAPS", format!("7'd{}", config.table().taps().len())),
    ];
    let block = (shaper::emit(&config, "")?, ports(&config));
    let task = Task::new("shaper", "32 bits, 64 samples, 64 taps", INDUCTION, block)
        .properties(&macros, include_str!("shaper.sv"));
    Ok(Task {
        leaves_products_open: true,
        ..task
    })
}

/// The plain shaper's kernel at sizes so small that the proof can include memories and multiplier.
fn small() -> Result<Task, Error> {
    const DELAY_BITS: u32 = 2;
    let config = ShaperConfig::of_sizes(6, DELAY_BITS, 2, table(4, &[(0, 9), (1, -3), (2, 10)])?).map_err(refused)?;
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
    let block = (shaper::emit(&config, "")?, ports(&config));
    let task = Task::new("shaper_small", "6 bits, 4 samples, 4 taps", INDUCTION, block)
        .properties(&macros, include_str!("shaper_small.sv"));
    Ok(Task {
        keeps_memories: true,
        ..task
    })
}

/// The control of the motion shaper, which is the same whether or not the position wraps.
fn motion() -> Result<Task, Error> {
    let config = motion_config(true)?;
    let block = (shaper::emit(&config, "")?, ports(&config));
    let text = include_str!("shaper_motion.sv");
    let size = "3 channels, 64 samples, 64 taps";
    Ok(motion_task("shaper_motion", size, &config, block, text))
}

/// The part of the motion shaper that computes, alone.
fn channel_sums(modulo: bool) -> Result<Task, Error> {
    let config = motion_config(modulo)?;
    let block = part(shaper::emit(&config, "")?, "channel_sums")?;
    let text = include_str!("channel_sums.sv");
    let size = if modulo { "24 bits, position wraps" } else { "24 bits" };
    Ok(motion_task("channel_sums", size, &config, block, text))
}

/// A motion shaper with all channels, and the smallest words and memories.
fn motion_config(modulo: bool) -> Result<ShaperConfig, Error> {
    let table = table(16, &[(0, 20_000), (3, 30_000), (7, 15_536)])?;
    let motion = ShaperMotion { channels: 3, modulo };
    let config = ShaperConfig::new(24, table).and_then(|config| config.for_motion(motion));
    config.map_err(refused)
}

fn motion_task(
    name: &'static str,
    size: &str,
    config: &ShaperConfig,
    block: (Vec<Module>, Vec<Port>),
    text: &str,
) -> Task {
    let (table, modulo) = (config.table(), config.motion().is_some_and(|motion| motion.modulo));
    let macros = [
        ("FRACTION", config.coefficient_fraction().to_string()),
        ("MACHINE_TAPS", format!("7'd{}", table.taps().len())),
        ("MACHINE_LONGEST", format!("6'd{}", table.longest_delay_samples())),
        ("MODULO", format!("1'b{}", u8::from(modulo))),
    ];
    Task {
        leaves_products_open: true,
        ..Task::new(name, size, INDUCTION, block).properties(&macros, text)
    }
}
