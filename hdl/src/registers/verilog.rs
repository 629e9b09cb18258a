//! The body of a bank: words of the window, what is written, one clocked block per register, what is read.

use crate::emit::Type;
use crate::emit::print::{self, Lines};
use posicast_model::rtl::Direction;
use posicast_model::rtl::registers::{Access, Field, Register, RegisterMap, Source};

/// Longest line.
const COLUMNS: usize = 116;

/// A flip-flop of the bank: type, name, reset value.
type Flop = (Type, String, u32);

pub(super) fn body(map: &RegisterMap) -> String {
    let clock = ("input  wire", bits(1), "clk".to_owned());
    let ports = map.ports().iter().map(|port| {
        let keyword = match port.direction {
            Direction::Input => "input  wire",
            // All outputs are registers.
            Direction::Output => "output reg ",
        };
        let ty = Type {
            width: port.width,
            signed: port.signed,
        };
        (keyword, ty, port.name.clone())
    });
    let list = print::port_list(&[clock].into_iter().chain(ports).collect::<Vec<_>>());
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
        reads(lines, map);
        lines.line("");
        power_up(lines, map);
        lines.section(|lines| unused(lines, map));
    });
    lines.text
}

fn bits(width: u32) -> Type {
    Type { width, signed: false }
}

fn type_of(field: &Field) -> Type {
    Type {
        width: field.width,
        signed: field.is_signed(),
    }
}

/// `name[7:0]` of a word, `name[3]`, or the whole.
fn part(word: &str, field: &Field) -> String {
    match (field.low, field.width) {
        (0, 32) => word.to_owned(),
        (low, 1) => format!("{word}[{low}]"),
        (low, width) => format!("{word}[{}:{low}]", low + width - 1),
    }
}

/// The fields of a register in 32 bits, each as `name` calls it.
fn word(fields: &[Field], name: impl Fn(&Field) -> String) -> String {
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
    match pieces.as_slice() {
        [one] => one.clone(),
        _ => format!("{{{}}}", pieces.join(", ")),
    }
}

/// `old`, with the bytes that are written taken from the bus.
fn merged(field: &Field, old: &str) -> String {
    let (data, mask) = (part("avs_writedata", field), part("mask", field));
    format!("({data} & {mask}) | ({old} & ~{mask})")
}

/// `begin`, then the terms with the operator between them, over as many lines as they need.
fn joined(lines: &mut Lines, begin: &str, terms: &[String], operator: &str, end: &str) {
    let mut line = begin.to_owned();
    for (at, term) in terms.iter().enumerate() {
        let separator = if at == 0 { "" } else { operator };
        if line.len() + separator.len() + term.len() + end.len() > COLUMNS {
            lines.line(line.trim_end());
            line = format!("    {}", separator.trim_start());
        } else {
            line.push_str(separator);
        }
        line.push_str(term);
    }
    lines.line(&format!("{line}{end}"));
}

fn offsets(lines: &mut Lines, map: &RegisterMap) {
    let longest = map
        .registers()
        .iter()
        .map(|register| register.name.len())
        .max()
        .unwrap_or(0);
    lines.line("// Words of the window.");
    for register in map.registers() {
        let name = register.name.to_uppercase();
        lines.line(&format!(
            "localparam [7:0] {name:longest$} = 8'h{:02x};",
            register.offset
        ));
    }
}

/// Does a write do anything?
fn is_writable(register: &Register) -> bool {
    !matches!(register.access, Access::Constant | Access::Live | Access::Shadow { .. })
}

fn writables(map: &RegisterMap) -> impl Iterator<Item = &Register> {
    map.registers().iter().filter(|register| is_writable(register))
}

/// Does a write go by bytes?
fn is_masked(register: &Register) -> bool {
    is_writable(register) && !register.access.whole_words()
}

fn takes_whole_words(map: &RegisterMap) -> bool {
    map.registers().iter().any(|register| register.access.whole_words())
}

fn writes(lines: &mut Lines, map: &RegisterMap) {
    if map.registers().iter().any(is_masked) {
        lines.line("// Bits that a write reaches.");
        lines.line("wire [31:0] mask = {");
        lines
            .line("    {8{avs_byteenable[3]}}, {8{avs_byteenable[2]}}, {8{avs_byteenable[1]}}, {8{avs_byteenable[0]}}");
        lines.line("};");
    }
    if takes_whole_words(map) {
        lines.line("wire whole = &avs_byteenable;");
    }
    lines.section(|lines| {
        for register in writables(map) {
            let (name, constant) = (&register.name, register.name.to_uppercase());
            lines.line(&format!("wire write_{name} = avs_write && avs_address == {constant};"));
        }
    });
    lines.section(|lines| {
        for register in map.registers() {
            match &register.access {
                Access::Guarded { by } => guarded(lines, register, by),
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

/// Is there a flag that is set by this?
fn is_flagged(map: &RegisterMap, source: Source) -> bool {
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
    if is_flagged(map, Source::PartialWrite) {
        let terms = named(&Access::whole_words, &|name| format!("write_{name}"));
        match terms.is_empty() {
            true => lines.line("wire bus_partial = 1'd0;"),
            false => joined(lines, "wire bus_partial = !whole && (", &terms, " || ", ");"),
        }
    }
    if is_flagged(map, Source::GuardRefused) {
        let terms = named(&|access| matches!(access, Access::Guarded { .. }), &|name| {
            format!("(write_{name} && !allow_{name})")
        });
        match terms.is_empty() {
            true => lines.line("wire bus_refused = 1'd0;"),
            false => joined(lines, "wire bus_refused = ", &terms, " || ", ";"),
        }
    }
    if is_flagged(map, Source::CommitRejected) {
        let staged = named(&|access| *access == Access::Staged, &|name| format!("write_{name}"));
        let commit = named(&|access| matches!(access, Access::Commit { .. }), &|name| {
            format!("(write_{name} && whole)")
        });
        let terms = [commit, staged].concat();
        match terms.is_empty() {
            true => lines.line("wire bus_rejected = 1'd0;"),
            false => joined(lines, "wire bus_rejected = waits && (", &terms, " || ", ");"),
        }
    }
}

/// Declarations and the clocked block of one register.
fn register_block(lines: &mut Lines, map: &RegisterMap, register: &Register) {
    let flops = flops(register);
    let title = |lines: &mut Lines| {
        let name = register.name.to_uppercase();
        lines.line(&format!("// {name}: {}; {}", register.access.words(), register.meaning));
    };
    let name = &register.name;
    let fields = &register.fields;
    match &register.access {
        Access::Configuration => {
            title(lines);
            clocked(lines, &flops, &format!("else if (write_{name})"), |lines| {
                for field in fields {
                    lines.line(&format!("{} <= {};", field.name, merged(field, &field.name)));
                }
            });
        }
        Access::Guarded { .. } => {
            title(lines);
            clocked(
                lines,
                &flops,
                &format!("else if (write_{name} && allow_{name})"),
                |lines| {
                    for field in fields {
                        lines.line(&format!("{0} <= next_{0};", field.name));
                    }
                },
            );
        }
        Access::Staged => {
            title(lines);
            declare(lines, &flops, "staged_");
            clocked(lines, &flops, "else", |lines| {
                lines.nest(&format!("if (write_{name} && !waits) begin"), "end", |lines| {
                    for field in fields {
                        let staged = format!("staged_{}", field.name);
                        lines.line(&format!("{staged} <= {};", merged(field, &staged)));
                    }
                });
                lines.nest("if (applies) begin", "end", |lines| {
                    for field in fields {
                        lines.line(&format!("{0} <= staged_{0};", field.name));
                    }
                });
            });
        }
        Access::Command { strobe } => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                lines.line(&format!("{strobe} <= write_{name} && whole;"));
                if !fields.is_empty() {
                    lines.nest(&format!("if (write_{name} && whole) begin"), "end", |lines| {
                        for field in fields {
                            lines.line(&format!("{} <= {};", field.name, part("avs_writedata", field)));
                        }
                    });
                }
            });
        }
        Access::Sticky | Access::InterruptState => {
            title(lines);
            let prefix = sticky_prefix(register);
            declare(lines, &flops, "");
            clocked(lines, &flops, "else", |lines| {
                for field in fields {
                    let (flag, bit) = (format!("{prefix}{}", field.name), field.low);
                    let test = match (&register.access, map.find(|access| *access == Access::InterruptTest)) {
                        (Access::InterruptState, Some(test)) => {
                            format!(" || (write_{} && whole && avs_writedata[{bit}])", test.name)
                        }
                        _ => String::new(),
                    };
                    let kept = format!("({flag} && !(write_{name} && mask[{bit}] && avs_writedata[{bit}]))");
                    lines.line(&format!("{flag} <= {}{test} || {kept};", source(field)));
                }
            });
        }
        Access::InterruptEnable => {
            title(lines);
            declare(lines, &flops, "");
            clocked(lines, &flops, &format!("else if (write_{name})"), |lines| {
                for field in fields {
                    let enable = format!("interrupt_enable_{}", field.name);
                    lines.line(&format!("{enable} <= {};", merged(field, &enable)));
                }
            });
        }
        Access::Commit { .. } => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                lines.line(&format!("waits <= !applies && (waits || (write_{name} && whole));"));
            });
        }
        Access::Constant | Access::Live | Access::Shadow { .. } | Access::Snapshot | Access::InterruptTest => {}
    }
}

fn guarded(lines: &mut Lines, register: &Register, by: &str) {
    for field in &register.fields {
        let declaration = type_of(field).declaration();
        let space = if declaration.is_empty() { "" } else { " " };
        let next = merged(field, &field.name);
        lines.line(&format!("wire {declaration}{space}next_{} = {next};", field.name));
    }
    let minima = register.fields.iter().filter(|field| field.minimum > 0).map(|field| {
        // A concatenation is unsigned, whatever it holds.
        let next = match field.is_signed() {
            true => format!("{{next_{}}}", field.name),
            false => format!("next_{}", field.name),
        };
        format!("{next} >= {}", bits(field.width).literal(field.minimum.into()))
    });
    let terms: Vec<String> = std::iter::once(by.to_owned()).chain(minima).collect();
    joined(lines, &format!("wire allow_{} = ", register.name), &terms, " && ", ";");
}

fn sticky_prefix(register: &Register) -> &'static str {
    match register.access {
        Access::InterruptState => "interrupt_state_",
        _ => "flag_",
    }
}

fn source(field: &Field) -> &str {
    match field.source {
        Source::Input => &field.name,
        Source::PartialWrite => "bus_partial",
        Source::GuardRefused => "bus_refused",
        Source::CommitRejected => "bus_rejected",
    }
}

/// The flip-flops of a register, outputs and others, without those of shadows.
fn flops(register: &Register) -> Vec<Flop> {
    let fields = |prefix: &str| -> Vec<Flop> {
        let flop = |field: &Field| (type_of(field), format!("{prefix}{}", field.name), field.reset);
        register.fields.iter().map(flop).collect()
    };
    match &register.access {
        Access::Configuration | Access::Guarded { .. } => fields(""),
        Access::Staged => [fields("staged_"), fields("")].concat(),
        Access::Command { strobe } => [vec![(bits(1), strobe.clone(), 0)], fields("")].concat(),
        Access::Sticky | Access::InterruptState => fields(sticky_prefix(register)),
        Access::InterruptEnable => fields("interrupt_enable_"),
        Access::Commit { .. } => vec![(bits(1), "waits".to_owned(), 0)],
        Access::Constant | Access::Live | Access::Shadow { .. } | Access::Snapshot | Access::InterruptTest => {
            Vec::new()
        }
    }
}

/// Declares the flip-flops whose names begin so: those that are not outputs.
fn declare(lines: &mut Lines, flops: &[Flop], prefix: &str) {
    for (ty, name, _) in flops.iter().filter(|(_, name, _)| name.starts_with(prefix)) {
        let declaration = ty.declaration();
        let space = if declaration.is_empty() { "" } else { " " };
        lines.line(&format!("reg  {declaration}{space}{name};"));
    }
}

/// A clocked block that resets `flops`, and else does what `inner` writes under the condition `otherwise`.
fn clocked(lines: &mut Lines, flops: &[Flop], otherwise: &str, inner: impl FnOnce(&mut Lines)) {
    lines.nest("always @(posedge clk) begin", "end", |lines| {
        lines.nest("if (rst) begin", &format!("end {otherwise} begin"), |lines| {
            for (ty, name, reset) in flops {
                lines.line(&format!("{name} <= {};", ty.literal((*reset).into())));
            }
        });
        lines.nest_rest("end", inner);
    });
}

/// The registers that have a shadow, with the shadow.
fn shadowed(map: &RegisterMap) -> impl Iterator<Item = &Register> {
    map.registers()
        .iter()
        .filter(|register| matches!(register.access, Access::Shadow { .. }))
}

fn shadow_flops(map: &RegisterMap) -> Vec<Flop> {
    let fields = shadowed(map).flat_map(|register| map.fields(register));
    fields
        .map(|field| (type_of(field), format!("shadow_{}", field.name), 0))
        .collect()
}

fn shadows(lines: &mut Lines, map: &RegisterMap) {
    let Some(snapshot) = map.find(|access| *access == Access::Snapshot) else {
        return;
    };
    lines.line(&format!("// {}: {}", snapshot.name.to_uppercase(), snapshot.meaning));
    let flops = shadow_flops(map);
    declare(lines, &flops, "");
    clocked(
        lines,
        &flops,
        &format!("else if (write_{} && whole)", snapshot.name),
        |lines| {
            for field in shadowed(map).flat_map(|register| map.fields(register)) {
                lines.line(&format!("shadow_{0} <= {0};", field.name));
            }
        },
    );
}

fn interrupt(lines: &mut Lines, map: &RegisterMap) {
    let Some(state) = map.find(|access| *access == Access::InterruptState) else {
        return;
    };
    let terms: Vec<String> = state
        .fields
        .iter()
        .map(|field| format!("(interrupt_state_{0} && interrupt_enable_{0})", field.name))
        .collect();
    let irq = [(bits(1), "irq".to_owned(), 0)];
    clocked(lines, &irq, "else", |lines| {
        joined(lines, "irq <= ", &terms, " || ", ";")
    });
}

fn reads(lines: &mut Lines, map: &RegisterMap) {
    let data = [(bits(32), "avs_readdata".to_owned(), 0)];
    clocked(lines, &data, "else if (avs_read)", |lines| {
        lines.nest("case (avs_address)", "endcase", |lines| {
            for register in map.registers() {
                if let Some(value) = read_value(map, register) {
                    lines.line(&format!("{}: avs_readdata <= {value};", register.name.to_uppercase()));
                }
            }
            lines.line("default: avs_readdata <= 32'd0;");
        });
    });
}

fn read_value(map: &RegisterMap, register: &Register) -> Option<String> {
    let named = |prefix: &'static str| {
        let fields = map.fields(register);
        Some(word(fields, |field| format!("{prefix}{}", field.name)))
    };
    match register.access {
        Access::Constant => Some(format!("32'h{:08x}", register.reset())),
        Access::Live | Access::Configuration | Access::Guarded { .. } => named(""),
        Access::Shadow { .. } => named("shadow_"),
        Access::Staged => named("staged_"),
        Access::Sticky | Access::InterruptState => named(sticky_prefix(register)),
        Access::InterruptEnable => named("interrupt_enable_"),
        Access::Commit { .. } => Some("{31'd0, waits}".to_owned()),
        Access::Command { .. } | Access::Snapshot | Access::InterruptTest => None,
    }
}

fn power_up(lines: &mut Lines, map: &RegisterMap) {
    let mut all: Vec<Flop> = map.registers().iter().flat_map(flops).collect();
    all.extend(shadow_flops(map));
    all.push((bits(32), "avs_readdata".to_owned(), 0));
    if map.find(|access| *access == Access::InterruptState).is_some() {
        all.push((bits(1), "irq".to_owned(), 0));
    }
    lines.nest("initial begin", "end", |lines| {
        for (ty, name, reset) in &all {
            lines.line(&format!("{name} = {};", ty.literal((*reset).into())));
        }
    });
}

/// Reads what nothing else reads, so that lint tools take it as meant.
fn unused(lines: &mut Lines, map: &RegisterMap) {
    let fields_of = |holds: &dyn Fn(&Register) -> bool| {
        let registers = map.registers().iter().filter(|register| holds(register));
        registers.fold(0, |mask, register| mask | register.mask())
    };
    let masked = map.registers().iter().any(is_masked);
    let takes_data = |register: &Register| is_writable(register) && !matches!(register.access, Access::Commit { .. });
    let mut terms = runs("avs_writedata", !fields_of(&takes_data));
    if masked {
        terms.extend(runs("mask", !fields_of(&is_masked)));
    } else if !takes_whole_words(map) {
        terms.push("avs_byteenable".to_owned());
    }
    if writables(map).next().is_none() {
        terms.push("avs_write".to_owned());
    }
    if !terms.is_empty() {
        lines.line("// Bits that nothing reads.");
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
