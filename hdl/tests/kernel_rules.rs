//! The rules of the kernels, checked in their source: constructs that RustHDL accepts and simulates differently from
//! its Verilog.
//!
//! The emitter refuses most of them too, but later, and only in kernels that are emitted.

use posicast_hdl::emit::{Header, compose};
use std::fs;
use std::path::Path;

/// Parts of RustHDL that behave differently from their Verilog, and their replacements.
const REPLACED: [(&str, &str); 7] = [
    ("DFF", "Dff, which has a reset"),
    ("DFFWithInit", "Dff::new"),
    ("RAM", "Ram, which has arbitrary contents"),
    ("ROM", "Rom, whose data is registered"),
    ("SyncROM", "Rom"),
    ("rust_hdl_widgets", "crate::prelude"),
    (
        "MultiplyAccumulateSymmetricFiniteImpulseResponseFilter",
        "SMul and an accumulator",
    ),
];

/// Returns a description of every rule that a source file breaks.
fn broken_rules(source: &str) -> Vec<String> {
    let code = without_comments(source);
    let mut broken = Vec::new();
    for (word, instead) in REPLACED {
        if uses(&code, word) {
            broken.push(format!("uses {word}: use {instead}"));
        }
    }
    let kernels: Vec<&str> = code.split("#[hdl_gen]").skip(1).collect();
    match kernels[..] {
        [] => {}
        [kernel] => check_kernel(&code, body(kernel), &mut broken),
        _ => broken.push("has several kernels: one per file".to_owned()),
    }
    broken
}

fn check_kernel(code: &str, body: &str, broken: &mut Vec<String>) {
    if !code.contains("use crate::prelude::*;") || code.contains("use rust_hdl_core") {
        broken.push("does not take RustHDL from crate::prelude, and so gets the wrong signed_bit_cast".to_owned());
    }
    // A long name stands on a line of its own.
    let first = body.trim_start().strip_prefix("comment!(").unwrap_or_default();
    if !first.trim_start().starts_with("\"@module ") {
        broken.push("does not begin with the name of its module: comment!(\"@module name\")".to_owned());
    }
    if uses(body, "println") {
        broken.push("uses println, which prints on every update: use comment!".to_owned());
    }
    let flat: String = body.split_whitespace().collect();
    for (place, _) in flat.match_indices(".d.val()") {
        broken.push(format!("reads what goes into a register: {}", before(&flat, place)));
    }
    for (place, _) in flat.match_indices(".get_bits") {
        if !flat[..place].ends_with(".val()") {
            broken.push(format!("slices an expression, not a signal: {}", before(&flat, place)));
        }
    }
    for (place, _) in flat.match_indices("signed_bit_cast::") {
        if !flat[..place].ends_with(".next=") {
            broken.push(format!(
                "casts inside an expression, not to a Local: {}",
                before(&flat, place)
            ));
        }
    }
    let connected = connected(code);
    for port in &connected {
        if flat.contains(&format!("self.{port}.next=")) {
            broken.push(format!("`{port}` is connected, and assigned too"));
        }
    }
    for (name, kind) in fields(code) {
        if compose(&name, &Header::default(), &[], &[]).is_err() {
            broken.push(format!("`{name}` is no Verilog name"));
        }
        match kind.as_str() {
            "Out" if connected.contains(&name) => {}
            "Local" | "Out" => match first_assignment(&flat, &name) {
                None => broken.push(format!("`{name}` is never assigned")),
                Some(0) => {}
                Some(_) => broken.push(format!(
                    "`{name}` is assigned in a branch, and has no default before it"
                )),
            },
            "Dff" if !registers(&flat).contains(&name.as_str()) => {
                broken.push(format!("the register `{name}` is not in dff_setup!"));
            }
            _ => {}
        }
    }
}

/// The sections of `kernel!`, and the kind of their fields.
const SECTIONS: [(&str, &str); 6] = [
    ("inputs", "In"),
    ("outputs", "Out"),
    ("wires", "Local"),
    ("registers", "Register"),
    ("parts", "Part"),
    ("constants", "Constant"),
];

/// Returns name and kind of the fields of a `kernel!`, including those of its block's list of ports; arrays are left
/// out.
fn kernel_fields(declaration: &str) -> Vec<(String, String)> {
    let declaration = declaration.split("\n}").next().unwrap_or_default();
    let mut fields = Vec::new();
    for (section, kind) in SECTIONS {
        for content in declaration.split(&format!("    {section} {{")).skip(1) {
            for entry in body(&format!("{{{content}")).split(',') {
                let name = entry.split_once(": ").map_or("", |(name, _)| name.trim());
                if name.starts_with(|c: char| c.is_ascii_lowercase()) && !name.contains(['[', ' ']) {
                    fields.push((name.to_owned(), kind.to_owned()));
                }
            }
        }
    }
    let list = declaration.split("ports posicast_blocks::").nth(1);
    fields.extend(
        list.and_then(|rest| rest.split(';').next())
            .into_iter()
            .flat_map(listed),
    );
    fields
}

/// Returns the ports that `kernel!` connects: `part.port`, or the name of an output.
fn connected(code: &str) -> Vec<String> {
    let Some((_, lines)) = code.split_once("    connect {") else {
        return Vec::new();
    };
    let mut ports = Vec::new();
    for line in body(&format!("{{{lines}")).split(';') {
        let (parts, names) = line.split_once(": ").unwrap_or_default();
        let parts = parts
            .split(" from ")
            .next()
            .unwrap_or_default()
            .split(',')
            .map(str::trim);
        for (part, name) in parts.flat_map(|part| names.split(',').map(move |name| (part, name.trim()))) {
            ports.push(match part {
                "outputs" => name.to_owned(),
                _ => format!("{part}.{name}"),
            });
        }
    }
    ports
}

/// Returns name and kind of the ports of a list in the model.
fn listed(list: &str) -> Vec<(String, String)> {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../model/blocks/src");
    let texts = sources(&model)
        .into_iter()
        .filter_map(|file| fs::read_to_string(file).ok());
    // The name of a list is followed by `;`, or by its sizes in parentheses.
    let lists = texts.into_iter().find_map(|text| {
        [";", "("]
            .iter()
            .find_map(|end| Some(text.split_once(&format!("\n    {list}{end}"))?.1.to_owned()))
    });
    let lists = without_comments(&lists.unwrap_or_else(|| panic!("no list {list} in the model")));
    let (inputs, outputs) = lists.split_once("    outputs ").unwrap_or_default();
    let names = |entries: &str, kind: &str| -> Vec<(String, String)> {
        let entries = entries.split("\n}").next().unwrap_or_default().lines();
        let names =
            entries.filter_map(|entry| Some(entry.split_once(": Bi").or(entry.split_once(": Signed"))?.0.trim()));
        let names = names.filter(|name| !name.contains('['));
        names.map(|name| (name.to_owned(), kind.to_owned())).collect()
    };
    [names(inputs, "In"), names(outputs, "Out")].concat()
}

/// Returns name and kind (`In`, `Out`, `Local`, or the type's name) of every field that is hardware.
fn fields(code: &str) -> Vec<(String, String)> {
    if let Some((_, declaration)) = code.split_once("kernel! {") {
        return kernel_fields(declaration);
    }
    let declaration = code.split("#[derive(LogicBlock").nth(1).unwrap_or_default();
    let declaration = declaration.split("\n}").next().unwrap_or_default();
    let mut fields = Vec::new();
    for line in declaration.lines() {
        let line = line
            .trim()
            .trim_start_matches("pub(super) ")
            .trim_start_matches("pub(crate) ");
        let Some((name, kind)) = line.split_once(": ") else {
            continue;
        };
        if !name.starts_with(|c: char| c.is_ascii_lowercase()) || name.contains(' ') {
            continue;
        }
        let kind = kind.strip_prefix("Signal<").unwrap_or(kind);
        let kind: String = kind.chars().take_while(|c| c.is_alphanumeric()).collect();
        fields.push((name.to_owned(), kind));
    }
    fields
}

/// Returns the number of branches around the first assignment of `name`.
fn first_assignment(flat: &str, name: &str) -> Option<usize> {
    let place = flat.find(&format!("self.{name}.next="))?;
    let opened = flat[..place].matches('{').count();
    Some(opened - flat[..place].matches('}').count())
}

fn registers(flat: &str) -> Vec<&str> {
    let list = flat.split("dff_setup!(self,clk,").nth(1).unwrap_or_default();
    list.split(')').next().unwrap_or_default().split(',').collect()
}

/// Returns the statements of the function that `kernel` begins with.
fn body(kernel: &str) -> &str {
    let begin = kernel.find('{').map_or(0, |place| place + 1);
    let mut depth = 1;
    for (place, found) in kernel[begin..].char_indices() {
        match found {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return &kernel[begin..begin + place];
        }
    }
    &kernel[begin..]
}

fn without_comments(source: &str) -> String {
    let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned() + "\n";
    source.lines().map(code).collect()
}

/// Returns whether the item `word` is used: as a type with parameters, in a path, or as a macro.
fn uses(code: &str, word: &str) -> bool {
    let in_name = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).any(|(place, _)| {
        let (before, after) = (&code[..place], &code[place + word.len()..]);
        !before.ends_with(in_name) && after.starts_with(['<', ':', '!'])
    })
}

fn before(flat: &str, place: usize) -> &str {
    let from = flat[..place].rfind(';').map_or(0, |end| end + 1);
    &flat[from..place]
}

/// Returns every Rust file below `folder`.
fn sources(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let rust = files
        .into_iter()
        .filter(|path| path.extension().is_some_and(|e| e == "rs"));
    rust.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

#[test]
fn our_kernels_keep_the_rules() {
    let files = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let mut kernels = 0;
    for file in files {
        let source = fs::read_to_string(&file).unwrap();
        kernels += usize::from(without_comments(&source).contains("#[hdl_gen]\n"));
        assert_eq!(broken_rules(&source), [""; 0], "{}", file.display());
    }
    assert!(kernels >= 4, "{kernels} kernels found");
}

/// A kernel that keeps the rules.
const GOOD: &str = r#"
use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Doubler {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) number: Signal<In, Signed<8>>,
    pub(super) twice: Signal<Out, Signed<16>>,
    held: Dff<Signed<8>>,
    wide: Signal<Local, Signed<16>>,
}

impl Logic for Doubler {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module doubler");
        dff_setup!(self, clk, held);
        if self.number.val().get_bits::<1>(0) == self.number.val().get_bits::<1>(1) {
            self.held.d.next = self.number.val();
        }
        self.wide.next = signed_bit_cast::<16, 8>(self.held.q.val());
        self.twice.next = self.wide.val() + self.wide.val();
    }
}
"#;

#[test]
fn a_good_kernel_is_let_through() {
    assert_eq!(broken_rules(GOOD), [""; 0]);
}

/// Returns the same kernel, written with `kernel!`.
fn with_the_macro() -> String {
    let (before, from) = GOOD.split_once("#[derive").unwrap();
    let (_, after) = from.split_once("\n}\n").unwrap();
    let kernel = "kernel! {
    pub(super) struct Doubler;

    inputs { rst: Bit, number: Signed<8> }
    outputs {
        twice: Signed<16>,
    }
    registers { held: Signed<8> = from_i64(1) }
    wires { wide: Signed<16> }
}
";
    format!("{before}{kernel}{after}").replace("dff_setup!(self, clk, held);", "")
}

#[test]
fn the_fields_of_a_kernel_macro_are_checked_too() {
    let good = with_the_macro();
    assert_eq!(broken_rules(&good), [""; 0]);
    let connected = "    wires { wide: Signed<16> }\n    connect { outputs from held: twice; held: number; }";
    let connected = good.replace("    wires { wide: Signed<16> }", connected);
    assert!(
        broken_rules(&connected).contains(&"`twice` is connected, and assigned too".to_owned()),
        "{connected}"
    );
    let connected = connected.replace("self.twice.next = ", "self.wide.next = ");
    assert_eq!(broken_rules(&connected), [""; 0]);
    let cases = [
        ("self.wide.next = ", "self.twice.next = ", "`wide` is never assigned"),
        (
            "self.twice.next = ",
            "if self.rst.val() { } self.wide.next = ",
            "`twice` is never assigned",
        ),
        ("number: Signed", "initial: Signed", "`initial` is no Verilog name"),
        (
            "    inputs { rst: Bit, number: Signed<8> }",
            "    ports posicast_blocks::schedule_ports;",
            "`control` is never assigned",
        ),
    ];
    for (written, instead, finding) in cases {
        assert!(good.contains(written), "{written}");
        let broken = broken_rules(&good.replace(written, instead));
        assert!(
            broken.iter().any(|rule| rule.contains(finding)),
            "{finding}: {broken:?}"
        );
    }
}

#[test]
fn each_rule_that_is_broken_is_found() {
    let cases = [
        ("Dff<Signed<8>>", "DFF<Signed<8>>", "uses DFF"),
        (
            "use crate::prelude::*;",
            "use rust_hdl_core::prelude::*;",
            "wrong signed_bit_cast",
        ),
        ("comment!(\"@module doubler\");", "", "name of its module"),
        (
            "comment!(\"@module doubler\");",
            "comment!(\"@module doubler\"); println!(\"x\");",
            "prints on every update",
        ),
        ("self.held.q.val()", "self.held.d.val()", "goes into a register"),
        (
            "self.number.val().get_bits",
            "(self.number.val() + self.number.val()).get_bits",
            "slices an expression",
        ),
        (
            "self.wide.val() + self.wide.val()",
            "self.wide.val() + signed_bit_cast::<16, 8>(self.held.q.val())",
            "casts inside",
        ),
        ("number", "initial", "`initial` is no Verilog name"),
        (
            "self.wide.next = ",
            "if self.rst.val() { } self.twice.next = ",
            "`wide` is never assigned",
        ),
        (
            "self.twice.next = self.wide.val() + self.wide.val();",
            "if self.rst.val() { self.twice.next = self.wide.val(); }",
            "`twice` is assigned in a branch",
        ),
        ("dff_setup!(self, clk, held);", "", "`held` is not in dff_setup!"),
        (
            "fn update",
            "#[hdl_gen] fn other(&mut self) { } fn update",
            "several kernels",
        ),
    ];
    for (good, bad, finding) in cases {
        assert!(GOOD.contains(good), "{good}");
        let broken = broken_rules(&GOOD.replace(good, bad));
        assert!(
            broken.iter().any(|rule| rule.contains(finding)),
            "{finding}: {broken:?}"
        );
    }
}
