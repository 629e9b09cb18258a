//! A simulated stage with its machine at a pseudo-terminal, on which `posicast host` can be tried without hardware.
//!
//! ```text
//! cargo run --release -p posicast-host --example served_stage -- machine.toml
//! posicast host PORT status --machine machine.toml --timeout 4000       with the PORT that it prints
//! ```
//!
//! It runs until it is interrupted. The simulation is slower than a stage; thus the longer time-out.
#![allow(clippy::print_stdout, reason = "this is a program")]

#[cfg(not(unix))]
fn main() {
    println!("this system has no pseudo-terminals");
}

#[cfg(unix)]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use posicast_blocks::linked_stage::address_limit;
    use posicast_closed_loop::linked_bench::LinkedBench;
    use posicast_closed_loop::stage_bench::StageBench;
    use posicast_machine::hardware::Hardware;
    use posicast_machine::machine_file::{self, LinkLine};
    use posicast_machine::plan::design_machine;
    use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
    use serialport::{SerialPort, TTYPort};
    use std::sync::atomic::AtomicBool;
    use std::time::Duration;

    let file = std::env::args().nth(1).ok_or("usage: served_stage MACHINE")?;
    let machine = machine_file::parse(&file, &std::fs::read_to_string(&file)?)?;
    let link = machine.link.ok_or("the machine file has no [link]")?;
    if let LinkLine::Spi { .. } = link.line {
        return Err("the line of the machine file is SPI: a pseudo-terminal stands for a serial line".into());
    }
    let design = design_machine(&machine)?;
    let hardware = Hardware::of(&machine, &design)?;
    let stage = hardware.stage()?.ok_or("the machine has no stage")?;
    let plants = machine
        .axes
        .iter()
        .map(|axis| AxisPlant::new(axis, &machine.clock, &PlantOptions::default()));
    let plants = plants.collect::<Result<_, _>>()?;
    let bench = StageBench::new(&stage.of_machine.config, &stage.component, plants, None, 1)?;
    let mut linked = LinkedBench::new(bench, &link, &machine.clock, address_limit(&stage.component));
    let (mut far, near) = TTYPort::pair()?;
    far.set_timeout(Duration::from_millis(2))?;
    println!("{}", near.name().ok_or("the terminal has no name")?);
    // One program holds a port: the command opens it again.
    drop(near);
    Ok(linked.serve(far, &AtomicBool::new(false))?)
}
