//! Writes `README.md` of the folder: its contents, and what to do with it in Quartus.

use std::fmt::Write;

use super::board::{Board, Processor};
use super::core::{Core, Line};
use super::pins::Pin;
use super::unit::Unit;
use super::{Design, InlineUnit, system};
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::linked_stage::BridgeConfig;

/// A board with a project, the project's content, and its pins.
type Project<'a> = (Board, Core<'a>, Vec<Pin>);

/// Returns the text of the page.
pub(super) fn text(design: &Design<'_>, projects: &[Project<'_>]) -> String {
    let mut text = String::new();
    contents(&mut text, design, projects);
    if let Some(unit) = &design.inline {
        inline(&mut text, unit);
        return text;
    }
    if design.units().next().is_none() {
        text.push_str(
            "\nThe machine has only shapers: without a component with registers, there is nothing for Platform Designer. `kit/README.md` \
             says how the top module goes into a design of your own.\n",
        );
        return text;
    }
    components(&mut text, design);
    if design.stage.is_none() {
        text.push_str(
            "\nThe machine has no stage (which requires a complete loop on every axis), so there is neither a system nor a project. Add the \
             components to a system of your own: in Platform Designer, add the folder `sopc/` to the search path.\n",
        );
        return text;
    }
    boards(&mut text, design);
    // What keeps a power stage safe comes before the steps that load the device.
    if !projects.is_empty() {
        resistors(&mut text, design);
    }
    for (board, core, _) in projects {
        match core {
            Core::System => steps(&mut text, design.machine, *board),
            Core::Link(_, line) => link_steps(&mut text, design, *board, (*core, *line)),
        }
    }
    if !projects.is_empty() {
        for (board, core, pins) in projects {
            pin_table(&mut text, design.machine, *board, *core, pins);
        }
        bus(&mut text, design);
    }
    text
}

fn contents(text: &mut String, design: &Design<'_>, projects: &[Project<'_>]) {
    let _ = write!(
        text,
        "\
# {machine}

Written by posicast {posicast}. Do not edit what is here: change the machine file and generate anew. `posicast generate` refuses
to overwrite a file that was edited, and names it.

| folder or file | what |
|---|---|
| `machine.toml` | the machine file that everything comes from |
| `rtl/` | Verilog-2001, one module per file |
| `filelist.f`, `{machine}.qip` | these files for simulators, and for Quartus |
",
        machine = design.machine,
        posicast = env!("CARGO_PKG_VERSION"),
    );
    if let Some(bus) = design.bus {
        let _ = writeln!(
            text,
            "| `rtl/*_{}.v` | what has registers, on {}: the top modules beside those on Avalon-MM; docs/{}.md |",
            bus.suffix(),
            bus.title(),
            bus.block()
        );
        text.push_str(match bus {
            BridgedBus::AxiLite => "| `amd/` | these modules as IP cores for Vivado, and block designs for a Zynq-7000 and a MicroBlaze |\n",
            BridgedBus::Wishbone { .. } => "| `litex/` | these modules for LiteX: a Python file with a class for each |\n",
        });
    }
    text.push_str(
        "| `vhdl/` | for a design in VHDL: per top module a package with its component, and an instance to copy |\n",
    );
    if let Some(InlineUnit { top, .. }) = &design.inline {
        let _ = writeln!(
            text,
            "| `rtl/{top}.v` | the inline shaper: between a controller's step pulses and the drives |"
        );
        text.push_str("| `docs/` | its page, and the datasheets of its blocks |\n");
    } else if design.units().next().is_none() {
        text.push_str(
            "| `kit/` | for a design of your own: template of an instance, strobe, example with bench, scripts for Lattice and AMD |\n\
             | `docs/` | the shaper's datasheet |\n",
        );
    }
    if let Some((top, bridge)) = &design.link {
        let what = if design.inline.is_some() {
            "the inline shaper"
        } else {
            "the stage"
        };
        let line = match bridge.config {
            BridgeConfig::Uart(config) => format!("{what} and its serial line of {} baud", config.baud()),
            BridgeConfig::Spi(config) => format!("{what} and its SPI lines, up to {} Hz", config.most_sck_hz()),
        };
        let _ = writeln!(
            text,
            "| `rtl/{top}.v` | a top module without a processor: {line}, which `posicast host` operates \
             (`docs/{block}.md`) |",
            block = bridge.config.block(),
        );
        if let Some(InlineUnit { top, .. }) = &design.inline {
            let _ = writeln!(
                text,
                "| `driver/` | C: the registers of the inline shaper, and functions for its state, counts and tables |\n\
                 | `docs/{top}.md`, `.rdl`, `.svd` | the registers as Markdown, SystemRDL and SVD |"
            );
        }
    }
    if design.units().next().is_some() {
        text.push_str("| `sopc/*_hw.tcl` | components for Platform Designer (Qsys) |\n");
    }
    if design.stage.is_some() {
        text.push_str(
            "| `sopc/*_system.tcl` | a system with a processor and the stage, for `qsys-script` |\n\
             | `sopc/quartus/BOARD/` | a Quartus project per board: top level, pins, timing |\n",
        );
    }
    let has_link = projects.is_empty() || projects.iter().any(|(_, core, _)| *core != Core::System);
    if let Some((_, bridge)) = design.link.as_ref().filter(|_| design.stage.is_some() && has_link) {
        let _ = writeln!(
            text,
            "| `sopc/quartus/BOARD_link/` | the same without a processor: {} |",
            bridge.line().of_stage()
        );
    }
    if design.units().next().is_some() {
        let _ = writeln!(
            text,
            "| `driver/` | C: headers of the registers; of a stage also the driver, for bare metal, HAL and Linux |\n\
             | `docs/` | the datasheets of the blocks; the registers as Markdown, SystemRDL and SVD |"
        );
    }
    let _ = writeln!(text, "| `{}.core` | the Verilog for FuseSoC |", design.machine);
    text.push_str(
        "| `report.json` | the design in numbers; after `posicast run` its whole report |\n\
         | `report.html`, `wave/`, `plots/` | after `posicast run`: the report to open in a browser, waveforms and pictures of its checks |\n\
         | `posicast.json` | which files are posicast's |\n\n\
         `wave/`, `plots/` and the report of a run are about the machine file and the Verilog here. Once either changes, \
         `posicast generate`\nremoves them and reports it.\n",
    );
}

fn inline(text: &mut String, unit: &InlineUnit) {
    let _ = write!(
        text,
        "\n## The inline shaper\n\n`docs/inline.md` says how to connect `{}`, what its pins do, and how to home and to probe.\n\n\
         | axis | command at most, steps/s | delay, ms | delay while bypassed, ms | at rest after the last step, ms |\n|---|---|---|---|---|\n",
        unit.top,
    );
    for axis in &unit.axes {
        let _ = writeln!(
            text,
            "| {} | {:.0} | {:.3} | {:.3} | {:.1} |",
            axis.name,
            axis.input_hz,
            axis.shaped_s * 1e3,
            axis.unshaped_s * 1e3,
            axis.settle_s * 1e3,
        );
    }
    text.push_str(
        "\nA controller that reads a switch or a probe in motion takes a position that lies ahead of the machine by speed times delay: home \
         and\nprobe with `bypass`, and leave room behind limit switches.\n",
    );
}

fn components(text: &mut String, design: &Design<'_>) {
    text.push_str("\n## Components\n\n| component | registers | what |\n|---|---|---|\n");
    for unit in design.units() {
        let _ = writeln!(
            text,
            "| `{}` | `{}` {}, {} bytes | {}{} |",
            unit.top,
            unit.component.name(),
            unit.version(),
            unit.span_bytes(),
            unit.component.map().about().lines().collect::<Vec<_>>().join(" "),
            unit.law().map_or_else(String::new, |law| format!(" This one: {law}.")),
        );
    }
    if let Some((_, bridge)) = &design.link {
        let line = match bridge.line() {
            Line::Uart => "the serial line",
            Line::Spi => "SPI",
        };
        let _ = writeln!(
            text,
            "| `{}` | none | The bridge of {line}, an Avalon-MM host: for a system in which a host at a line operates the stage beside a processor. \
             Put the stage at address 0 of its `avm`. |",
            bridge.name(design.machine)
        );
    }
    text.push_str(
        "\nEach has a clock, a reset that is synchronous at both edges, and conduits for its pins; with registers also an Avalon-MM agent without \
         wait states (read latency 1) and an interrupt.\nTheir parameters say what was built; they cannot be changed.\n",
    );
}

fn boards(text: &mut String, design: &Design<'_>) {
    text.push_str("\n## Boards\n\n| board | device | processor | memory | Quartus | |\n|---|---|---|---|---|---|\n");
    for board in Board::ALL {
        let facts = board.facts();
        let state = match (design.runs_on(board), design.board == Some(board)) {
            (true, true) => "the machine file's board".to_owned(),
            (true, false) => "the same machine on another board".to_owned(),
            (false, _) => format!(
                "no project: its oscillator has {} MHz, the machine's clock {} MHz, and there is no PLL here",
                facts.oscillator_hz / 1e6,
                design.clock_hz / 1e6
            ),
        };
        let processor = match facts.processor {
            Processor::Nios2 => "Nios II/e",
            Processor::NiosV => "Nios V/m",
        };
        let _ = writeln!(
            text,
            "| {} (`{board}`) | {} ({}) | {processor} | {} KiB on chip | {} | {state} |",
            facts.title,
            board.family().device().name,
            facts.quartus_family,
            facts.memory_bytes >> 10,
            facts.quartus,
        );
    }
    text.push_str(
        "\nThe versions do not mix: Cyclone II and this Nios II are not in 25.1std, Cyclone V projects with a Nios V not in 13.0sp1. \
         The components are the same for both.\n\nPosicast checks these files without Quartus: its commands, its fitter and its timing have the last word. Run \
         `posicast synth .` to estimate whether the stage fits (without the processor).\n",
    );
}

fn steps(text: &mut String, machine: &str, board: Board) {
    let facts = board.facts();
    let name = Core::System.project(machine, board);
    let system = system::name(machine, board);
    let shell = match facts.processor {
        Processor::Nios2 => "Nios II Command Shell",
        Processor::NiosV => "Nios V Command Shell",
    };
    let _ = write!(
        text,
        "
## {title}, step by step

With {quartus}, in its {shell}, from this folder:

1. Work on a copy: Quartus and you will both edit it.
   `PACKAGE=$PWD; cp -r sopc/quartus/{board} ../{name}; cd ../{name}`.
2. Build the system: `qsys-script --script=$PACKAGE/sopc/{system}.tcl \"--search-path=$PACKAGE/sopc,\\$\"`. This writes
   `{system}.qsys`.
",
        title = facts.title,
        quartus = facts.quartus,
    );
    text.push_str(&generate_step(board, &system));
    compile_steps(text, board, &name, 4);
    let _ = write!(
        text,
        "8. Software: {software}.
   `system.h` has the stage's facts as `STAGE_BASE`, `STAGE_IRQ`, `STAGE_MAGIC` and so on. The program is loaded over JTAG and is
   gone after power-off; for one that stays, switch `initMemContent` of the memory on and give it the program's `.hex`.
",
        software = software(facts.processor, &system),
    );
}

/// Pins, compilation, loading and a look at the gates, as the steps from `first` on.
fn compile_steps(text: &mut String, board: Board, name: &str, first: usize) {
    let facts = board.facts();
    let position = match facts.processor {
        Processor::Nios2 => "",
        // The hard processor is the first device of the JTAG chain.
        Processor::NiosV => "@2",
    };
    let steps = [
        format!("Set the pins in `{name}.qsf` to your wiring, and the delays in `{name}.sdc` to your drivers."),
        format!(
            "Compile: `quartus_sh --flow compile {name}`. Then read the timing report: no path may fail, and none be unconstrained but those
   of the JTAG pins."
        ),
        format!("With the power stage **off**, load it: `quartus_pgm -m jtag -o 'p;output_files/{name}.sof{position}'`."),
        format!(
            "Measure the gates: they must be at their off level before, while and after it is loaded, and while {key} is pressed.",
            key = facts.reset_pin.1
        ),
    ];
    for (number, step) in (first..).zip(steps) {
        let _ = writeln!(text, "{number}. {step}");
    }
}

/// The steps without Platform Designer.
fn link_steps(text: &mut String, design: &Design<'_>, board: Board, (core, line): (Core<'_>, Line)) {
    let facts = board.facts();
    let machine = design.machine;
    let name = core.project(machine, board);
    let _ = write!(
        text,
        "
## {title} without a processor, step by step

The top level has {what}, `{module}`, and no system. From this folder, with {quartus}:

1. Copy the project and the Verilog: `PACKAGE=$PWD; cp -r {folder} ../{name}; cp -r rtl {qip} ../{name}; cd ../{name}`.
",
        title = facts.title,
        quartus = facts.quartus,
        what = line.of_stage(),
        module = core.module(machine, board),
        folder = core.folder(board),
        qip = core.qip(machine, board),
    );
    compile_steps(text, board, &name, 2);
    text.push_str(match line {
        Line::Uart => {
            "6. Connect a USB adapter of 3.3 V to `uart_rxd` (its transmitter), `uart_txd` and ground. Then
   `posicast host /dev/ttyUSB0 status --machine $PACKAGE/machine.toml` shows the axes; `docs/uart_bridge.md` has the line.
"
        }
        Line::Spi => {
            "6. Connect the host's SPI of 3.3 V to `spi_sck`, `spi_cs_n`, `spi_mosi`, `spi_miso` and ground. Then
   `posicast host spi:///dev/spidev0.0 status --machine $PACKAGE/machine.toml` shows the axes; `docs/spi_bridge.md` has the lines.
"
        }
    });
}

/// The third step, which differs most between the versions.
fn generate_step(board: Board, system: &str) -> String {
    let search = "\"--search-path=$PACKAGE/sopc,\\$\"";
    match board.facts().processor {
        Processor::Nios2 => format!(
            "3. Generate it: `qsys-edit {system}.qsys {search}`, tab *Generation*, synthesis on, simulation off, *Generate*.
   Leave the output folder as it is offered: the project wants `{system}/synthesis/{system}.qip`.
"
        ),
        Processor::NiosV => format!(
            "3. Generate it: `qsys-generate {system}.qsys --synthesis=VERILOG --output-directory={system} {search}`.
   The project wants `{system}/synthesis/{system}.qip`.
"
        ),
    }
}

/// How to build software for the system.
fn software(processor: Processor, system: &str) -> String {
    match processor {
        Processor::Nios2 => format!(
            "`nios2-bsp hal bsp {system}.sopcinfo --set hal.enable_small_c_library true --set hal.enable_reduced_device_drivers true`
   (the memory is small), then your program with the driver's sources"
        ),
        Processor::NiosV => format!(
            "`niosv-bsp -c --type=hal --sopcinfo={system}.sopcinfo --bsp-dir=bsp --cpu-instance=cpu bsp/settings.bsp`, then your
   program with the driver's sources; its compiler is installed apart"
        ),
    }
}

fn resistors(text: &mut String, design: &Design<'_>) {
    let pulled_up = match design.active_low_axes.as_slice() {
        [] => "no axis of this machine".to_owned(),
        axes => axes.join(", "),
    };
    let host = match design.link.as_ref().map(|(_, bridge)| bridge.line()) {
        None => "",
        Some(Line::Uart) => {
            "- `uart_rxd` rests high: the project turns its weak pull-up on, for a host that is not connected.\n"
        }
        Some(Line::Spi) => {
            "- `spi_cs_n` rests high: the project turns its weak pull-up on, for a host that is not connected or off; 10 kΩ to 3.3 V outside are \
             safer. `spi_sck` needs 10 kΩ to ground.\n"
        }
    };
    let _ = write!(
        text,
        "
## Resistors outside: not optional

Until the device is configured, and where nothing uses a pin, all its pins are inputs with a weak pull-up: some 25 kΩ to 3.3 V,
in the worst case 7 kΩ. A gate driver takes that for *on*.

- Every gate pin needs a resistor outside that holds its **off** level: 1 kΩ to ground; to 3.3 V where `active_low` is set
  ({pulled_up}). The same for `drive_enable` and `brake_release`, to ground.
- Every line for which low is the safe side (`emergency_stop_n`, `limit_plus_n`, `limit_minus_n`, `drive_ready`, `drive_fault_n`,
  `fault_n`) needs 10 kΩ to ground, so that a broken wire reads as a fault. The project turns the weak pull-ups of inputs off.
{host}- A line that you leave open reads low through its resistor: the axis stays in FAULT. That is meant.
- The pins take 3.3 V. Encoders and switches of 5 V or 24 V need level shifters or optocouplers.
"
    );
}

fn pin_table(text: &mut String, machine: &str, board: Board, core: Core<'_>, pins: &[Pin]) {
    let facts = board.facts();
    let _ = write!(
        text,
        "
## Pins on the {title}{without}

Our choice, in the order of the expansion headers; the copied `{name}.qsf` is the one place to change it. Where a pin is on its
header is in the board's manual.

| port | | on the board | pin |
|---|---|---|---|
",
        title = facts.title,
        without = if core == Core::System { "" } else { " without a processor" },
        name = core.project(machine, board),
    );
    for pin in pins {
        let direction = if pin.is_input { "in" } else { "out" };
        let _ = writeln!(
            text,
            "| `{}` | {direction} | {} | {} |",
            pin.port, pin.on_board, pin.location
        );
    }
    let why = match (core, facts.uart_pins) {
        (Core::Link(_, Line::Spi), _) => return,
        (_, None) => "belongs to its hard processor",
        (Core::Link(_, Line::Uart), Some(_)) => "has an RS-232 driver, which is too slow for most baud rates",
        (Core::System, Some(_)) => return,
    };
    let _ = writeln!(
        text,
        "\nThe board's own serial line {why}, so the UART is on the header: 3.3 V, no RS-232 levels."
    );
}

fn bus(text: &mut String, design: &Design<'_>) {
    let span = design.stage.as_ref().map_or(0, Unit::span_bytes);
    let _ = write!(
        text,
        "
## Bus

The stage is at {base:#010x}, {span} bytes, interrupt 0; program and data are at 0. The host's UART has {baud} baud, 8 data bits, no
parity, one stop bit.
",
        base = system::STAGE_BASE,
        baud = system::BAUD,
    );
}
