//! The hardware of a machine as blocks with Verilog: the shapers of its top module, its components, its stage.

use crate::design::DesignReport;
use crate::failure::Failure;
use crate::machine::{at_key, of_hardware, place};
use crate::observer::Observer;
use crate::warning::Warning;
use posicast_blocks::component::Component;
use posicast_blocks::linked_stage::address_limit;
use posicast_blocks::stage::StageConfig;
use posicast_hdl::emit::{Module, add};
use posicast_hdl::machine::{AxisShaper, emit_machine};
use posicast_machine::hardware::{Hardware, HardwareError, InlineFigures, InlineHardware, MachineStage, NAME_KEY};
use posicast_machine::machine_file::{LinkLine, LinkSection, Machine};
use posicast_synth::sopc::{InlineUnit, InlineUnitAxis};
use posicast_testbench::blocks::Block;
use posicast_testbench::bus_component::BusComponentBlock;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::inline_shaper::InlineShaperBlock;
use posicast_testbench::linked_stage::LinkedStageBlock;
use std::path::Path;

/// Suffix of a component's top module.
pub(crate) const COMPONENT_SUFFIX: &str = "_avalon";
/// Suffix of a stage's top module.
pub(crate) const STAGE_SUFFIX: &str = "_stage";
/// Suffix of an inline shaper's top module.
pub(crate) const INLINE_SUFFIX: &str = "_inline";
/// Suffix of the top module with a stage and its line to a host.
pub(crate) const LINK_SUFFIX: &str = "_link";

/// Key of the bus of the registers.
const BUS_KEY: &str = "target.bus";

/// The hardware of a machine.
pub(crate) struct Built<'a> {
    machine: &'a Machine,
    /// The shaper of each axis in the top module.
    pub(crate) shapers: Vec<AxisShaper>,
    /// The blocks of the axes as components, ready for a system with a processor. Their top modules are
    /// `<machine>_<axis>_<block>_avalon`.
    pub(crate) components: Vec<ComponentBlock>,
    /// All axes behind one agent, if every loop is complete.
    pub(crate) stage: Option<Stage>,
    /// The stage or the inline shaper with its line to a host, if the machine file has one. Its top module is `<machine>_link`.
    pub(crate) link: Option<LinkedStageBlock>,
    /// The inline shaper, if the commands come as step pulses and there is no line to a host. Its top module is `<machine>_inline`.
    pub(crate) inline: Option<InlineShaperBlock>,
    /// The inline shaper behind registers, if there is a line to a host. Its top module is `<machine>_inline`.
    pub(crate) inline_registers: Option<ComponentBlock>,
    /// The figures of its axes.
    inline_figures: Vec<InlineFigures>,
    /// The components, the stage or the inline shaper on another bus than Avalon-MM, if the machine file asks for it. Their top
    /// modules have the name of the bus in place of `avalon`, or behind that of the stage.
    pub(crate) buses: Vec<BusComponentBlock>,
}

/// A stage: its settings from the machine file, and its hardware.
pub(crate) struct Stage {
    /// Its settings, with the figures derived from them.
    pub(crate) of_machine: MachineStage,
    /// Its top module is `<machine>_stage`.
    pub(crate) block: ComponentBlock,
}

/// The shaper of each axis in the top module of the machine that the file at `path` describes.
pub(crate) fn shapers(machine: &Machine, hardware: &Hardware<'_>, path: &Path) -> Result<Vec<AxisShaper>, Failure> {
    let configs = hardware.shapers().map_err(|error| of_hardware(&error, path))?;
    let shapers = machine.axes.iter().zip(configs);
    let shapers = shapers.map(|(axis, config)| AxisShaper {
        axis: axis.name.clone(),
        config,
    });
    Ok(shapers.collect())
}

impl<'a> Built<'a> {
    /// The hardware of a report's machine, which the file at `path` describes. If the shapers do not suit a stage,
    /// there is none, and a warning is given.
    pub(crate) fn new(report: &DesignReport<'a>, path: &Path, observer: &dyn Observer) -> Result<Self, Failure> {
        let (machine, hardware) = (report.machine, &report.hardware);
        let refused = |error: HardwareError| of_hardware(&error, path);
        let shapers = shapers(machine, hardware, path)?;
        let components = hardware.components().map_err(refused)?.into_iter().map(|one| {
            let axis = &machine.axes[one.axis].name;
            let top = format!("{}_{axis}_{}{COMPONENT_SUFFIX}", machine.name, one.component.name());
            ComponentBlock::new(one.component, &top, axis).with_prefix(&format!("{}_{axis}", machine.name))
        });
        if let Some(reason) = hardware.without_stage() {
            let text = format!("no stage is built; its blocks become separate components: {reason}");
            Warning::new(reason.axis, reason.key.as_str(), text).tell(path, observer);
        }
        let stage = hardware.stage().map_err(refused)?.map(|stage| {
            let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
            let top = format!("{}{STAGE_SUFFIX}", machine.name);
            Stage {
                of_machine: stage.of_machine.clone(),
                block: ComponentBlock::new(stage.component.clone(), &top, &axes.join(", ")).with_prefix(&machine.name),
            }
        });
        let inline = hardware.inline().map_err(refused)?;
        let inline_figures = inline.map_or_else(Vec::new, |inline| inline.axes.clone());
        let inline_top = format!("{}{INLINE_SUFFIX}", machine.name);
        let inline_registers = inline.and_then(|inline| inline.component.clone()).map(|component| {
            let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
            ComponentBlock::new(component, &inline_top, &axes.join(", ")).with_prefix(&machine.name)
        });
        let link = match (&machine.link, &stage, inline) {
            (None, ..) => None,
            (Some(link), Some(stage), _) => Some(linked(machine, link, stage, path)?),
            (Some(link), None, Some(inline)) => Some(linked_inline(machine, link, (inline, &inline_top), path)?),
            (Some(link), None, None) => {
                let reason =
                    "a line needs the stage, but no stage is built; remove [link], or change what the warning names";
                return Err(at_key(path, 0, link_key(link), reason));
            }
        };
        let components: Vec<ComponentBlock> = components.collect();
        let registers = components.iter().chain(inline_registers.as_ref());
        let buses = on_bus(machine, registers, stage.as_ref(), path)?;
        let inline = inline.filter(|inline| inline.component.is_none());
        let inline = inline.map(|inline| InlineShaperBlock::new(inline.shaper.clone(), &inline_top, &machine.name));
        Ok(Self {
            machine,
            shapers,
            components,
            stage,
            link,
            inline,
            inline_registers,
            inline_figures,
            buses,
        })
    }

    /// Name of the inline shaper's top module, if there is one.
    pub(crate) fn inline_top(&self) -> Option<String> {
        let with_registers = self.inline_registers.as_ref().map(Block::top);
        self.inline.as_ref().map(Block::top).or(with_registers)
    }

    /// The inline shaper as the README tells its user.
    pub(crate) fn inline_unit(&self) -> Option<InlineUnit> {
        let axes = self.machine.axes.iter().zip(&self.inline_figures);
        let axes = axes.map(|(axis, figures)| InlineUnitAxis {
            name: axis.name.clone(),
            input_hz: figures.input_hz,
            shaped_s: figures.shaped_s,
            unshaped_s: figures.unshaped_s,
            settle_s: figures.settle_s,
        });
        self.inline_top().map(|top| InlineUnit {
            top,
            axes: axes.collect(),
        })
    }

    /// The Verilog modules without duplicates: those of the machine's top, then those of its components, of its stage,
    /// of its inline shaper, of its line, and of its bus. `path` is the machine file.
    pub(crate) fn modules(&self, path: &Path) -> Result<Vec<Module>, Failure> {
        let mut modules = emit_machine(&self.machine.name, &self.shapers).map_err(Failure::because)?;
        for component in &self.components {
            add(&mut modules, component.modules().map_err(Failure::because)?).map_err(Failure::because)?;
        }
        if let Some(stage) = &self.stage {
            add(&mut modules, stage.modules(path)?).map_err(Failure::because)?;
        }
        let without = self.inline.as_ref().map(|inline| inline as &dyn Block);
        let with = self.inline_registers.as_ref().map(|inline| inline as &dyn Block);
        if let Some(inline) = without.or(with) {
            let of_inline = inline
                .modules()
                .map_err(|error| at_key(path, 0, NAME_KEY, format_args!("{error}; rename an axis")))?;
            add(&mut modules, of_inline).map_err(Failure::because)?;
        }
        if let Some(link) = &self.link {
            add(&mut modules, link.modules().map_err(Failure::because)?).map_err(Failure::because)?;
        }
        for bus in &self.buses {
            add(&mut modules, bus.modules().map_err(Failure::because)?).map_err(Failure::because)?;
        }
        Ok(modules)
    }
}

/// What has registers, on the bus of the machine file.
fn on_bus<'b>(
    machine: &Machine,
    components: impl Iterator<Item = &'b ComponentBlock>,
    stage: Option<&Stage>,
    path: &Path,
) -> Result<Vec<BusComponentBlock>, Failure> {
    let Some(bus) = machine.target.as_ref().and_then(|target| target.bus) else {
        return Ok(Vec::new());
    };
    let block = |of: &ComponentBlock, axes: &[String]| {
        let inner = of.top();
        let top = inner.strip_suffix(COMPONENT_SUFFIX).unwrap_or(&inner);
        let top = format!("{top}_{}", bus.suffix());
        BusComponentBlock::new(of.component().clone(), bus, axes, [&top, &inner, of.prefix()])
    };
    let mut buses: Vec<BusComponentBlock> = components.map(|of| block(of, &[])).collect();
    let axes: Vec<String> = machine.axes.iter().map(|axis| axis.name.clone()).collect();
    buses.extend(stage.map(|stage| block(&stage.block, &axes)));
    if buses.is_empty() {
        let reason = format!("nothing in this machine has registers that {} could reach", bus.title());
        return Err(Failure::input(place(path, 0, BUS_KEY, reason)).with_help(
            "give the axes an encoder, a PWM, a controller or steps, or an inline shaper a table [link]; or remove `bus`",
        ));
    }
    Ok(buses)
}

/// The key of the line's speed.
fn link_key(link: &LinkSection) -> &'static str {
    match link.line {
        LinkLine::Uart { .. } => "link.baud",
        LinkLine::Spi { .. } => "link.sck_hz",
    }
}

/// The inline shaper of a machine with its line; its module is called `inline_top`.
fn linked_inline(
    machine: &Machine,
    link: &LinkSection,
    (inline, inline_top): (&InlineHardware, &str),
    path: &Path,
) -> Result<LinkedStageBlock, Failure> {
    let words = inline.component.as_ref().map_or(0, address_limit);
    let config = link.bridge(&machine.clock, words);
    let config = config.map_err(|error| at_key(path, 0, link_key(link), error))?;
    let top = format!("{}{LINK_SUFFIX}", machine.name);
    let line = (config, machine.clock.frequency_hz);
    let shaper = (inline.shaper.config(), Some(link.machine_crc));
    LinkedStageBlock::of_inline(shaper, line, [&top, inline_top, &machine.name]).map_err(Failure::because)
}

/// The stage of a machine with its line.
fn linked(machine: &Machine, link: &LinkSection, stage: &Stage, path: &Path) -> Result<LinkedStageBlock, Failure> {
    let config = link.bridge(&machine.clock, address_limit(stage.block.component()));
    let config = config.map_err(|error| at_key(path, 0, link_key(link), error))?;
    let top = format!("{}{LINK_SUFFIX}", machine.name);
    let names = [top.as_str(), &stage.block.top(), &machine.name];
    let line = (config, machine.clock.frequency_hz);
    LinkedStageBlock::new(&stage.of_machine.config, line, names).map_err(Failure::because)
}

impl Stage {
    /// Its Verilog modules. If two modules would get the same name from the axis names, this is an error of the machine
    /// file at `path`.
    fn modules(&self, path: &Path) -> Result<Vec<Module>, Failure> {
        self.block.modules().map_err(|error| {
            let modules = |config: &StageConfig| {
                let component = Component::stage(config).ok()?;
                self.block.like(component).modules().ok()
            };
            let axis = self.of_machine.clashing_axis(|config| modules(config).is_some());
            at_key(path, axis, NAME_KEY, format_args!("{error}; rename the axis"))
        })
    }
}
