//! The default of what a run must have exercised: both levels of every flag at the block's ports.
//!
//! It is measured during the run, from the model's outputs. A flag is an output of one bit. A flag that stayed at one
//! level has not been compared: a wire that is tied to that level would be equal. So it counts as not exercised, unless
//! the block says that it cannot change as it is built ([`super::Block::fixed`]). Bits of wider outputs that never
//! changed are only listed, because the upper bits of a counter take longer than any run.

use posicast_blocks::{Direction, Port};

use super::Exercise;
use crate::lockstep::Clock;

/// An output, and masks of its bits that were 1, and that were 0.
#[derive(Debug, Clone)]
struct Seen {
    name: String,
    width: u32,
    ones: u64,
    zeros: u64,
    fixed: bool,
}

/// Levels that the outputs of a block have had so far.
#[derive(Debug, Clone)]
pub(crate) struct Levels {
    instance: String,
    outputs: Vec<Seen>,
}

impl Levels {
    /// Creates an empty record for the row `instance` of a block with these ports; `fixed` lists outputs that cannot
    /// change.
    pub(crate) fn new(instance: &str, ports: &[Port], fixed: &[(String, &'static str)]) -> Self {
        let outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let seen = |port: &Port| Seen {
            name: port.name.clone(),
            width: port.width,
            ones: 0,
            zeros: 0,
            fixed: fixed.iter().any(|(name, _)| *name == port.name),
        };
        Self {
            instance: instance.to_owned(),
            outputs: outputs.map(seen).collect(),
        }
    }
}

impl Exercise for Levels {
    fn observe(&mut self, clock: &Clock<'_>) {
        for (seen, value) in self.outputs.iter_mut().zip(clock.expected) {
            seen.ones |= value;
            seen.zeros |= !value;
        }
    }

    fn missing(&self) -> Vec<(String, String)> {
        let flags = self.outputs.iter().filter(|seen| seen.width == 1 && !seen.fixed);
        let levels = flags.flat_map(|seen| {
            let levels = [(0, seen.zeros), (1, seen.ones)].into_iter();
            let missing = levels.filter(|(_, seen)| seen & 1 == 0);
            missing.map(|(level, _)| (self.instance.clone(), format!("`{}` = {level}", seen.name)))
        });
        levels.collect()
    }

    fn unchanged(&self) -> Vec<(String, String)> {
        let words = self.outputs.iter().filter(|seen| seen.width > 1);
        let bits = words.filter_map(|seen| {
            let still = !(seen.ones & seen.zeros) & (u64::MAX >> (64 - seen.width.clamp(1, 64)));
            (still != 0).then(|| (self.instance.clone(), format!("{}[{}]", seen.name, ranges(still))))
        });
        bits.collect()
    }
}

/// Formats the ones of a word as ranges: `31:20, 3`.
fn ranges(bits: u64) -> String {
    let mut text = Vec::new();
    let mut high = 64;
    while high > 0 {
        high -= 1;
        if bits >> high & 1 == 0 {
            continue;
        }
        let length = (bits << (63 - high)).leading_ones();
        let low = high + 1 - length;
        text.push(if low == high {
            high.to_string()
        } else {
            format!("{high}:{low}")
        });
        high = low;
    }
    text.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watched(fixed: &[(String, &'static str)], clocks: &[[u64; 3]]) -> Levels {
        let port = |(name, width): (&str, u32)| Port {
            name: name.to_owned(),
            direction: Direction::Output,
            width,
            signed: false,
        };
        let ports = [("high", 1), ("low", 1), ("word", 8)].map(port);
        let mut levels = Levels::new("x", &ports, fixed);
        for expected in clocks {
            levels.observe(&Clock {
                time: 0,
                inputs: &[0],
                expected,
                actual: expected,
                inside: None,
            });
        }
        levels
    }

    fn names(rows: Vec<(String, String)>) -> Vec<String> {
        rows.into_iter().map(|(_, what)| what).collect()
    }

    #[test]
    fn a_flag_that_stays_at_a_level_is_missing_unless_it_cannot_change() {
        let clocks = [[1, 0, 0x81], [1, 0, 0x80]];
        assert_eq!(names(watched(&[], &clocks).missing()), ["`high` = 0", "`low` = 1"]);
        let fixed = [("high".to_owned(), "tied")];
        assert_eq!(names(watched(&fixed, &clocks).missing()), ["`low` = 1"]);
        assert_eq!(names(watched(&[], &[[1, 0, 0], [0, 1, 0]]).missing()), [""; 0]);
    }

    #[test]
    fn bits_of_words_are_named_in_ranges() {
        assert_eq!(
            names(watched(&[], &[[0, 0, 0x81], [0, 0, 0x80]]).unchanged()),
            ["word[7:1]"]
        );
        assert_eq!(
            names(watched(&[], &[[0, 0, 0x81], [0, 0, 0x38]]).unchanged()),
            ["word[6, 2:1]"]
        );
        assert_eq!(ranges(u64::MAX), "63:0");
    }
}
