//! Runs the engines on a task, each with a time limit, and reads their results.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::names::{formal_top, peeks};
use super::task::{Engine, Task};
use crate::Error;
use crate::tool::{Tool, text};

/// Length in clocks of the longest counterexample that is searched where an engine finds no proof.
pub const SEARCHED_CLOCKS: u32 = 60;
/// Number of clocks in which a cover must be reached: a computation of the controller, and some more.
const COVERED_CLOCKS: u32 = 540;

/// Name of the file with the assertions, and the commands that leave only these.
pub(super) const ASSERTS: (&str, &str) = ("asserts", "delete t:$cover");
/// Name of the file with the covers, and the commands that leave only these.
pub(super) const COVERS: (&str, &str) = ("covers", "delete t:$assert\ntechmap -map reached.v");

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

/// Result for a task's assertions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProofVerdict {
    /// All hold, for all inputs and without a bound.
    Proven,
    /// One does not hold.
    Counterexample {
        /// Name of the assertion.
        property: String,
        /// Clock after power-up in which it fails, from 0.
        clock: u32,
        /// Waveform of the inputs that lead there.
        waveform: PathBuf,
    },
    /// Neither was found within the time limit.
    Unknown,
}

/// A situation of the properties, and whether it can be reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reached {
    /// Name of the cover.
    pub name: String,
    /// The first clock after power-up in which it can hold; `None` if it is not reached in [`SEARCHED_CLOCKS`].
    pub clock: Option<u32>,
}

/// Result of a task.
#[derive(Debug, Clone)]
pub struct ProofOutcome {
    /// Result for its assertions.
    pub verdict: ProofVerdict,
    /// Number of assertions in the property file.
    pub assertions: usize,
    /// Results for its covers.
    pub covers: Vec<Reached>,
    /// Duration.
    pub time: Duration,
}

impl ProofOutcome {
    /// Whether everything is proven and all covers are reached.
    pub fn is_good(&self) -> bool {
        self.verdict == ProofVerdict::Proven && self.covers.iter().all(|cover| cover.clock.is_some())
    }
}

/// Tries to prove a task, with all files in `folder`. `limit` is the time limit of each run of an engine.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys or its ABC; [`Error::ToolFailed`] where Yosys refuses a property file, for
/// example because the block no longer contains a peek; [`Error::File`] where the folder cannot be written.
pub fn run(task: &Task, folder: &Path, limit: Duration) -> Result<ProofOutcome, Error> {
    let start = Instant::now();
    let bench = Bench::new(task, folder, limit)?;
    bench.prepare(&[ASSERTS, COVERS])?;
    let (asserts, covers) = (bench.names("asserts.txt")?, bench.names("covers.txt")?);
    let verdict = if bench.proves(&asserts)? {
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

/// Whether a task's assertions are proven, without a search for a counterexample where they are not.
///
/// # Errors
/// Those of [`run`].
pub fn proves(task: &Task, folder: &Path, limit: Duration) -> Result<bool, Error> {
    let bench = Bench::new(task, folder, limit)?;
    bench.prepare(&[ASSERTS])?;
    bench.proves(&bench.names("asserts.txt")?)
}

/// Searches a counterexample without trying the proof first: for a block that was broken on purpose, for which a
/// proof attempt would only take time. [`ProofVerdict::Unknown`] if there is none in the clocks that are searched.
///
/// # Errors
/// Those of [`run`].
pub fn search(task: &Task, folder: &Path, limit: Duration) -> Result<ProofVerdict, Error> {
    let bench = Bench::new(task, folder, limit)?;
    bench.prepare(&[ASSERTS])?;
    bench.counterexample(&bench.names("asserts.txt")?)
}

struct Bench<'a> {
    task: &'a Task,
    folder: &'a Path,
    limit: Duration,
}

impl<'a> Bench<'a> {
    fn new(task: &'a Task, folder: &'a Path, limit: Duration) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(Error::file(folder, "create"))?;
        Ok(Self { task, folder, limit })
    }

    /// Writes the Verilog, and the engines' input files: one for each of `kinds`.
    fn prepare(&self, kinds: &[(&str, &str)]) -> Result<(), Error> {
        for (name, text) in input_files(self.task, kinds) {
            self.write(&name, &text)?;
        }
        let mut yosys = YOSYS.command_in(self.folder);
        yosys.args(["-q", "prepare.ys"]);
        YOSYS.run(&mut yosys, "reading block and properties").map(drop)
    }

    /// Whether the task's engine proves these assertions; nothing is proven where there is none.
    fn proves(&self, asserts: &[String]) -> Result<bool, Error> {
        match self.task.engine {
            _ if asserts.is_empty() => Ok(false),
            Engine::Pdr => self.pdr(),
            Engine::Induction { clocks } => self.induction(clocks),
        }
    }

    /// Whether PDR proves all assertions together.
    fn pdr(&self) -> Result<bool, Error> {
        Ok(self.abc(&pdr_commands(self.seconds()))?.contains(PDR_PROVES))
    }

    /// Whether the assertions hold at the start, and in each clock after `clocks` clocks in which they did.
    fn induction(&self, clocks: u32) -> Result<bool, Error> {
        self.write("induction.ys", &induction_script(clocks, self.seconds()))?;
        let mut yosys = YOSYS.command_in(self.folder);
        yosys.arg("induction.ys");
        let output = YOSYS.output(&mut yosys, "proving by induction")?;
        Ok(text(&output).contains(INDUCTION_PROVES))
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

    /// The counterexample as played by Yosys's simulator, because ABC's format has no header and no end.
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

    /// Searches the covers one after the other: with several at once, ABC's search crashes on some blocks.
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
        let mut abc = ABC.command_in(self.folder);
        abc.args(["-c", commands]);
        ABC.run(&mut abc, "proving").map(|output| text(&output))
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

/// What ABC prints where PDR has proven everything, and Yosys where induction has.
const PDR_PROVES: &str = "Property proved";
const INDUCTION_PROVES: &str = "Induction step proven: SUCCESS!";

fn pdr_commands(seconds: u64) -> String {
    format!("read_aiger asserts.aig; fold; strash; orpos; pdr -T {seconds}")
}

fn induction_script(clocks: u32, seconds: u64) -> String {
    format!(
        "read_ilang design.il\ndelete t:$cover\n\
         sat -tempinduct -prove-asserts -set-assumes -maxsteps {clocks} -timeout {seconds} formal_top\n"
    )
}

/// A task as files for people who have Yosys and no posicast: those that [`run`] writes, and `prove.sh`, which proves the assertions within
/// `limit`, or says that it did not.
pub fn files(task: &Task, limit: Duration) -> Vec<(String, String)> {
    let seconds = limit.as_secs().max(1);
    let mut files = input_files(task, &[ASSERTS]);
    let (prove, proves) = match task.engine {
        Engine::Pdr => (format!("yosys-abc -c \"{}\"", pdr_commands(seconds)), PDR_PROVES),
        Engine::Induction { clocks } => {
            files.push(("induction.ys".to_owned(), induction_script(clocks, seconds)));
            ("yosys induction.ys".to_owned(), INDUCTION_PROVES)
        }
    };
    let (name, size) = (task.name, task.size.replace('\'', ""));
    let script = format!(
        "#!/bin/sh\n# Proves the assertions of properties.sv for every input, without a bound: {}.\n# It needs Yosys.\nset -eu\n\
         cd \"$(dirname \"$0\")\"\nyosys -q prepare.ys\n{prove} > prove.log\nif grep -q '{proves}' prove.log; then\n    \
         echo 'proven: {name}, {size}'\nelse\n    echo 'not proven: {name}, {size}; see prove.log'\n    exit 1\nfi\n",
        task.engine.name()
    );
    files.push(("prove.sh".to_owned(), script));
    files
}

/// All that Yosys is given for a task, as file names and texts: the Verilog, the properties, the top that joins them, and the
/// script that makes of them the engines' input, one file for each of `kinds`.
pub(super) fn input_files(task: &Task, kinds: &[(&str, &str)]) -> Vec<(String, String)> {
    let mut files = Vec::new();
    let mut script = String::new();
    for module in &task.modules {
        let file = format!("{}.v", module.name);
        let begun = |text: String, (register, value): &(&str, &str)| {
            text.replace(&format!(" {register} = 32'd0;"), &format!(" {register} = {value};"))
        };
        let _ = writeln!(script, "read_verilog {file}");
        files.push((file, task.begins.iter().fold(module.text.clone(), begun)));
    }
    let peeks = peeks(&task.properties);
    let properties = format!("{}_properties", task.name);
    script.push_str(
        "read_verilog -formal -sv properties.sv formal_top.sv\n\
         hierarchy -check -top formal_top\nproc\nflatten\n",
    );
    if task.keeps_memories {
        script.push_str("memory\n");
    }
    // A path that is not in the block is refused: the peek would be free, and nothing could be proven.
    for peek in &peeks {
        let path = format!("formal_top/dut.{}", peek.path);
        let _ = writeln!(script, "select -assert-any {path}\nsetattr -set keep 1 {path}");
    }
    script.push_str("opt_clean\ncd formal_top\n");
    for peek in &peeks {
        let _ = writeln!(script, "connect -set {} dut.{}", peek.name, peek.path);
    }
    script.push_str("cd ..\nsetattr -unset keep formal_top/w:dut.*\n");
    if task.leaves_products_open {
        script.push_str("delete t:$mul\n");
    }
    // Memories are removed: the output of a block RAM is free in every clock.
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
    let top = formal_top(&task.top, &properties, &task.ports, &peeks);
    files.push(("formal_top.sv".to_owned(), top));
    files.push(("properties.sv".to_owned(), task.properties.clone()));
    files.push((
        "reached.v".to_owned(),
        include_str!("../../formal/reached.v").to_owned(),
    ));
    files.push(("prepare.ys".to_owned(), script));
    files
}

/// Outputs and clocks from ABC's messages: `Output 3 of miter "asserts" was asserted in frame 12.`
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
    fn output_and_frame_are_read() {
        let said = "Output 2 of miter \"asserts\" was asserted in frame 12.  Time =     0.63 sec\n\
                    No output asserted in 8 frames.\n";
        assert_eq!(asserted(said).collect::<Vec<_>>(), [(2, 12)]);
    }
}
