//! The area of a machine's Verilog on a device.

use crate::table::Table;
use posicast_flow::synth::{ClockEstimates, Document};
use posicast_synth::yosys::{BlockEstimate, Estimate, Resources};

/// The blocks of the top, the components, and the clocks that were asked for.
pub(crate) fn synth(document: &Document) -> String {
    let clocks = document.clocks.as_ref().map_or_else(String::new, clocks);
    area(&document.estimate) + &components(&document.components) + &clocks
}

/// A table of blocks with the device's capacity, and the method of the estimate.
pub(super) fn area(estimate: &Estimate) -> String {
    let mut table = Table::new(&["block", ">cells", ">registers", ">memory bits", ">multipliers"]);
    let mut row = |name: &str, r: &Resources| table.row(cells(name, r));
    for block in &estimate.blocks {
        row(&block.name, &block.resources);
    }
    row("total", &estimate.total);
    let device = &estimate.device;
    let capacity = Resources {
        cells: device.cells,
        registers: device.registers,
        memory_bits: device.memory_bits,
        multipliers: device.multipliers,
        ..Resources::default()
    };
    row(device.name, &capacity);
    let method = &estimate.method;
    format!("{}Estimate by {}: {}\n", table.text(""), method.tool, method.note)
}

fn components(components: &[BlockEstimate]) -> String {
    if components.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["component", ">cells", ">registers", ">memory bits", ">multipliers"]);
    for component in components {
        table.row(cells(&component.name, &component.resources));
    }
    format!("\nBeside the top, each by itself:\n{}", table.text(""))
}

fn cells(name: &str, r: &Resources) -> impl Iterator<Item = String> {
    let numbers = [r.cells, r.registers, r.memory_bits, r.multipliers].map(|n| n.to_string());
    std::iter::once(name.to_owned()).chain(numbers)
}

/// A table of tops, and the method of the estimate.
fn clocks(clocks: &ClockEstimates) -> String {
    let mut table = Table::new(&["top", ">clock, MHz"]);
    for clock in &clocks.tops {
        table.row([clock.name.clone(), format!("{:.1}", clock.mhz)]);
    }
    format!("\n{}Clock: {}\n", table.text(""), clocks.method)
}
