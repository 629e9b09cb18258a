//! `docs/register-tables.md` agrees with the register maps. `scripts/regenerate` writes it again.

use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::registers::{markdown, markdown_of};
use posicast_blocks::shaper::{ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{Law, Settings};
use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use posicast_taps::{Tap, TapTable};
use std::error::Error;
use std::path::Path;

const HEAD: &str = "\
# Registers of the components

This page lists all registers. `scripts/regenerate` writes it from the register maps; [registers.md](registers.md) explains the kinds of
access. Parameters and widths are those of an example: a shaper of 32 bits for three channels with a table of two taps, ticks of 5000
clocks, a PWM of 20 kHz at 50 MHz. `X_1`, `X_2`, `Y_1` and `Y_2` exist only in a shaper with that many channels, and `swap_how` only in
one that is built for motion, which can hand over; the plain shaper has `X` and `Y` in their place. The [stage](stage.md) is that of
`examples/xy-stage.toml`. Each of its axes has a window like that of `X`, which is the one shown; that of the next axis lies 0x100 words
further, and its names begin with `Y_`. A machine's own package lists all its windows, with its own names, in `docs/TOP.md` ([register documents](register-documents.md)).

";

fn components() -> Result<Vec<Component>, Box<dyn Error>> {
    let half = |delay_samples| Tap {
        delay_samples,
        coefficient: 1 << 15,
    };
    let motion = ShaperMotion {
        channels: 3,
        modulo: false,
    };
    let shaper = ShaperConfig::new(32, TapTable::new(16, vec![half(0), half(40)])?)?.for_motion(motion)?;
    Ok(vec![
        Component::shaper(shaper)?,
        Component::pulse_counter(DividerConfig::new(5000)?, 8, false)?,
        Component::pwm(
            PwmConfig::new(ActiveLow::default(), 25, 50)?,
            BridgeMode::HalfBridge,
            2500,
        )?,
        Component::sliding_mode(&Settings::default(), Law::SlidingMode, false)?,
    ])
}

/// Returns the stage of the example.
fn stage() -> Result<Component, Box<dyn Error>> {
    let machine = machine_file::parse("xy-stage.toml", include_str!("../../../examples/xy-stage.toml"))?;
    let stage = hardware::stage(&machine, &design_machine(&machine)?)?;
    Ok(Component::stage(&stage.ok_or("the example has no stage")?.config)?)
}

#[test]
fn golden_the_committed_tables_are_what_the_maps_say() -> Result<(), Box<dyn Error>> {
    let components = components()?;
    let mut tables: Vec<String> = components.iter().map(|component| markdown(component.map())).collect();
    tables.push(markdown_of(stage()?.map(), 2));
    let text = format!("{HEAD}{}", tables.join("\n"));
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/register-tables.md");
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&file, &text)?;
    }
    let committed = std::fs::read_to_string(&file)?;
    assert!(
        committed == text,
        "docs/register-tables.md is not what the maps say; if the change is meant: scripts/regenerate"
    );
    Ok(())
}
