//! A register map as CMSIS-SVD, schema version 1.3: a device with one peripheral.
//!
//! The peripheral is at address 0, because the system determines its address: add the component's base.

use super::{Software, WORD_BYTES, about, escaped, fields, has_reset, meaning, software};
use posicast_blocks::registers::{Field, Format, Register, RegisterMap};
use std::fmt::Write;

/// Writes the map of these components as the device `name`.
pub(super) fn document(name: &str, components: &str, map: &RegisterMap) -> String {
    let about = escaped(&about(components, map));
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>
<device schemaVersion=\"1.3\" xmlns:xs=\"http://www.w3.org/2001/XMLSchema-instance\" xs:noNamespaceSchemaLocation=\"CMSIS-SVD.xsd\">
  <vendor>posicast</vendor>
  <name>{name}</name>
  <version>1.0</version>
  <description>{about}</description>
  <addressUnitBits>8</addressUnitBits>
  <width>32</width>
  <size>32</size>
  <resetValue>0</resetValue>
  <resetMask>0xffffffff</resetMask>
  <peripherals>
    <peripheral>
      <name>{name}</name>
      <description>{about}</description>
      <baseAddress>0x0</baseAddress>
      <addressBlock>
        <offset>0x0</offset>
        <size>{:#x}</size>
        <usage>registers</usage>
      </addressBlock>
      <registers>
",
        map.words() * WORD_BYTES
    );
    for register in map.registers() {
        write_register(&mut text, map, register);
    }
    text.push_str("      </registers>\n    </peripheral>\n  </peripherals>\n</device>\n");
    text
}

fn write_register(text: &mut String, map: &RegisterMap, register: &Register) {
    let mut line = |depth: usize, text_of: &str| {
        let _ = writeln!(text, "{:width$}{text_of}", "", width = 8 + 2 * depth);
    };
    let name = register.name.to_uppercase();
    line(0, "<register>");
    match register.words() {
        1 => line(1, &format!("<name>{name}</name>")),
        words => {
            line(1, &format!("<dim>{words}</dim>"));
            line(1, &format!("<dimIncrement>{WORD_BYTES}</dimIncrement>"));
            line(1, &format!("<name>{name}_%s</name>"));
        }
    }
    let about = format!("{} ({})", register.meaning, register.access.words());
    line(1, &format!("<description>{}</description>", escaped(&about)));
    line(
        1,
        &format!("<addressOffset>{:#x}</addressOffset>", register.offset * WORD_BYTES),
    );
    let kind = software(&register.access);
    line(
        1,
        match kind {
            Software::Read => "<access>read-only</access>",
            Software::Write => "<access>write-only</access>",
            Software::ReadWrite | Software::ReadClear => "<access>read-write</access>",
        },
    );
    let (reset, mask) = if has_reset(&register.access) {
        (register.reset(), u32::MAX)
    } else {
        (0, 0)
    };
    line(1, &format!("<resetValue>{reset:#x}</resetValue>"));
    line(1, &format!("<resetMask>{mask:#x}</resetMask>"));
    if kind == Software::ReadClear {
        line(1, "<modifiedWriteValues>oneToClear</modifiedWriteValues>");
    }
    line(1, "<fields>");
    for field in fields(map, register) {
        write_field(&mut line, &field);
    }
    line(1, "</fields>");
    line(0, "</register>");
}

fn write_field(line: &mut dyn FnMut(usize, &str), field: &Field) {
    line(2, "<field>");
    line(3, &format!("<name>{}</name>", field.name));
    line(3, &format!("<description>{}</description>", escaped(&meaning(field))));
    line(3, &format!("<bitOffset>{}</bitOffset>", field.low));
    line(3, &format!("<bitWidth>{}</bitWidth>", field.width));
    if let Format::Enumeration(choices) = &field.format {
        line(3, "<enumeratedValues>");
        for choice in choices {
            line(4, "<enumeratedValue>");
            line(5, &format!("<name>{}</name>", choice.name));
            line(5, &format!("<description>{}</description>", escaped(&choice.meaning)));
            line(5, &format!("<value>{}</value>", choice.value));
            line(4, "</enumeratedValue>");
        }
        line(3, "</enumeratedValues>");
    }
    line(2, "</field>");
}
