//! Runs the engines on a task, each under a time limit, and reads what they say.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::names::{formal_top, peeks};
use super::task::{Engine, Task};
use crate::Error;
use crate::tool::{Tool, text};

/// Longest counterexample that is searched for where an engine proves nothing, in clocks.
pub const SEARCHED_CLOCKS: u32 = 60;
/// Clocks in which a cover must be reached: a pass of the controller, and some.
const COVERED_CLOCKS: u32 = 540;

/// Name of the file with the assertions, and how they are left over.
const ASSERTS: (&str, &str) = ("asserts", "delete t:$cover");
/// The same of the covers.
const COVERS: (&str, &str) = ("covers", "delete t:$assert\ntechmap -map reached.v");

pub(crate) const YOSYS: Tool = Tool {
    name: "yosys",
    variable: "POSICAST_YOSYS",
    purpose: "reads blocks and properties, proves by induction, makes mutants",
    remedy: "Install it (Debian: apt-get install --no-install-recommends yosys), or name it in POSICAST_YOSYS",
};

pub(crate) const ABC: Tool = Tool {
    name: "yosys-abc",
    variable: "POSICAST_YOSYS_ABC",
    purpose: "proves without invariants, finds counterexamples and covers",
    remedy: "It comes with Yosys (Debian: apt-get install --no-install-recommends yosys), or name it in POSICAST_YOSYS_ABC",
};

/// What is known of a task's assertions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProofVerdict {
    /// All hold, for all inputs and for ever.
    Proven,
    /// One does not hold.
    Counterexample {
        /// The assertion.
        property: String,
        /// The clock after power-up in which it fails, from 0.
        clock: u32,
        /// What leads there.
        waveform: PathBuf,
    },
    /// Neither within the time limit.
    Unknown,
}

/// A situation that properties speak of, and whether it happens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reached {
    /// The cover.
    pub name: String,
    /// The first clock after power-up in which it can hold; none: not reached in [`SEARCHED_CLOCKS`].
    pub clock: Option<u32>,
}

/// A task that has been tried.
#[derive(Debug, Clone)]
pub struct ProofOutcome {
    /// What is known.
    pub verdict: ProofVerdict,
    /// Assertions in the property file.
    pub assertions: usize,
    /// Its covers.
    pub covers: Vec<Reached>,
    /// What it took.
    pub time: Duration,
}

impl ProofOutcome {
    /// Proven, with all covers reached.
    pub fn is_good(&self) -> bool {
        self.verdict == ProofVerdict::Proven && self.covers.iter().all(|cover| cover.clock.is_some())
    }
}

/// Tries to prove a task, with all files in `folder`. `limit` is for each run of an engine.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys or its ABC; [`Error::ToolFailed`] where Yosys refuses a property file, for example
/// because a peek is no longer in the block; [`Error::File`] where the folder cannot be written.
pub fn run(task: &Task, folder: &Path, limit: Duration) -> Result<ProofOutcome, Error> {
    let start = Instant::now();
    std::fs::create_dir_all(folder).map_err(Error::file(folder, "create"))?;
    let bench = Bench { task, folder, limit };
    bench.prepare(&[ASSERTS, COVERS])?;
    let (asserts, covers) = (bench.names("asserts.txt")?, bench.names("covers.txt")?);
    let is_proven = match task.engine {
        _ if asserts.is_empty() => false,
        Engine::Pdr => bench.pdr()?,
        Engine::Induction { clocks } => bench.induction(clocks)?,
    };
    let verdict = if is_proven {
        ProofVerdict::Proven
    } else {
        bench.counterexample(&asserts)?
    };
    Ok(ProofOutcome {
        verdict,
        assertions: asserts.len(),
        covers: bench.covers(covers)?,
        time: start.elapsed(),
    })
}

/// Searches for a counterexample without trying the proof first: for a block that was broken on purpose, of which the proof
/// would only find late that it cannot be. [`ProofVerdict::Unknown`] where there is none in the clocks that are searched.
///
/// # Errors
/// As [`run`].
pub fn search(task: &Task, folder: &Path, limit: Duration) -> Result<ProofVerdict, Error> {
    std::fs::create_dir_all(folder).map_err(Error::file(folder, "create"))?;
    let bench = Bench { task, folder, limit };
    bench.prepare(&[ASSERTS])?;
    bench.counterexample(&bench.names("asserts.txt")?)
}

struct Bench<'a> {
    task: &'a Task,
    folder: &'a Path,
    limit: Duration,
}

impl Bench<'_> {
    /// Writes the Verilog, and what the engines read: a file for each of `kinds`.
    fn prepare(&self, kinds: &[(&str, &str)]) -> Result<(), Error> {
        let mut script = String::new();
        for module in &self.task.modules {
            let file = format!("{}.v", module.name);
            let begun = |text: String, (register, value): &(&str, &str)| {
                text.replace(&format!(" {register} = 32'd0;"), &format!(" {register} = {value};"))
            };
            let text = self.task.begins.iter().fold(module.text.clone(), begun);
            self.write(&file, &text)?;
            let _ = writeln!(script, "read_verilog {file}");
        }
        let peeks = peeks(&self.task.properties);
        let properties = format!("{}_properties", self.task.name);
        self.write("properties.sv", &self.task.properties)?;
        self.write("reached.v", include_str!("../../formal/reached.v"))?;
        self.write(
            "formal_top.sv",
            &formal_top(&self.task.top, &properties, &self.task.ports, &peeks),
        )?;
        script.push_str(
            "read_verilog -formal -sv properties.sv formal_top.sv\n\
             hierarchy -check -top formal_top\nproc\nflatten\n",
        );
        if self.task.keeps_memories {
            script.push_str("memory\n");
        }
        // A path that is not in the block is refused: the peek would be free, and no proof possible.
        for peek in &peeks {
            let path = format!("formal_top/dut.{}", peek.path);
            let _ = writeln!(script, "select -assert-any {path}\nsetattr -set keep 1 {path}");
        }
        script.push_str("opt_clean\ncd formal_top\n");
        for peek in &peeks {
            let _ = writeln!(script, "connect -set {} dut.{}", peek.name, peek.path);
        }
        script.push_str("cd ..\nsetattr -unset keep formal_top/w:dut.*\n");
        // Without its memories: what is read from a block RAM is anything, in every clock.
        let multipliers = if self.task.leaves_products_open {
            "delete t:$mul\n"
        } else {
            ""
        };
        script.push_str(multipliers);
        script.push_str(
            "memory -nomap\ndelete t:$mem_v2\nasync2sync\nsetundef -undriven -anyseq\nopt\ndffunmap\nopt_clean\n\
             write_ilang design.il\ndesign -save whole\n",
        );
        let bits = "delete -output\ntechmap\nopt -fast\ndffunmap\nabc -g AND -fast\nopt_clean\n";
        for (name, only) in kinds {
            let _ = write!(
                script,
                "design -load whole\n{only}\n{bits}tee -o {name}.txt select -list t:$assert\n\
                 write_aiger -I -B -zinit -no-startoffset -map {name}.aim {name}.aig\n"
            );
        }
        self.write("prepare.ys", &script)?;
        let mut yosys = YOSYS.command_in(self.folder);
        yosys.args(["-q", "prepare.ys"]);
        YOSYS.run(&mut yosys, "reading block and properties").map(drop)
    }

    /// Whether PDR proves the assertions together.
    fn pdr(&self) -> Result<bool, Error> {
        let commands = format!("read_aiger asserts.aig; fold; strash; orpos; pdr -T {}", self.seconds());
        Ok(self.abc(&commands)?.contains("Property proved"))
    }

    /// Whether they hold at the start, and in each clock after so many in which they did.
    fn induction(&self, clocks: u32) -> Result<bool, Error> {
        let script = format!(
            "read_ilang design.il\ndelete t:$cover\n\
             sat -tempinduct -prove-asserts -set-assumes -maxsteps {clocks} -timeout {} formal_top\n",
            self.seconds()
        );
        self.write("induction.ys", &script)?;
        let mut yosys = YOSYS.command_in(self.folder);
        yosys.arg("induction.ys");
        let output = YOSYS.output(&mut yosys, "proving by induction")?;
        Ok(text(&output).contains("Induction step proven: SUCCESS!"))
    }

    fn counterexample(&self, asserts: &[String]) -> Result<ProofVerdict, Error> {
        let commands = format!(
            "read_aiger asserts.aig; fold; strash; bmc3 -F {SEARCHED_CLOCKS} -T {}; write_cex -a counterexample.txt",
            self.seconds()
        );
        let Some((output, clock)) = asserted(&self.abc(&commands)?).next() else {
            return Ok(ProofVerdict::Unknown);
        };
        Ok(ProofVerdict::Counterexample {
            property: asserts.get(output).cloned().unwrap_or_default(),
            clock,
            waveform: self.waveform(output)?,
        })
    }

    /// The counterexample as Yosys's simulator plays it: ABC's form of it has no head and no end.
    fn waveform(&self, output: usize) -> Result<PathBuf, Error> {
        let path = self.folder.join("counterexample.txt");
        let found = std::fs::read_to_string(&path).map_err(Error::file(&path, "read"))?;
        let rows: Vec<&str> = found.lines().filter(|row| !row.is_empty()).collect();
        self.write("counterexample.aiw", &format!("1\nb{output}\n{}\n.\n", rows.join("\n")))?;
        self.write(
            "counterexample.ys",
            "read_ilang design.il\nsim -r counterexample.aiw -map asserts.aim -clock clk -vcd counterexample.vcd\n",
        )?;
        let mut yosys = YOSYS.command_in(self.folder);
        yosys.args(["-q", "counterexample.ys"]);
        YOSYS.run(&mut yosys, "playing a counterexample")?;
        Ok(self.folder.join("counterexample.vcd"))
    }

    /// One after the other: with several at once, ABC's search crashes on some blocks.
    fn covers(&self, names: Vec<String>) -> Result<Vec<Reached>, Error> {
        let search = |(output, name)| {
            let commands = format!(
                "read_aiger covers.aig; fold; strash; cone -s -O {output}; bmc3 -F {COVERED_CLOCKS} -T {}",
                self.seconds()
            );
            let said = self.abc(&commands)?;
            let clock = asserted(&said).next().map(|(_, clock)| clock);
            Ok(Reached { name, clock })
        };
        names.into_iter().enumerate().map(search).collect()
    }

    fn abc(&self, commands: &str) -> Result<String, Error> {
        abc(self.folder, commands, "proving")
    }

    /// The labels of assertions or covers, in the order of ABC's outputs.
    fn names(&self, file: &str) -> Result<Vec<String>, Error> {
        let path = self.folder.join(file);
        let list = std::fs::read_to_string(&path).map_err(Error::file(&path, "read"))?;
        let label = |line: &str| line.rsplit(['/', '.']).next().unwrap_or(line).to_owned();
        Ok(list.lines().filter(|line| !line.is_empty()).map(label).collect())
    }

    fn write(&self, file: &str, text: &str) -> Result<(), Error> {
        let path = self.folder.join(file);
        std::fs::write(&path, text).map_err(Error::file(&path, "write"))
    }

    fn seconds(&self) -> u64 {
        self.limit.as_secs().max(1)
    }
}

/// What ABC says to these commands, with `folder` as its own.
pub(crate) fn abc(folder: &Path, commands: &str, doing: &'static str) -> Result<String, Error> {
    let mut abc = ABC.command_in(folder);
    abc.args(["-c", commands]);
    ABC.run(&mut abc, doing).map(|output| text(&output))
}

/// Outputs and clocks in ABC's words: `Output 3 of miter "asserts" was asserted in frame 12.`
pub(crate) fn asserted(said: &str) -> impl Iterator<Item = (usize, u32)> + '_ {
    let number = |word: Option<&str>| word?.trim_matches(|c: char| !c.is_ascii_digit()).parse().ok();
    said.lines()
        .filter(|line| line.contains("asserted in frame"))
        .filter_map(move |line| {
            let output: u32 = number(line.split("Output ").nth(1)?.split_whitespace().next())?;
            let frame = number(line.split("in frame").nth(1)?.split_whitespace().next())?;
            Some((usize::try_from(output).ok()?, frame))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_output_and_frame_are_read() {
        let said = "Output 2 of miter \"asserts\" was asserted in frame 12.  Time =     0.63 sec\n\
                    No output asserted in 8 frames.\n";
        assert_eq!(asserted(said).collect::<Vec<_>>(), [(2, 12)]);
    }
}
