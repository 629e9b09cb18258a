//! The templates of machine files, and the replacement of values in them.

use posicast_machine::machine_file::{self, Machine};
use posicast_machine::unit::AxisUnit;
use std::path::Path;

/// Kind of machine that a template is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineKind {
    /// Two belt axes with stepper motors.
    Printer,
    /// Three screw axes with stepper motors.
    Cnc,
    /// Two linear axes with encoder, drive and controller.
    Gantry,
    /// A rotary axis with encoder, drive and controller.
    Joint,
    /// A trolley with a swinging load.
    Crane,
}

impl MachineKind {
    /// Every kind with its name.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Printer, "printer"),
        (Self::Cnc, "cnc"),
        (Self::Gantry, "gantry"),
        (Self::Joint, "joint"),
        (Self::Crane, "crane"),
    ];

    fn template(self) -> &'static str {
        match self {
            Self::Printer => include_str!("template/printer.toml"),
            Self::Cnc => include_str!("template/cnc.toml"),
            Self::Gantry => include_str!("template/gantry.toml"),
            Self::Joint => include_str!("template/joint.toml"),
            Self::Crane => include_str!("template/crane.toml"),
        }
    }

    /// Description of the machine.
    pub fn about(self) -> &'static str {
        match self {
            Self::Printer => "a 3D printer with two belt axes and step lines",
            Self::Cnc => "a CNC router with three screw axes and step lines",
            Self::Gantry => "a gantry or XY stage with two linear axes in closed loop",
            Self::Joint => "a rotary joint in closed loop",
            Self::Crane => "a crane with a swinging load, shaper only",
        }
    }

    /// Whether its axes are rotary, with the radian as their unit.
    pub fn turns(self) -> bool {
        self.unit() == AxisUnit::Radian
    }

    /// Unit of its axes.
    pub fn unit(self) -> AxisUnit {
        match self {
            Self::Printer | Self::Cnc | Self::Gantry | Self::Crane => AxisUnit::Metre,
            Self::Joint => AxisUnit::Radian,
        }
    }
}

/// Table of a machine file that contains a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// Before the first table.
    Top,
    /// `[[axis]]` with this index, from 0.
    Axis(usize),
    /// The first `[[axis.mode]]` of the axis with this index.
    FirstMode(usize),
}

/// A machine file that is being written.
#[derive(Debug, Clone)]
pub struct MachineDraft {
    kind: MachineKind,
    text: String,
}

impl MachineDraft {
    /// Creates a draft from the template. The machine gets the name of the file if that is a valid name.
    pub fn new(kind: MachineKind, file: &Path) -> Self {
        let draft = Self {
            kind,
            text: kind.template().to_owned(),
        };
        let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let named = draft.with(At::Top, "name", &quoted(&stem.to_lowercase().replace(['-', ' '], "_")));
        match named.machine() {
            Ok(_) => named,
            Err(_) => draft,
        }
    }

    /// The kind of its template.
    pub fn kind(&self) -> MachineKind {
        self.kind
    }

    /// Text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Name of the machine.
    pub fn name(&self) -> &str {
        self.value(At::Top, "name").trim_matches('"')
    }

    /// The machine that the file describes.
    ///
    /// # Errors
    /// The errors of the machine file's reader.
    pub fn machine(&self) -> Result<Machine, machine_file::SpecError> {
        machine_file::parse("answer", &self.text)
    }

    /// Returns the value of a key as it is written in the file; empty if there is none.
    pub fn value(&self, at: At, key: &str) -> &str {
        self.place(at, key).map_or("", |place| &self.text[place])
    }

    /// Returns the file with another value; its comment stays in its column if there is room.
    pub fn with(&self, at: At, key: &str, value: &str) -> Self {
        let mut text = self.text.clone();
        if let Some(place) = self.place(at, key) {
            let comment = self.text[place.end..].find(|c| c != ' ').unwrap_or(0);
            let width = place.len() + comment;
            let padded = if self.text[place.end + comment..].starts_with('#') {
                format!("{value:width$}", width = width.max(value.chars().count() + 1))
            } else {
                value.to_owned()
            };
            text.replace_range(place.start..place.end + comment, &padded);
        }
        Self { kind: self.kind, text }
    }

    /// Range of a key's value in the text.
    fn place(&self, at: At, key: &str) -> Option<std::ops::Range<usize>> {
        let (mut here, mut axes) = (Some(At::Top), 0);
        let mut start = 0;
        for line in self.text.split_inclusive('\n') {
            let words = line.trim();
            if words == "[[axis]]" {
                here = Some(At::Axis(axes));
                axes += 1;
            } else if words.starts_with("[[axis.mode]]") {
                let first = matches!(here, Some(At::Axis(_)) | None) && axes > 0;
                here = first.then(|| At::FirstMode(axes - 1));
            } else if words.starts_with('[') {
                here = None;
            }
            let value = line.strip_prefix(key).and_then(|rest| rest.strip_prefix(" = "));
            if let Some(value) = value.filter(|_| here == Some(at)) {
                let length = value.find(" #").unwrap_or(value.len());
                let length = value[..length].trim_end().len();
                let first = start + line.len() - value.len();
                return Some(first..first + length);
            }
            start += line.len();
        }
        None
    }
}

/// This word marks the lines that the user has to fill in.
const MARK: &str = "MEASURE";

/// Describes what remains to be measured for a machine file, as an introduction to the next command; empty if nothing
/// remains.
pub fn to_measure(text: &str) -> String {
    let is_marked = |line: &&str| line.contains(&format!("# {MARK}"));
    match text.lines().filter(is_marked).count() {
        0 => String::new(),
        1 => format!("put your value in the line that says {MARK}, then "),
        marked => format!("put your values in the {marked} lines that say {MARK}, then "),
    }
}

/// Returns a text in TOML quotes. Characters that TOML would have to escape are left out, because no name contains
/// them.
pub fn quoted(text: &str) -> String {
    let plain: String = text
        .chars()
        .filter(|c| !c.is_control() && !"\"\\".contains(*c))
        .collect();
    format!("\"{plain}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_is_a_machine_file_with_the_name_of_its_file() {
        for (kind, name) in MachineKind::ALL {
            let draft = MachineDraft::new(kind, Path::new("/a/folder/My-machine.toml"));
            let machine = draft.machine().unwrap();
            assert_eq!(machine.name, "my_machine", "{name}");
            assert_eq!(draft.name(), "my_machine");
            assert!(machine.axes.iter().all(|axis| axis.unit == kind.unit()), "{name}");
            for no_name in ["", "wire.toml", "1.toml", "-"] {
                let draft = MachineDraft::new(kind, Path::new(no_name));
                assert_eq!(draft.text(), kind.template(), "{no_name}");
            }
        }
    }

    #[test]
    fn only_the_value_of_a_key_is_replaced() {
        for (kind, name) in MachineKind::ALL {
            let draft = MachineDraft::new(kind, Path::new("machine.toml"));
            let mut machine = draft.machine().unwrap();
            for index in 0..machine.axes.len() {
                let changed = draft
                    .with(At::Axis(index), "counts_per_unit", "12345.5")
                    .with(At::FirstMode(index), "frequency_hz", "3.25")
                    .with(At::FirstMode(index), "damping", "0.125");
                let axis = &mut machine.axes[index];
                let before = axis.clone();
                axis.counts_per_unit = 12345.5;
                axis.modes[0].mode.frequency_hz = 3.25;
                axis.modes[0].mode.damping = 0.125;
                assert_eq!(changed.machine().unwrap(), machine, "{name}");
                assert_eq!(changed.text().lines().count(), draft.text().lines().count());
                machine.axes[index] = before;
            }
        }
    }

    #[test]
    fn comments_stay_in_their_column() {
        let draft = MachineDraft::new(MachineKind::Crane, Path::new("crane.toml"));
        let column = |draft: &MachineDraft| {
            let line = draft
                .text()
                .lines()
                .find(|line| line.starts_with("frequency_hz = 0."))?;
            line.find('#')
        };
        let changed = draft.with(At::FirstMode(0), "frequency_hz", "0.3125");
        assert!(column(&draft).is_some());
        assert_eq!(column(&draft), column(&changed));
    }
}
