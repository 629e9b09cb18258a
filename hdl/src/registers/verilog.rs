//! The body of a bank: offsets of the window, decoding of writes, one clocked block per register, and reads.

use super::blocks::{
    Flop, clocked, declare, flops, guarded, interrupt, register_block, shadow_flops, shadows, sticky_prefix,
};
use super::text::{bits, joined, part};
use crate::emit::Type;
use crate::emit::print::{self, Lines};
use posicast_blocks::registers::{Access, Field, FlagSource, Register, RegisterMap};
use posicast_blocks::{Direction, PortNote};

pub(super) fn body(map: &RegisterMap) -> String {
    let clock = ("input  wire", bits(1), "clk".to_owned());
    let groups = read_groups(map);
    let data = read_flops(groups.len());
    let ports = map.ports().iter().map(|port| {
        let keyword = match port.direction {
            Direction::Input => "input  wire",
            Direction::Output if data.len() > 1 && port.name == "avs_readdata" => "output wire",
            Direction::Output => "output reg ",
        };
        (keyword, Type::of(port), port.name.clone())
    });
    let list = print::noted_port_list(&[clock].into_iter().chain(ports).collect::<Vec<_>>(), &notes(map));
    let mut lines = Lines::default();
    lines.nest(list.trim_end(), "endmodule", |lines| {
        offsets(lines, map);
        lines.section(|lines| writes(lines, map));
        for register in map.registers() {
            lines.section(|lines| register_block(lines, map, register));
        }
        lines.section(|lines| shadows(lines, map));
        lines.section(|lines| interrupt(lines, map));
        lines.line("");
        reads(lines, &groups, &data);
        lines.line("");
        power_up(lines, map, &data);
        lines.section(|lines| unused(lines, map));
    });
    lines.text
}

/// Purposes of the ports: the meanings of the fields with their units, and the events that strobes report.
pub(super) fn notes(map: &RegisterMap) -> Vec<PortNote> {
    let note = |port: &str, text: String| PortNote {
        port: port.to_owned(),
        text,
    };
    let mut notes = Vec::new();
    for register in map.registers() {
        let word = register.name.to_uppercase();
        match &register.access {
            Access::Guarded { while_low } => notes.push(note(while_low, format!("High: writes of {word} are refused"))),
            Access::Commit { tick } => notes.push(note(tick, format!("Applies what {word} asked for"))),
            Access::Command { strobe } => notes.push(note(strobe, format!("{word} was written, in this clock"))),
            Access::Words {
                strobe, word: place, ..
            } => {
                notes.push(note(strobe, format!("A word of {word} was written, in this clock")));
                notes.push(note(place, format!("Index of that word of {word}")));
            }
            _ => {}
        }
        notes.extend(register.fields.iter().map(|field| match field.unit.as_str() {
            "" => note(&field.name, field.meaning.clone()),
            unit => note(&field.name, format!("{} [{unit}]", field.meaning)),
        }));
    }
    notes
}

/// The fields of a register and the gaps between them, from bit 31 down, each field with the name that `name` gives
/// it.
fn word(fields: &[Field], name: impl Fn(&Field) -> String) -> Vec<String> {
    let mut sorted: Vec<&Field> = fields.iter().collect();
    sorted.sort_by_key(|field| std::cmp::Reverse(field.low));
    let (mut pieces, mut next) = (Vec::new(), 32);
    let gap = |width: u32| (width > 0).then(|| format!("{width}'d0"));
    for field in sorted {
        pieces.extend(gap(next - field.low - field.width));
        pieces.push(name(field));
        next = field.low;
    }
    pieces.extend(gap(next));
    pieces
}

fn offsets(lines: &mut Lines, map: &RegisterMap) {
    let longest = map
        .registers()
        .iter()
        .map(|register| register.name.len())
        .max()
        .unwrap_or(0);
    let (width, high) = (map.address_bits(), map.address_bits() - 1);
    lines.line("// Word offsets of the registers.");
    for register in map.registers() {
        let name = register.name.to_uppercase();
        lines.line(&format!(
            "localparam [{high}:0] {name:longest$} = {width}'h{:02x};",
            register.offset
        ));
    }
}

/// Whether a write has an effect.
fn is_writable(register: &Register) -> bool {
    !matches!(register.access, Access::Constant | Access::Live | Access::Shadow { .. })
}

fn writables(map: &RegisterMap) -> impl Iterator<Item = &Register> {
    map.registers().iter().filter(|register| is_writable(register))
}

/// Whether the register uses the written word with the disabled bytes set to 0.
fn is_masked(register: &Register) -> bool {
    matches!(
        register.access,
        Access::Guarded { .. } | Access::Sticky | Access::InterruptState
    )
}

/// Mask of the bytes of a register that are written individually by `by_bytes`.
fn bytes_alone(register: &Register) -> u32 {
    if !matches!(
        register.access,
        Access::Configuration | Access::Staged | Access::InterruptEnable
    ) {
        return 0;
    }
    let reaches = |byte: &u32| register.mask() >> (8 * byte) & 0xff != 0;
    (0..4).filter(reaches).map(|byte| 1 << byte).sum()
}

fn takes_whole_words(map: &RegisterMap) -> bool {
    map.registers().iter().any(|register| register.access.whole_words())
}

fn writes(lines: &mut Lines, map: &RegisterMap) {
    if map.registers().iter().any(is_masked) {
        lines.line("// The enabled bits of a write, and the data with all other bits 0.");
        lines.line("wire [31:0] mask = {");
        lines
            .line("    {8{avs_byteenable[3]}}, {8{avs_byteenable[2]}}, {8{avs_byteenable[1]}}, {8{avs_byteenable[0]}}");
        lines.line("};");
        lines.line("wire [31:0] written = avs_writedata & mask;");
    }
    if takes_whole_words(map) {
        lines.line("wire whole = &avs_byteenable;");
    }
    lines.section(|lines| {
        if writables(map).next().is_some() {
            lines.line("// The register that is written in this clock.");
        }
        for register in writables(map) {
            let (name, constant) = (&register.name, register.name.to_uppercase());
            let (address, constant) = match register.words().trailing_zeros() {
                0 => ("avs_address".to_owned(), constant),
                low => {
                    let range = format!("[{}:{low}]", map.address_bits() - 1);
                    (format!("avs_address{range}"), format!("{constant}{range}"))
                }
            };
            lines.line(&format!("wire write_{name} = avs_write && {address} == {constant};"));
        }
    });
    lines.section(|lines| {
        for register in map.registers() {
            match &register.access {
                Access::Guarded { while_low } => guarded(lines, register, while_low),
                Access::Commit { tick } => {
                    declare(lines, &flops(register), "");
                    lines.line(&format!("wire applies = waits && {tick};"));
                }
                _ => {}
            }
        }
        refusals(lines, map);
    });
}

/// Whether a flag has this source.
fn is_flagged(map: &RegisterMap, source: FlagSource) -> bool {
    let flags = map.registers().iter().filter(|register| register.access.is_sticky());
    flags
        .flat_map(|register| &register.fields)
        .any(|field| field.source == source)
}

fn refusals(lines: &mut Lines, map: &RegisterMap) {
    let named = |holds: &dyn Fn(&Access) -> bool, text: &dyn Fn(&str) -> String| -> Vec<String> {
        let all = map.registers().iter().filter(|register| holds(&register.access));
        all.map(|register| text(&register.name)).collect()
    };
    if is_flagged(map, FlagSource::PartialWrite) {
        let terms = named(&Access::whole_words, &|name| format!("write_{name}"));
        if terms.is_empty() {
            lines.line("wire bus_partial = 1'd0;")
        } else {
            joined(lines, "wire bus_partial = !whole && (", &terms, " || ", ");")
        }
    }
    if is_flagged(map, FlagSource::GuardRefused) {
        let terms = named(&|access| matches!(access, Access::Guarded { .. }), &|name| {
            format!("(write_{name} && !allow_{name})")
        });
        if terms.is_empty() {
            lines.line("wire bus_refused = 1'd0;")
        } else {
            joined(lines, "wire bus_refused = ", &terms, " || ", ";")
        }
    }
    if is_flagged(map, FlagSource::CommitRejected) {
        let staged = named(&|access| *access == Access::Staged, &|name| format!("write_{name}"));
        let commit = named(&|access| matches!(access, Access::Commit { .. }), &|name| {
            format!("(write_{name} && whole)")
        });
        let terms = [commit, staged].concat();
        if terms.is_empty() {
            lines.line("wire bus_rejected = 1'd0;")
        } else {
            joined(lines, "wire bus_rejected = waits && (", &terms, " || ", ");")
        }
    }
}

/// Largest number of words in a read group: in a larger one the decode would be the longest path of a stage.
const GROUP_WORDS: usize = 16;

/// Registers that can be read, each with the pieces of its word.
type ReadGroup<'a> = Vec<(&'a Register, Vec<String>)>;

/// All readable registers, in groups of about the same size.
fn read_groups(map: &RegisterMap) -> Vec<ReadGroup<'_>> {
    let readable = |register| read_value(map, register).map(|value| (register, value));
    let all: Vec<_> = map.registers().iter().filter_map(readable).collect();
    let groups = all.len().div_ceil(GROUP_WORDS).max(1);
    let words = all.len().div_ceil(groups).max(1);
    all.chunks(words).map(<[_]>::to_vec).collect()
}

/// The registers after the decode, for this number of groups.
fn read_flops(groups: usize) -> Vec<Flop> {
    let name = |at: usize| match groups {
        1 => "avs_readdata".to_owned(),
        _ => format!("read_group_{at}"),
    };
    (0..groups).map(|at| (bits(32), name(at), 0)).collect()
}

fn reads(lines: &mut Lines, groups: &[ReadGroup<'_>], flops: &[Flop]) {
    if groups.len() > 1 {
        lines.line("// Each group of words has a read register, which is 0 if the address is in another group.");
        declare(lines, flops, "");
    }
    for (group, flop) in groups.iter().zip(flops) {
        clocked(lines, std::slice::from_ref(flop), "else if (avs_read)", |lines| {
            lines.nest("case (avs_address)", "endcase", |lines| {
                for (register, value) in group {
                    let begin = format!("{}: {} <= ", register.name.to_uppercase(), flop.1);
                    match value.as_slice() {
                        [whole] => lines.line(&format!("{begin}{whole};")),
                        pieces => joined(lines, &format!("{begin}{{"), pieces, ", ", "};"),
                    }
                }
                lines.line(&format!("default: {} <= 32'd0;", flop.1));
            });
        });
    }
    if groups.len() > 1 {
        let names: Vec<String> = flops.iter().map(|(_, name, _)| name.clone()).collect();
        joined(lines, "assign avs_readdata = ", &names, " | ", ";");
    }
}

fn read_value(map: &RegisterMap, register: &Register) -> Option<Vec<String>> {
    let named = |prefix: &'static str| {
        let fields = map.fields(register);
        Some(word(fields, |field| format!("{prefix}{}", field.name)))
    };
    match register.access {
        Access::Constant => Some(vec![format!("32'h{:08x}", register.reset())]),
        Access::Live | Access::Configuration | Access::Guarded { .. } => named(""),
        Access::Shadow { .. } => named("shadow_"),
        Access::Staged => named("staged_"),
        Access::Sticky | Access::InterruptState => named(sticky_prefix(register)),
        Access::InterruptEnable => named("irq_enable_"),
        Access::Commit { .. } => Some(vec!["31'd0".to_owned(), "waits".to_owned()]),
        Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => None,
    }
}

fn power_up(lines: &mut Lines, map: &RegisterMap, data: &[Flop]) {
    let mut all: Vec<Flop> = map.registers().iter().flat_map(flops).collect();
    all.extend(shadow_flops(map));
    all.extend_from_slice(data);
    if map.find(|access| *access == Access::InterruptState).is_some() {
        all.push((bits(1), "irq".to_owned(), 0));
    }
    lines.nest("initial begin", "end", |lines| {
        for (ty, name, reset) in &all {
            lines.line(&format!("{name} = {};", ty.literal((*reset).into())));
        }
    });
}

/// Reads the bits that nothing else reads, so that lint tools do not report them.
fn unused(lines: &mut Lines, map: &RegisterMap) {
    let fields_of = |holds: &dyn Fn(&Register) -> bool| {
        let registers = map.registers().iter().filter(|register| holds(register));
        registers.fold(0, |mask, register| mask | register.mask())
    };
    let masked = map.registers().iter().any(is_masked);
    let takes_data = |register: &Register| is_writable(register) && !matches!(register.access, Access::Commit { .. });
    let mut terms = Vec::new();
    if masked {
        terms.extend(runs("written", !fields_of(&is_masked)));
    } else {
        terms.extend(runs("avs_writedata", !fields_of(&takes_data)));
        if !takes_whole_words(map) {
            let alone = map
                .registers()
                .iter()
                .fold(0, |all, register| all | bytes_alone(register));
            terms.extend(runs("avs_byteenable", !alone & 0xf));
        }
    }
    if writables(map).next().is_none() {
        terms.push("avs_write".to_owned());
    }
    if !terms.is_empty() {
        lines.line("// Bits that are never read.");
        joined(lines, "wire unused = &{1'b0, ", &terms, ", ", "};");
    }
}

/// Slices of `word` where `mask` has ones.
fn runs(word: &str, mask: u32) -> Vec<String> {
    let (mut slices, mut low) = (Vec::new(), 0);
    while low < 32 {
        let width = (mask >> low).trailing_ones();
        if width == 0 {
            low += 1;
            continue;
        }
        slices.push(part(word, &Field::new("", low, width, "")));
        low += width;
    }
    slices
}
