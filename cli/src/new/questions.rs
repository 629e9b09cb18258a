//! The questions of `posicast new`, and the effect of their answers.
//!
//! Every answer is put into the file, and the file is checked: an answer that does not fit is reported immediately, and the question is
//! asked again.

use posicast_flow::Failure;
use posicast_flow::design::DesignReport;
use posicast_flow::template::{At, MachineDraft, MachineKind, quoted};
use std::io::{BufRead, Read, Write};
use std::path::Path;

/// Units of a linear axis, and how many of each make a metre.
const LENGTHS: [(&str, f64); 3] = [("m", 1.0), ("mm", 1e3), ("um", 1e6)];
/// Units of a rotary axis, and how many of each make a radian.
const ANGLES: [(&str, f64); 4] = [
    ("rad", 1.0),
    ("mrad", 1e3),
    ("deg", 180.0 / std::f64::consts::PI),
    ("rev", 0.5 / std::f64::consts::PI),
];
/// Longest answer that is read, in bytes: no terminal sends a longer line.
const ANSWER_BYTES: u64 = 4096;

/// Source of the answers, and terminal for the questions.
pub(crate) struct Questions<R, W> {
    answers: R,
    terminal: W,
}

impl<R: BufRead, W: Write> Questions<R, W> {
    /// Asks on `terminal`, and reads from `answers`.
    pub(crate) fn new(answers: R, terminal: W) -> Self {
        Self { answers, terminal }
    }

    /// Asks all questions, and makes the file that `path` will hold.
    pub(crate) fn draft(&mut self, path: &Path) -> Result<MachineDraft, Failure> {
        self.say("Enter takes the value in brackets; all can be changed in the file later.\n")?;
        let kinds = MachineKind::ALL.map(|(_, name)| name);
        let kind = self.word("Kind of machine", &kinds, "gantry")?;
        let kind = MachineKind::ALL.into_iter().find(|(_, name)| *name == kind);
        let kind = kind.map_or(MachineKind::Gantry, |(kind, _)| kind);
        let mut draft = MachineDraft::new(kind, path);
        let name = draft.name().to_owned();
        draft = self.change(&draft, "Name of the machine", &name, |draft, answer| {
            Ok(draft.with(At::Top, "name", &quoted(answer)))
        })?;
        let axes = draft.machine().map_err(Failure::from)?.axes;
        for (index, axis) in axes.iter().enumerate() {
            let units: &[(&str, f64)] = if kind.turns() { &ANGLES } else { &LENGTHS };
            let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
            let unit = self.word(&format!("Axis {}: unit of its position", axis.name), &names, names[0])?;
            let per_unit = units
                .iter()
                .find(|(name, _)| *name == unit)
                .map_or(1.0, |(_, many)| *many);
            let default = (axis.counts_per_unit / per_unit).to_string();
            let question = format!("Axis {}: counts per {unit}", axis.name);
            draft = self.change(&draft, &question, &default, |draft, answer| {
                let counts = number(answer)? * per_unit;
                Ok(draft.with(At::Axis(index), "counts_per_unit", &counts.to_string()))
            })?;
            for (key, what) in [
                ("frequency_hz", "frequency of its first mode, Hz"),
                ("damping", "damping ratio of this mode"),
            ] {
                let default = draft.value(At::FirstMode(index), key).to_owned();
                let question = format!("Axis {}: {what}", axis.name);
                draft = self.change(&draft, &question, &default, |draft, answer| {
                    Ok(draft.with(At::FirstMode(index), key, &number(answer)?.to_string()))
                })?;
            }
        }
        Ok(draft)
    }

    /// Asks until an answer fits, and returns the file with it.
    fn change(
        &mut self,
        draft: &MachineDraft,
        question: &str,
        default: &str,
        put: impl Fn(&MachineDraft, &str) -> Result<MachineDraft, String>,
    ) -> Result<MachineDraft, Failure> {
        loop {
            let answer = self.ask(question, default)?;
            if answer == default {
                return Ok(draft.clone());
            }
            let changed = put(draft, &answer).and_then(|changed| fits(&changed).map(|()| changed));
            match changed {
                Ok(changed) => return Ok(changed),
                Err(problem) => self.say(&format!("  {problem}\n"))?,
            }
        }
    }

    /// Asks for one of a list of words.
    fn word(&mut self, question: &str, words: &[&str], default: &str) -> Result<String, Failure> {
        let list = words.join(", ");
        loop {
            let answer = self.ask(&format!("{question}: {list}"), default)?;
            if words.contains(&answer.as_str()) {
                return Ok(answer);
            }
            self.say(&format!("  found `{}`; allowed: {list}\n", answer.escape_debug()))?;
        }
    }

    /// Asks a question; returns the default for an empty answer. The end of the input is an error, because nobody has confirmed the
    /// remaining values.
    fn ask(&mut self, question: &str, default: &str) -> Result<String, Failure> {
        self.say(&format!("{question} [{default}]: "))?;
        let mut line = Vec::new();
        let read = (&mut self.answers).take(ANSWER_BYTES).read_until(b'\n', &mut line);
        if read.map_err(Failure::of_file(Path::new("standard input"), "read it"))? == 0 {
            self.say("\n")?;
            let ended = Failure::input("the answers ended before the last question; no file was written");
            return Err(ended.with_help(
                "answer all questions (Enter takes the value in brackets), or name the kind: --gantry, --printer, --joint or --crane",
            ));
        }
        match String::from_utf8_lossy(&line).trim() {
            "" => Ok(default.to_owned()),
            answer => Ok(answer.to_owned()),
        }
    }

    fn say(&mut self, text: &str) -> Result<(), Failure> {
        let said = self
            .terminal
            .write_all(text.as_bytes())
            .and_then(|()| self.terminal.flush());
        said.map_err(Failure::of_file(Path::new("standard error"), "write it"))
    }
}

/// Parses a finite number.
fn number(answer: &str) -> Result<f64, String> {
    let number = answer.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("found `{}`; allowed: a number, such as 47.5", answer.escape_debug()))
}

/// Checks that the file can be built; the error contains the problems with their remedies.
fn fits(draft: &MachineDraft) -> Result<(), String> {
    let machine = draft.machine().map_err(|error| {
        let lines = error.problems().iter().map(|problem| {
            let cause = problem.cause.to_string();
            if cause.contains(&problem.remedy) {
                format!("{}: {cause}", problem.key)
            } else {
                format!("{}: {cause}; {}", problem.key, problem.remedy)
            }
        });
        lines.collect::<Vec<_>>().join("\n  ")
    })?;
    let path = Path::new("answer");
    let built = DesignReport::new(&machine, path).and_then(|report| report.check_shapers());
    built.map_err(|failure| match failure {
        Failure::Input(problem) | Failure::MissingTool(problem) => problem.message,
        Failure::Check(line) => line,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(answers: &str) -> (MachineDraft, String) {
        let mut terminal = Vec::new();
        let draft = Questions::new(answers.as_bytes(), &mut terminal).draft(Path::new("mill.toml"));
        let draft = draft.map_err(|_| "failed").unwrap();
        (draft, String::from_utf8(terminal).unwrap())
    }

    #[test]
    fn answers_are_in_the_file_in_its_own_unit() {
        let (draft, said) = answered("joint\nshoulder\nrev\n10000\n7.5\n0.02\n");
        let machine = draft.machine().unwrap();
        assert_eq!((machine.name.as_str(), machine.axes.len()), ("shoulder", 1));
        let axis = &machine.axes[0];
        assert!((axis.counts_per_unit - 10_000.0 / std::f64::consts::TAU).abs() < 1e-9);
        assert_eq!(
            (axis.modes[0].mode.frequency_hz, axis.modes[0].mode.damping),
            (7.5, 0.02)
        );
        assert!(said.contains("Axis elbow: counts per rev [1048575.6"), "{said}");
    }

    #[test]
    fn enter_takes_the_defaults() {
        let (draft, _) = answered(&"\n".repeat(12));
        assert_eq!(
            draft.text(),
            MachineDraft::new(MachineKind::Gantry, Path::new("mill.toml")).text()
        );
    }

    #[test]
    fn the_end_of_the_input_leaves_no_file() {
        for answers in ["", "\n\n", "gantry\n", "1\n"] {
            let mut questions = Questions::new(answers.as_bytes(), Vec::new());
            assert!(questions.draft(Path::new("mill.toml")).is_err(), "{answers:?}");
        }
    }

    #[test]
    fn invalid_answers_are_reported_and_asked_again() {
        let (draft, said) = answered("lathe\ncrane\nwire\nhoist\nkm\nmm\nmany\n20\n1e9\n0.25\n1.5\n0.02\n");
        for message in [
            "found `lathe`; allowed: printer, cnc, gantry, joint, crane",
            "name: found \"wire\"; allowed: [a-z]",
            "found `km`; allowed: m, mm, um",
            "found `many`; allowed: a number",
            "axis.mode.frequency_hz: found 1000000000; allowed: below 50 Hz",
            "axis.mode.damping: found 1.5; allowed: at least 0, below 1",
        ] {
            assert!(said.contains(message), "{message} is not in\n{said}");
        }
        let machine = draft.machine().unwrap();
        let axis = &machine.axes[0];
        assert_eq!(machine.name, "hoist");
        assert_eq!(axis.counts_per_unit, 20_000.0);
        assert_eq!(
            (axis.modes[0].mode.frequency_hz, axis.modes[0].mode.damping),
            (0.25, 0.02)
        );
    }
}
