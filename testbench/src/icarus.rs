//! Icarus Verilog, the second simulator: slow and independent, with four-valued signals.
//!
//! A generated testbench reads a line of inputs from its standard input, settles, writes a line of outputs, and makes
//! one clock; `vvp` runs as a child process with two pipes. There is no VPI, and no file grows with the length of the
//! run, unless a waveform is requested ([`Icarus::recording`]).
//!
//! An output that is `x` or `z` is a mismatch where the simulation is used as a [`Device`], and a [`StepError`] where
//! it is used as a [`ClockedBlock`], which cannot represent it.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Stdio};

use posicast_blocks::{ClockedBlock, Direction, Port, StepError};
use posicast_system::process::{self, Running};
use posicast_system::scratch;

use crate::Error;
use crate::error::MissingTool;
use crate::lockstep::Device;
use crate::patience::Patience;
use crate::tool::{self, Tool};
use crate::verilator::VerilogSource;

const ICARUS: Tool = Tool {
    name: "iverilog",
    variable: "IVERILOG",
    purpose: "it simulates the Verilog as second opinion",
    remedy: "Install it (Debian: apt-get install iverilog), or choose another simulator with --simulator",
};
const VVP: Tool = Tool {
    name: "vvp",
    variable: "VVP",
    purpose: "it runs the output of iverilog",
    remedy: "It comes with Icarus Verilog (Debian: apt-get install iverilog)",
};
/// Largest length in bytes of a line of outputs: 64 per port, and more than enough for any top module.
const LINE_BYTES: u64 = 1 << 20;

/// Scope of the testbench, and so of the signals in a waveform.
pub const SCOPE: &str = "posicast_bench";
/// Name of the waveform in the folder in which `vvp` runs.
const WAVES: &str = "waves.vcd";
/// Name of the compiled program that `vvp` runs.
const PROGRAM: &str = "bench.vvp";

/// A Verilog module that runs under Icarus.
#[derive(Debug)]
pub struct Icarus {
    ports: Vec<Port>,
    outputs: Vec<Port>,
    // It may end the process, and so it goes first.
    patience: Patience,
    // This is ended when it is dropped; its folder is removed after that.
    process: Running,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
    line: String,
    unknown: Vec<u64>,
    folder: scratch::Folder,
}

impl Icarus {
    /// Compiles the module with its testbench and starts it.
    ///
    /// # Errors
    /// [`Error::ToolMissing`] without Icarus; [`Error::ToolFailed`] where it refuses the Verilog, for example because
    /// ports are missing or have another width.
    pub fn build(source: &VerilogSource<'_>) -> Result<Self, Error> {
        Self::start(source, "")
    }

    /// Builds a simulation that records a waveform of `clk` and all ports, written by Icarus itself: below [`SCOPE`],
    /// four-valued.
    ///
    /// # Errors
    /// Those of [`Self::build`].
    pub fn recording(source: &VerilogSource<'_>) -> Result<Self, Error> {
        Self::start(
            source,
            &format!("    initial begin $dumpfile(\"{WAVES}\"); $dumpvars(1, {SCOPE}); end\n"),
        )
    }

    /// Ends a simulation that was built by [`Self::recording`], and copies its waveform to the file `to`.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written, or nothing was recorded.
    pub fn finish(mut self, to: &Path) -> Result<(), Error> {
        // At the end of its input the testbench ends and closes its file.
        self.to = None;
        let status = self.process.wait();
        status.map_err(|cause| VVP.failed("simulating", "not ended".to_owned(), &cause.to_string()))?;
        std::fs::copy(self.folder.path().join(WAVES), to).map_err(Error::file(to, "copy the waveform to"))?;
        Ok(())
    }

    fn start(source: &VerilogSource<'_>, also: &str) -> Result<Self, Error> {
        let temporary = std::env::temp_dir();
        let folder = scratch::Folder::new(scratch::PREFIX);
        let folder = folder.map_err(Error::file(&temporary, "create a folder in"))?;
        let bench = folder.path().join("bench.v");
        std::fs::write(&bench, testbench(source, also)).map_err(Error::file(&bench, "write"))?;

        let mut compile = ICARUS.command();
        compile.env("TMPDIR", folder.path());
        // Icarus only warns about a port whose width differs, in a text that it uses for no other problem. The code below
        // turns this warning into an error.
        compile
            .args(["-g2005", "-Wall", "-s", SCOPE, "-o"])
            .arg(folder.path().join(PROGRAM))
            .arg(&bench)
            .args(source.files);
        let output = ICARUS.run(&mut compile, "compiling the Verilog")?;
        let said = String::from_utf8_lossy(&output.stderr);
        let bad: Vec<String> = said
            .lines()
            .filter(|line| line.contains("bench.v") && line.to_ascii_lowercase().contains("port "))
            .map(|line| format!("  {line}"))
            .collect();
        if !bad.is_empty() {
            return Err(Error::Ports {
                top: source.top.to_owned(),
                problems: bad,
            });
        }

        let mut run = VVP.command_in(folder.path());
        run.args(["-n", PROGRAM])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = process::start(&mut run).map_err(|cause| VVP.not_started("simulating", &cause))?;
        let patience = Patience::new(tool::answer_limit(), process.killer());
        let pipes = process.child().map(|child| (child.stdin.take(), child.stdout.take()));
        let (to, from) = pipes.unwrap_or_default();
        let Some(from) = from else {
            return Err(VVP.failed("simulating", "no output".to_owned(), ""));
        };
        let outputs = source
            .ports
            .iter()
            .filter(|p| p.direction == Direction::Output)
            .cloned();
        Ok(Self {
            ports: source.ports.to_vec(),
            outputs: outputs.collect(),
            patience,
            process,
            to,
            from: BufReader::new(from),
            line: String::new(),
            unknown: Vec::new(),
            folder,
        })
    }

    fn exchange(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        self.write_inputs(inputs);
        let Self {
            patience,
            to,
            from,
            line,
            ..
        } = self;
        let answer = patience.during(|| answer(to.as_mut(), from, line));
        if patience.expired() {
            return Err(StepError(format!(
                "Icarus did not answer for {} s and was stopped: the Verilog loops without end, or {} is too short",
                tool::answer_limit().as_secs(),
                tool::LIMIT_VARIABLE
            )));
        }
        answer?;
        let values = self.line.strip_prefix(MARK).unwrap_or_default();
        parse(values, &self.outputs, outputs, unknown)
    }

    /// Puts the inputs of a clock into the line.
    fn write_inputs(&mut self, inputs: &[u64]) {
        let widths = self
            .ports
            .iter()
            .filter(|p| p.direction == Direction::Input)
            .map(|p| p.width);
        self.line.clear();
        for (value, width) in inputs.iter().zip(widths) {
            // Writing to a `String` cannot fail.
            let _ = write!(self.line, "{:x} ", value & u64::MAX >> (64 - width.clamp(1, 64)));
        }
        self.line.push('\n');
    }
}

/// Sends the line of inputs, and reads the line of outputs in its place. Lines that the Verilog itself prints may come before
/// ours, which has a mark.
fn answer(to: Option<&mut ChildStdin>, from: &mut BufReader<ChildStdout>, line: &mut String) -> Result<(), StepError> {
    let stopped = |cause: std::io::Error| StepError(format!("Icarus stopped: {cause}"));
    if let Some(to) = to {
        to.write_all(line.as_bytes()).map_err(stopped)?;
    }
    loop {
        line.clear();
        let count = from.by_ref().take(LINE_BYTES).read_line(line).map_err(stopped)?;
        if count == 0 {
            return Err(StepError(
                "Icarus stopped: the Verilog called $finish, or failed".to_owned(),
            ));
        }
        if line.starts_with(MARK) {
            return Ok(());
        }
    }
}

/// Mark at the start of a line of outputs.
const MARK: &str = "posicast-outputs";

fn parse(line: &str, ports: &[Port], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
    let mut values = line.split_whitespace();
    for (at, port) in ports.iter().enumerate() {
        let digits = values.next().unwrap_or_default();
        if digits.len() != port.width as usize {
            return Err(StepError(format!(
                "Icarus: `{digits}` is not a value of output `{}`",
                port.name
            )));
        }
        (outputs[at], unknown[at]) = (0, 0);
        for digit in digits.bytes() {
            outputs[at] = outputs[at] << 1 | u64::from(digit == b'1');
            unknown[at] = unknown[at] << 1 | u64::from(!matches!(digit, b'0' | b'1'));
        }
    }
    Ok(())
}

impl Device for Icarus {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        self.exchange(inputs, outputs, unknown)
    }
}

impl ClockedBlock for Icarus {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let mut unknown = std::mem::take(&mut self.unknown);
        unknown.resize(outputs.len(), 0);
        let result = self.exchange(inputs, outputs, &mut unknown);
        let first = unknown.iter().position(|bits| *bits != 0);
        self.unknown = unknown;
        result?;
        match first {
            Some(at) => Err(StepError(format!(
                "Icarus: output `{}` is x or z",
                self.outputs[at].name
            ))),
            None => Ok(()),
        }
    }
}

/// Returns the tools that Icarus needs and that are not installed.
pub fn missing_tools() -> Vec<MissingTool> {
    [ICARUS, VVP].iter().filter_map(Tool::missing).collect()
}

/// Compiles a testbench with the top module `top` and these files, runs it to its end, and returns its output.
///
/// # Errors
/// [`Error::ToolMissing`] without Icarus; [`Error::ToolFailed`] where it refuses the Verilog.
pub(crate) fn directed(bench: &str, top: &str, files: &[PathBuf]) -> Result<String, Error> {
    let temporary = std::env::temp_dir();
    let folder = scratch::Folder::new(scratch::PREFIX);
    let folder = folder.map_err(Error::file(&temporary, "create a folder in"))?;
    let (file, program) = (folder.path().join("bench.v"), folder.path().join(PROGRAM));
    std::fs::write(&file, bench).map_err(Error::file(&file, "write"))?;
    let mut compile = ICARUS.command();
    compile.env("TMPDIR", folder.path());
    compile.args(["-g2005", "-s", top, "-o"]).arg(&program).arg(&file);
    ICARUS.run(compile.args(files), "compiling the Verilog")?;
    let mut run = VVP.command_in(folder.path());
    let ran = VVP.answer(run.args(["-n", PROGRAM]), "simulating")?;
    Ok(String::from_utf8_lossy(&ran.stdout).into_owned())
}

/// The testbench, with additional text `also`.
fn testbench(source: &VerilogSource<'_>, also: &str) -> String {
    let inputs: Vec<&Port> = source
        .ports
        .iter()
        .filter(|p| p.direction == Direction::Input)
        .collect();
    let outputs: Vec<&Port> = source
        .ports
        .iter()
        .filter(|p| p.direction == Direction::Output)
        .collect();
    let mut declarations = String::new();
    for port in source.ports {
        let kind = if port.direction == Direction::Input {
            "reg"
        } else {
            "wire"
        };
        declarations.push_str(&format!("    {kind} [{}:0] {};\n", port.width.max(1) - 1, port.name));
    }
    let names = |ports: &[&Port]| ports.iter().map(|p| format!(", {}", p.name)).collect::<String>();
    let connections: String = source.ports.iter().map(|p| format!(", .{0}({0})", p.name)).collect();
    format!(
        "`timescale 1ns/1ns\nmodule {SCOPE};\n    reg clk = 0;\n    integer posicast_read;\n{declarations}\
         {also}    {top} posicast_device(.clk(clk){connections});\n    \
         initial begin\n        posicast_read = {count};\n        while (posicast_read == {count}) begin\n            \
         posicast_read = $fscanf(32'h8000_0000, \"{in_format}\"{in_names});\n            \
         if (posicast_read == {count}) begin\n                #1;\n                \
         $display(\"{MARK}{out_format}\"{out_names});\n                $fflush(32'h8000_0001);\n                \
         clk = 1;\n                #1;\n                clk = 0;\n            end\n        end\n        \
         $finish(0);\n    end\nendmodule\n",
        top = source.top,
        count = inputs.len(),
        in_format = " %h".repeat(inputs.len()),
        in_names = names(&inputs),
        out_format = " %b".repeat(outputs.len()),
        out_names = names(&outputs),
    )
}
