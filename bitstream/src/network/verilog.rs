//! A network as Verilog, for any simulator.

use super::{BlockRam, Gate, HIGH, LOW, NetIndex, Network, NetworkMemory, State, TableWrite};
use std::collections::HashMap;
use std::fmt::Write;

impl Network {
    /// The network as a module of this name, whose ports are called `pin_` and the pin.
    #[must_use]
    pub fn verilog(&self, module: &str) -> String {
        let mut text = format!(
            "// The netlist of the bits, read back from the packed bitstream: look-up tables as expressions, registers, and memories.\n\n\
             `default_nettype none\n\nmodule {module} (\n"
        );
        let inputs = self.inputs.iter().map(|(pin, _)| format!("    input  wire pin_{pin}"));
        let outputs = self.outputs.iter().map(|(pin, _)| format!("    output wire pin_{pin}"));
        let ports: Vec<String> = inputs.chain(outputs).collect();
        let _ = writeln!(text, "{}\n);", ports.join(",\n"));
        for gate in &self.gates {
            let _ = writeln!(text, "    wire {};", self.name(gate.output));
        }
        for state in &self.states {
            let _ = writeln!(
                text,
                "    reg  {} = 1'b{};",
                self.name(state.output),
                u8::from(state.initial)
            );
        }
        for (pin, net) in &self.inputs {
            let _ = writeln!(text, "    wire {} = pin_{pin};", self.name(*net));
        }
        text.push('\n');
        let writes: HashMap<NetIndex, &TableWrite> =
            self.table_writes.iter().map(|write| (write.output, write)).collect();
        for gate in &self.gates {
            text += &match writes.get(&gate.output) {
                Some(write) => self.written_table(gate, write),
                None => format!("    assign {} = {};\n", self.name(gate.output), self.expression(gate)),
            };
        }
        for memory in &self.memories {
            // The netlist of iCE40 has Verilog of its own.
            if let NetworkMemory::Plain(ram) = memory {
                text += &self.memory(ram);
            }
        }
        for state in &self.states {
            text += &self.register(state);
        }
        for (pin, net) in &self.outputs {
            let _ = writeln!(text, "    assign pin_{pin} = {};", self.name(*net));
        }
        text += "endmodule\n\n`default_nettype wire\n";
        text
    }

    fn name(&self, net: NetIndex) -> String {
        match net {
            LOW => "1'b0".to_owned(),
            HIGH => "1'b1".to_owned(),
            net => self.names[net as usize].clone(),
        }
    }

    /// A bit of a distributed RAM.
    fn written_table(&self, gate: &Gate, write: &TableWrite) -> String {
        let bus = |nets: &[NetIndex; 4]| {
            let names = nets.iter().rev().map(|net| self.name(*net));
            format!("{{{}}}", names.collect::<Vec<_>>().join(", "))
        };
        let output = self.name(gate.output);
        format!(
            "    reg  [15:0] {output}_table = 16'h{:04x};\n    assign {output} = {output}_table[{}];\n    always @(posedge {}) if ({}) \
             {output}_table[{}] <= {};\n",
            gate.table,
            bus(&gate.inputs),
            self.name(write.clock),
            self.name(write.enable),
            bus(&write.address),
            self.name(write.data)
        )
    }

    /// The table of a gate as choices by its inputs, the last first.
    fn expression(&self, gate: &Gate) -> String {
        self.choice(u32::from(gate.table), &gate.inputs)
    }

    fn choice(&self, table: u32, inputs: &[NetIndex]) -> String {
        let values = 1u32 << inputs.len();
        if table == 0 {
            return "1'b0".to_owned();
        }
        if table == ((1u64 << values) - 1) as u32 {
            return "1'b1".to_owned();
        }
        let Some((last, rest)) = inputs.split_last() else {
            return "1'b0".to_owned();
        };
        let half = values / 2;
        let (low, high) = (table & ((1 << half) - 1), table >> half);
        if low == high || *last == LOW {
            return self.choice(low, rest);
        }
        if *last == HIGH {
            return self.choice(high, rest);
        }
        let (name, low, high) = (self.name(*last), self.choice(low, rest), self.choice(high, rest));
        match (low.as_str(), high.as_str()) {
            ("1'b0", "1'b1") => name,
            ("1'b1", "1'b0") => format!("~{name}"),
            _ => format!("({name} ? {high} : {low})"),
        }
    }

    fn register(&self, state: &State) -> String {
        let (output, clock) = (self.name(state.output), self.name(state.clock));
        let reset = match (state.reset, state.reset_needs_enable) {
            (LOW, _) => String::new(),
            (reset, true) => format!(
                "if ({} & {}) {output} <= 1'b{}; else ",
                self.name(reset),
                self.name(state.enable),
                u8::from(state.reset_to)
            ),
            (reset, false) => format!(
                "if ({}) {output} <= 1'b{}; else ",
                self.name(reset),
                u8::from(state.reset_to)
            ),
        };
        let also = match state.is_asynchronous {
            true => format!(", posedge {}", self.name(state.reset)),
            false => String::new(),
        };
        let enable = match state.enable {
            HIGH => String::new(),
            enable => format!("if ({}) ", self.name(enable)),
        };
        format!(
            "    always @(posedge {clock}{also}) {reset}{enable}{output} <= {};\n",
            self.name(state.data)
        )
    }

    fn memory(&self, ram: &BlockRam) -> String {
        let (name, bits, words) = (&ram.name, ram.bits, ram.contents.len());
        let bus = |nets: &[NetIndex]| {
            let names: Vec<String> = nets.iter().rev().map(|net| self.name(*net)).collect();
            format!("{{{}}}", names.join(", "))
        };
        let mut text = format!(
            "    reg [{}:0] {name} [0:{}];\n    integer {name}_word;\n    initial begin\n",
            bits - 1,
            words - 1
        );
        let _ = writeln!(
            text,
            "        for ({name}_word = 0; {name}_word < {words}; {name}_word = {name}_word + 1) {name}[{name}_word] = {bits}'d0;"
        );
        for (index, word) in ram.contents.iter().enumerate().filter(|(_, word)| **word != 0) {
            let _ = writeln!(text, "        {name}[{index}] = {bits}'h{word:x};");
        }
        text += "    end\n";
        for (index, port) in ram.ports.iter().enumerate() {
            let (clock, enable) = (self.name(port.clock), self.name(port.enable));
            let address = format!("{name}_address_{index}");
            let width = port.address.len();
            let _ = writeln!(text, "    wire [{}:0] {address} = {};", width - 1, bus(&port.address));
            let writes = port.write.as_ref().map(|write| self.name(write.enable));
            if let Some(write) = &port.write {
                let part = bits / write.parts.len().max(1) as u32;
                let _ = writeln!(
                    text,
                    "    wire [{}:0] {name}_data_{index} = {};",
                    bits - 1,
                    bus(&write.data)
                );
                let _ = writeln!(
                    text,
                    "    always @(posedge {clock}) if ({enable} & {}) begin",
                    self.name(write.enable)
                );
                for (number, net) in write.parts.iter().enumerate() {
                    let low = part * number as u32;
                    let range = format!("[{}:{low}]", low + part - 1);
                    let _ = writeln!(
                        text,
                        "        if ({}) {name}[{address}]{range} <= {name}_data_{index}{range};",
                        self.name(*net)
                    );
                }
                text += "    end\n";
            }
            if !port.outputs.is_empty() {
                let idle = writes.map_or_else(String::new, |writes| format!(" & ~{writes}"));
                let _ = writeln!(text, "    reg  [{}:0] {name}_read_{index} = {bits}'d0;", bits - 1);
                let _ = writeln!(
                    text,
                    "    always @(posedge {clock}) if ({enable}{idle}) {name}_read_{index} <= {name}[{address}];"
                );
                for (bit, net) in port.outputs.iter().enumerate() {
                    let _ = writeln!(text, "    wire {} = {name}_read_{index}[{bit}];", self.name(*net));
                }
            }
        }
        text
    }
}
