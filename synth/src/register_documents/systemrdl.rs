//! A register map as SystemRDL 2.0.

use super::{Software, WORD_BYTES, fields, has_reset, meaning, software};
use posicast_blocks::registers::{Access, Field, Format, Register, RegisterMap};
use std::fmt::Write;

/// Words that cannot be used as a name unescaped (Accellera SystemRDL 2.0, table 3 and its reserved words).
const KEYWORDS: &str = "
abstract accesstype addressingtype addrmap alias all arbiter async bbv bit boolean bothedge bridge componentwidth compact
constraint counter cpuif_reset default disable dontcompare donttest encode enable enum errextbus external false field
fullalign halt hw hwclr hwenable hwmask hwset inside intr level littleendian longint lsb0 mask mem msb0 na name negedge next
nonsticky number onreadtype onwritetype or overflow parity posedge precedence property r rclr ref reg regalign regfile resetsignal
rset ruser rw rw1 signal signed stickybit string struct swacc sw this true type underflow unsigned w w1 wclr woclr woset wot
wr wset wuser wzc wzs wzt xored activehigh activelow anded ored bigendian singlepulse sticky swmod swwe swwel sync we wel
width threshold saturate rsvdset rsvdsetX reset sharedextbus paritycheck onread onwrite nonrsvd incr decr
";

/// Writes the map of these components as one `addrmap` with this name.
pub(super) fn document(name: &str, components: &str, map: &RegisterMap) -> String {
    let mut text = format!(
        "// Registers of {name}. Written by posicast.\naddrmap {name} {{\n    name = {};\n    desc = {};\n    \
         default regwidth = 32;\n    default accesswidth = 32;\n    littleendian;\n",
        quoted(name),
        quoted(&super::about(components, map)),
    );
    for register in map.registers() {
        write_register(&mut text, map, register);
    }
    text.push_str("};\n");
    text
}

fn write_register(text: &mut String, map: &RegisterMap, register: &Register) {
    let _ = write!(text, "\n    reg {{\n        desc = {};\n", quoted(&about(register)));
    for field in fields(map, register) {
        write_field(text, register, &field);
    }
    let many = match register.words() {
        1 => String::new(),
        words => format!("[{words}]"),
    };
    let _ = writeln!(
        text,
        "    }} {}{many} @ {:#x};",
        register.name.to_uppercase(),
        register.offset * WORD_BYTES
    );
}

fn write_field(text: &mut String, register: &Register, field: &Field) {
    let access = match software(&register.access) {
        Software::Read => "sw = r;",
        Software::ReadWrite => "sw = rw;",
        Software::ReadClear => "sw = rw; onwrite = woclr;",
        Software::Write => "sw = w;",
    };
    let hardware = match &register.access {
        Access::Constant => "na",
        Access::Live | Access::Shadow { .. } | Access::Sticky | Access::InterruptState | Access::Commit { .. } => "w",
        _ => "r",
    };
    let name = identifier(&field.name);
    let mut encode = String::new();
    if let Format::Enumeration(choices) = &field.format {
        let enumeration = format!("{}_{}_e", register.name, field.name);
        let _ = write!(text, "        enum {enumeration} {{");
        for choice in choices {
            let (name, value) = (identifier(&choice.name), choice.value);
            let _ = write!(text, " {name} = {value} {{ desc = {}; }};", quoted(&choice.meaning));
        }
        text.push_str(" };\n");
        encode = format!(" encode = {enumeration};");
    }
    let reset = if has_reset(&register.access) {
        format!(" = {:#x}", field.reset & field.ones())
    } else {
        String::new()
    };
    let _ = writeln!(
        text,
        "        field {{ {access} hw = {hardware}; desc = {};{encode} }} {name}[{}:{}]{reset};",
        quoted(&meaning(field)),
        field.low + field.width - 1,
        field.low
    );
}

/// Meaning of the register, with restrictions on writes.
fn about(register: &Register) -> String {
    let how = match &register.access {
        Access::Guarded { while_low } => format!("; written only while `{while_low}` is low"),
        Access::Staged => "; takes effect with a commit".to_owned(),
        access if access.whole_words() => "; written as a whole word only".to_owned(),
        _ => String::new(),
    };
    format!("{} ({}){how}", register.meaning, register.access.words())
}

/// Returns a name, escaped if it is a word of the language.
fn identifier(name: &str) -> String {
    if KEYWORDS.split_whitespace().any(|keyword| keyword == name) {
        format!("\\{name}")
    } else {
        name.to_owned()
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
