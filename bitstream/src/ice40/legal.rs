//! The netlist of the bits as Verilog that other simulators read.

/// Model of the block RAM that the netlist contains.
pub const MEMORY_MODEL: &str = include_str!("SB_RAM40_4K.v");

/// Makes icebox_vlog's Verilog legal: it declares each port in the module's header, and its net again below.
#[must_use]
pub fn legal_verilog(text: &str) -> String {
    let Some((before, rest)) = text.split_once("module ") else {
        return text.to_owned();
    };
    let Some((header, body)) = rest.split_once(");") else {
        return text.to_owned();
    };
    let Some((name, ports)) = header.split_once('(') else {
        return text.to_owned();
    };
    let ports: Vec<&str> = ports.split(',').map(str::trim).collect();
    let names: Vec<&str> = ports.iter().filter_map(|port| port.split_whitespace().last()).collect();
    let directions: String = ports.iter().map(|port| format!("{port};\n")).collect();
    format!(
        "// The netlist of the bits: read back from the packed bitstream by iceunpack and icebox_vlog.\n{before}module {name}({});\n\
         {directions}{body}",
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_are_declared_once_each_in_header_and_body() {
        let legal = legal_verilog("\nmodule chip (input pin_1, output pin_2);\n\nwire pin_1;\nendmodule\n");
        assert!(
            legal.contains("module chip (pin_1, pin_2);\ninput pin_1;\noutput pin_2;\n"),
            "{legal}"
        );
    }
}
