//! Mutants of a stage's description: each constant from the machine file, and each wire between two blocks.
//!
//! ```text
//! composition of the stage and of each axis ─► every input of every part ─┬─ tied: the constant + 1, − 1
//!                                                                         ├─ on a net: another net of its width, beside it
//!                                                                         └─ on a net of an axis: the same net of another axis
//!   ─► one Verilog, in which `mutsel` chooses the mutant ─► Verilator, short ticks, the stimuli of the stage's row ─► found, or not
//! ```
//!
//! The list is made from the parts and connections of the description, not by hand. Many nets have the same width; the seed
//! chooses the one that replaces a net. A mutant that is not found is reported with the number of clocks in which the two wires
//! differed: 0 means that the run cannot distinguish them.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use posicast_blocks::ClockedBlock;
use posicast_blocks::component::ComponentPart;
use posicast_blocks::composition::{Composition, Connection};
use posicast_blocks::stage::StageConfig;
use posicast_blocks::{Direction, Port};
use posicast_hdl::emit::Module;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::MutationOptions;
use super::netlist::{SELECT, SELECT_BITS};
use super::simulation::{self, Kill};
use crate::page::Marks;
use posicast_testbench::Error;
use posicast_testbench::blocks::Block;
use posicast_testbench::stage::{ShortTicksBlock, StageBlock};

/// Marks of the table of these mutants of the XY stage.
pub const WIRES_MARKS: Marks = Marks {
    begin: "<!-- wires of the stage: written by the example `mutate` -->",
    end: "<!-- end of wires of the stage -->",
};

/// Marks of the table of these mutants of the printer's stage.
pub const STEPS_WIRES_MARKS: Marks = Marks {
    begin: "<!-- wires of a stage with steps: written by the example `mutate` -->",
    end: "<!-- end of wires of a stage with steps -->",
};

/// Kind of connection that a mutant changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WireKind {
    /// A constant, by one.
    Constant,
    /// A wire, exchanged with another one of its width beside it.
    Beside,
    /// A wire of an axis, exchanged with the same of another axis.
    OtherAxis,
}

impl WireKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Constant, Self::Beside, Self::OtherAxis];

    /// Name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant ± 1",
            Self::Beside => "another wire of its width",
            Self::OtherAxis => "the same wire of the other axis",
        }
    }
}

/// A changed connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WireMutant {
    /// Kind of the changed connection.
    pub kind: WireKind,
    /// Axis whose blocks it joins; empty for the stage's own level.
    pub axis: String,
    /// Part and port whose connection changes.
    pub port: [String; 2],
    /// The original net or constant.
    pub from: String,
    /// The net or constant that replaces it.
    pub to: String,
}

impl WireMutant {
    /// Replaces the wire `from` by `to` at a port of a part, in the blocks of `axis` or, if `axis` is empty, of the stage.
    pub fn exchange(axis: &str, [part, port]: [&str; 2], from: &str, to: &str) -> Self {
        Self {
            kind: WireKind::Beside,
            axis: axis.to_owned(),
            port: [part, port].map(str::to_owned),
            from: from.to_owned(),
            to: to.to_owned(),
        }
    }

    /// Name of the module that joins the blocks, in a stage with this top.
    fn module(&self, top: &str) -> String {
        match self.axis.as_str() {
            "" => top.to_owned(),
            axis => format!("{top}_{axis}"),
        }
    }

    /// Describes the place and the change.
    pub fn describe(&self) -> String {
        let axis = if self.axis.is_empty() {
            String::new()
        } else {
            format!("{}: ", self.axis)
        };
        let [part, port] = &self.port;
        format!("{axis}`{part}.{port}` on `{}` in place of `{}`", self.to, self.from)
    }
}

/// A mutant with its first wrong clock, or a reason why it was not found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WireFate {
    /// The mutant.
    pub mutant: WireMutant,
    /// First wrong clock.
    pub kill: Option<Kill>,
    /// For a wire that was not found: the number of clocks in which both wires differed.
    pub differed: Option<u64>,
}

/// Lists all mutants of the stage's description; `seed` chooses among the wires of a width.
fn list(block: &StageBlock, seed: u64) -> Vec<WireMutant> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let component = block.component();
    let axes: Vec<&str> = block.axes().iter().map(String::as_str).collect();
    let mut mutants = mutants_of_level(component.composition(), "", &axes, &mut rng);
    for part in component.blocks() {
        if let ComponentPart::Joined(axis) = part {
            mutants.extend(mutants_of_level(axis.composition(), axis.name(), &[], &mut rng));
        }
    }
    mutants
}

fn mutants_of_level(
    composition: &Composition,
    axis: &str,
    axes: &[&str],
    rng: &mut Xoshiro256PlusPlus,
) -> Vec<WireMutant> {
    let nets = composition.nets();
    let mut mutants = Vec::new();
    let parts = composition.parts().iter().zip(composition.connections());
    for (part, connections) in parts {
        for (port, connection) in part.ports().iter().zip(connections) {
            if port.direction == Direction::Output {
                continue;
            }
            let mut add = |kind, from: String, to: String| {
                mutants.push(WireMutant {
                    kind,
                    axis: axis.to_owned(),
                    port: [part.name().to_owned(), port.name.clone()],
                    from,
                    to,
                });
            };
            match connection {
                Connection::Tied(value) => {
                    let ones = u64::MAX >> (64 - port.width.clamp(1, 64));
                    let beside = [value.wrapping_add(1) & ones, value.wrapping_sub(1) & ones];
                    let count = if port.width == 1 { 1 } else { 2 };
                    for to in &beside[..count] {
                        add(WireKind::Constant, literal(port, *value), literal(port, *to));
                    }
                }
                Connection::Net(net) => {
                    let name = &nets[*net].port.name;
                    let fits = |other: &&str| {
                        let same = nets.iter().find(|net| net.port.name == **other);
                        *other != name && same.is_some_and(|net| net.port.width == port.width)
                    };
                    let others: Vec<&str> = nets
                        .iter()
                        .map(|net| net.port.name.as_str())
                        .filter(|other| fits(other))
                        .collect();
                    if !others.is_empty() {
                        let other = others[rng.random_range(0..others.len())];
                        add(WireKind::Beside, name.clone(), other.to_owned());
                    }
                    let own = axes.iter().position(|axis| name.starts_with(&format!("{axis}_")));
                    if let Some(own) = own.filter(|_| axes.len() > 1) {
                        let next = axes[(own + 1) % axes.len()];
                        let other = format!("{next}{}", &name[axes[own].len()..]);
                        if fits(&other.as_str()) {
                            add(WireKind::OtherAxis, name.clone(), other);
                        }
                    }
                }
            }
        }
    }
    mutants
}

fn literal(port: &Port, value: u64) -> String {
    format!("{}'d{value}", port.width)
}

/// Returns the modules of a stage, the top last, with all mutants in them: an input `SELECT` of the top and of each axis chooses one,
/// from 1 on; 0 is the stage itself.
///
/// # Errors
/// [`Error::Unlike`] where the modules do not have a connection that a mutant changes.
pub fn with_wires(modules: &[Module], mutants: &[WireMutant]) -> Result<Vec<Module>, Error> {
    let top = modules.last().map_or("", |module| module.name.as_str());
    let mut places: Places<'_> = BTreeMap::new();
    for (at, mutant) in mutants.iter().enumerate() {
        let [part, port] = &mutant.port;
        let ports = places.entry(mutant.module(top)).or_default().entry(part).or_default();
        ports.entry(port).or_default().push((at + 1, mutant));
    }
    let selects: Vec<String> = places.keys().cloned().chain([top.to_owned()]).collect();
    let changed = modules.iter().map(|module| -> Result<Module, Error> {
        if !selects.contains(&module.name) {
            return Ok(module.clone());
        }
        let text = changed(module, places.get(&module.name), &selects)?;
        let mut ports = module.ports.clone();
        let select = Port {
            name: SELECT.to_owned(),
            direction: Direction::Input,
            width: SELECT_BITS,
            signed: false,
        };
        ports.push(select);
        Ok(Module {
            text,
            ports,
            ..module.clone()
        })
    });
    changed.collect()
}

/// The mutants of each module, part and port, with their numbers.
type Places<'a> = BTreeMap<String, PlacesInAModule<'a>>;
/// The same of one module.
type PlacesInAModule<'a> = BTreeMap<&'a str, BTreeMap<&'a str, Vec<(usize, &'a WireMutant)>>>;

/// The text of a module that joins others, with its mutants; `selects` are the modules with an input that chooses one.
fn changed(module: &Module, parts: Option<&PlacesInAModule<'_>>, selects: &[String]) -> Result<String, Error> {
    let mut text = String::new();
    let (mut part, mut found) = (String::new(), 0);
    for line in module.text.lines() {
        let words = line.trim();
        let head = words.strip_suffix(" (").and_then(|head| head.split_once(" u_"));
        let chosen = parts.and_then(|parts| parts.get(part.as_str())).and_then(|ports| {
            let port = words.strip_prefix('.')?.split([' ', '(']).next()?;
            let here = ports.get(port)?;
            let (net, end) = words.split_once('(')?.1.rsplit_once(')')?;
            let chosen = here.iter().fold(net.to_owned(), |net, (number, mutant)| {
                format!("({SELECT} == {SELECT_BITS}'d{number}) ? {} : {net}", mutant.to)
            });
            Some(format!("        .{port}({chosen}){end}"))
        });
        found += usize::from(chosen.is_some());
        text += chosen.as_deref().unwrap_or(line);
        text.push('\n');
        if words == format!("module {} (", module.name) {
            // Writing to a `String` cannot fail.
            let _ = writeln!(text, "    input  wire [{}:0] {SELECT},", SELECT_BITS - 1);
        } else if let Some((of, name)) = head {
            name.clone_into(&mut part);
            if selects.iter().any(|select| select == of) {
                let _ = writeln!(text, "        .{SELECT}({SELECT}),");
            }
        } else if words == ");" {
            part.clear();
        }
    }
    let expected = parts.map_or(0, |parts| parts.values().map(BTreeMap::len).sum());
    if found != expected {
        return Err(Error::Unlike(format!(
            "`{}`: {found} of {expected} connections of the description are in its text",
            module.name
        )));
    }
    Ok(text)
}

/// Puts all mutants of a machine's stage into its Verilog with short ticks, and looks for them with the stimuli of that row. At most
/// `most` are taken, by the seed. Returns how many there are, too. Files are in `folder`.
///
/// # Errors
/// [`Error::Option`] where the stage's ticks cannot be shortened; else as [`super::run`].
pub fn wires(
    config: &StageConfig,
    top: &str,
    most: usize,
    options: &MutationOptions,
    folder: &Path,
) -> Result<(usize, Vec<WireFate>), Error> {
    let short = shortened(config, top)?;
    let mut mutants = list(short.stage(), options.seed);
    let all = mutants.len();
    if most < all {
        mutants.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(options.seed));
        mutants.truncate(most);
    }
    Ok((all, look_for(short.stage(), mutants, options, folder)?))
}

/// Looks for these mutants alone, as [`wires`] does.
///
/// # Errors
/// As [`wires`], and [`Error::Unlike`] where the stage does not have a connection that a mutant changes.
pub fn hunt_wires(
    config: &StageConfig,
    top: &str,
    mutants: Vec<WireMutant>,
    options: &MutationOptions,
    folder: &Path,
) -> Result<Vec<WireFate>, Error> {
    look_for(shortened(config, top)?.stage(), mutants, options, folder)
}

fn shortened(config: &StageConfig, top: &str) -> Result<ShortTicksBlock, Error> {
    let short = ShortTicksBlock::new(config, top).map_err(|error| Error::Option(error.to_string()))?;
    short.ok_or_else(|| Error::Option("the ticks of this stage cannot be shorter".to_owned()))
}

fn look_for(
    block: &StageBlock,
    mutants: Vec<WireMutant>,
    options: &MutationOptions,
    folder: &Path,
) -> Result<Vec<WireFate>, Error> {
    std::fs::create_dir_all(folder).map_err(Error::file(folder, "create"))?;
    let file = folder.join("wires.v");
    let modules = with_wires(&block.modules()?, &mutants)?;
    let text: String = modules.iter().map(|module| module.text.as_str()).collect();
    std::fs::write(&file, text).map_err(Error::file(&file, "write"))?;
    let kills = simulation::run(block, &file, mutants.len(), options, &mut |clocks, seed| {
        block.stimuli(clocks, seed)
    })?;
    let differed = differences(block, &mutants, &kills, options)?;
    let fates = mutants.into_iter().zip(kills).zip(differed);
    Ok(fates
        .map(|((mutant, kill), differed)| WireFate { mutant, kill, differed })
        .collect())
}

/// Returns, for each mutated wire that was not found, the number of clocks in which it and its replacement had different values.
fn differences(
    block: &StageBlock,
    mutants: &[WireMutant],
    kills: &[Option<Kill>],
    options: &MutationOptions,
) -> Result<Vec<Option<u64>>, Error> {
    let model = block.component().model(1);
    let net = |mutant: &WireMutant, name: &str| match mutant.axis.as_str() {
        "" => model.net(name),
        axis => model.net(&format!("{axis}_{name}")).or_else(|| model.net(name)),
    };
    let pairs: Vec<Option<[usize; 2]>> = (mutants.iter().zip(kills))
        .map(|(mutant, kill)| {
            let wire = kill.is_none() && mutant.kind != WireKind::Constant;
            let nets = wire
                .then(|| net(mutant, &mutant.from).zip(net(mutant, &mutant.to)))
                .flatten();
            nets.map(|(from, to)| [from, to])
        })
        .collect();
    let mut counts: Vec<Option<u64>> = pairs.iter().map(|pair| pair.map(|_| 0)).collect();
    if counts.iter().all(Option::is_none) {
        return Ok(counts);
    }
    let mut model = block.component().model(1);
    let of = |direction| model.ports().iter().filter(move |port| port.direction == direction);
    let masks: Vec<u64> = of(Direction::Input).map(|port| u64::MAX >> (64 - port.width)).collect();
    let (mut inputs, mut outputs) = (vec![0; masks.len()], vec![0; of(Direction::Output).count()]);
    let mut stimuli = block.stimuli(options.clocks, 1);
    for clock in 0..options.clocks {
        stimuli.fill(&outputs, &mut inputs);
        inputs.iter_mut().zip(&masks).for_each(|(input, mask)| *input &= mask);
        model
            .step(&inputs, &mut outputs)
            .map_err(|source| Error::Step { clock, source })?;
        for (count, pair) in counts.iter_mut().zip(&pairs) {
            if let (Some(count), Some([from, to])) = (count, pair) {
                *count += u64::from(model.value(*from) != model.value(*to));
            }
        }
    }
    Ok(counts)
}

/// The score by kind, and what was not found with its reason; `stage` names it in the table.
pub fn wires_table(stage: &str, all: usize, fates: &[WireFate], clocks: u64) -> String {
    let mut text = format!(
        "{} of {all} mutants of the description, {clocks} clocks with short ticks.\n\n| block | kind | mutants | found | not found |\n|---|---|---|---|---|\n",
        fates.len()
    );
    for kind in WireKind::ALL {
        let of_kind = || fates.iter().filter(|fate| fate.mutant.kind == kind);
        let found = of_kind().filter(|fate| fate.kill.is_some()).count();
        // Writing to a `String` cannot fail.
        let _ = writeln!(
            text,
            "| {stage} | {} | {} | {found} | {} |",
            kind.name(),
            of_kind().count(),
            of_kind().count() - found
        );
    }
    let unseen: Vec<&WireFate> = fates.iter().filter(|fate| fate.kill.is_none()).collect();
    let (equal, rest): (Vec<&WireFate>, Vec<&WireFate>) = unseen.into_iter().partition(|fate| fate.differed == Some(0));
    let mut section = |head: &str, fates: &[&WireFate]| {
        if !fates.is_empty() {
            let _ = writeln!(text, "\n{head}:\n");
            for fate in fates {
                let clocks = fate
                    .differed
                    .map_or(String::new(), |clocks| format!(", {clocks} clocks"));
                let _ = writeln!(text, "- {}{clocks}", fate.mutant.describe());
            }
        }
    };
    section(
        "Not found, because both wires were equal in every clock of the run",
        &equal,
    );
    let (constants, wires): (Vec<&WireFate>, Vec<&WireFate>) = rest
        .into_iter()
        .partition(|fate| fate.mutant.kind == WireKind::Constant);
    section("Not found, a constant", &constants);
    section(
        "Not found, although the wires differed in so many clocks: bus and pins show nothing of it",
        &wires,
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_testbench::stage::StageBlock;

    /// Every input of every block of both axes is in the list, and every mutant is in the text.
    #[test]
    fn the_list_has_every_constant_and_wire_of_the_description() {
        let config = posicast_testbench::blocks::library_sizes()
            .unwrap()
            .stages
            .swap_remove(0);
        let block = StageBlock::new(&config, "stage").unwrap();
        let mutants = list(&block, 1);
        for axis in ["x", "y"] {
            let of = |kind: WireKind, from: &str| {
                let mut found = mutants
                    .iter()
                    .filter(|mutant| mutant.axis == axis && mutant.kind == kind);
                found.any(|mutant| mutant.from == from)
            };
            assert!(
                of(WireKind::Beside, "shaped_position") && of(WireKind::Beside, "clear_sources"),
                "{axis}"
            );
            // The timeout of the velocity, and the PWM's watchdog.
            assert!(of(WireKind::Constant, "8'd76"), "{axis}");
        }
        let other = |from: &str, to: &str| mutants.iter().any(|mutant| mutant.from == from && mutant.to == to);
        assert!(other("y_clear_faults", "x_clear_faults") && other("x_quotient_valid", "y_quotient_valid"));
        let modules = with_wires(&block.modules().unwrap(), &mutants).unwrap();
        let text: String = modules.iter().map(|module| module.text.as_str()).collect();
        for number in 1..=mutants.len() {
            assert_eq!(
                text.matches(&format!("{SELECT} == 16'd{number})")).count(),
                1,
                "{number}"
            );
        }
        assert!(mutants.len() > 800, "{}", mutants.len());
    }
}
