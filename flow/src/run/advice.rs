//! The likely cause of a failed check, and a remedy.

use crate::run::checks::{Check, Coverage};

/// A likely cause, and two things to try.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Advice {
    /// The cause.
    pub cause: &'static str,
    /// What to try, the first first.
    pub remedies: [&'static str; 2],
}

/// Advice by the beginning of a check's name.
const ADVICE: [(&str, Advice); 20] = [
    (
        "the capture line takes the position",
        Advice {
            cause: "the filter of the line is longer than the touch lasts, or the axis does not move",
            remedies: [
                "lower `filter_s` of [capture]",
                "look at the check of the axis's moves first",
            ],
        },
    ),
    (
        "a position compare gives",
        Advice {
            cause: "the axis does not come to its positions, or its encoder jitters over more than half their distance",
            remedies: [
                "let `first`, `spacing` and `positions` of [axis.compare] lie within the travel",
                "raise `spacing`, or the counts per unit of the encoder",
            ],
        },
    ),
    (
        "an axis homed by its probe",
        Advice {
            cause: "the contact is not found within the search, or the motor loses steps on the way to it",
            remedies: [
                "make `within` of [axis.probe] longer than the way to the contact",
                "lower `velocity` and `slow_velocity` of [axis.probe]",
            ],
        },
    ),
    (
        "the command moves every axis",
        Advice {
            cause: "counts_per_unit is meant for another unit, or the command stands still",
            remedies: [
                "write counts_per_unit for the axis's unit: 1 µm per count is 1_000_000 per m",
                "give a `--command` that moves the axis by many counts",
            ],
        },
    ),
    (
        "RustHDL description equals",
        Advice {
            cause: "a fault of posicast: description and model of a block differ",
            remedies: [
                "run `posicast verify` with the same `--seed`, and report its first difference",
                "run `posicast doctor`, and install the missing tools",
            ],
        },
    ),
    (
        "RTL equals",
        Advice {
            cause: "the Verilog was changed by hand, or a fault of posicast",
            remedies: [
                "generate into an empty folder and run again",
                "run `posicast verify` with the same `--seed`, and report its first difference",
            ],
        },
    ),
    (
        "wave/rtl.vcd equals",
        Advice {
            cause: "the command has no samples, or the Verilog differs from the model on it",
            remedies: [
                "give a `--command` with at least two points at different times",
                "compare with `posicast diff` of wave/model.vcd and wave/rtl.vcd",
            ],
        },
    ),
    (
        "RTL stays within the rounding",
        Advice {
            cause: "the command is beyond the command word and saturates",
            remedies: [
                "shorten the command, or use coarser counts_per_unit",
                "raise command_bits, or lower command_fraction",
            ],
        },
    ),
    (
        "integer taps keep the residual",
        Advice {
            cause: "coefficients with too few fraction bits",
            remedies: [
                "leave coefficient_fraction out",
                "lower sample_hz, so that fewer taps are small",
            ],
        },
    ),
    (
        "the integer taps keep the tolerance",
        Advice {
            cause: "the coefficients have too few fraction bits, or the shaper is not made for the mode",
            remedies: [
                "leave coefficient_fraction out, or raise sample_hz",
                "choose another kind, or raise the mode's tolerance",
            ],
        },
    ),
    (
        "Verilog is clean",
        Advice {
            cause: "this version of Verilator has other warnings than the one with which posicast is tested",
            remedies: [
                "run `posicast doctor`, and install the version that it names",
                "report the warning with the machine file",
            ],
        },
    ),
    (
        "the top module",
        Advice {
            cause: "the device that [target] names is too small",
            remedies: [
                "name a larger family or board in [target]",
                "choose a kind of shaper with fewer impulses, or a lower sample_hz, for shorter delay lines",
            ],
        },
    ),
    (
        "the stage's RTL equals",
        Advice {
            cause: "the Verilog was changed by hand, or a fault of posicast",
            remedies: [
                "generate into an empty folder and run again",
                "run `posicast verify` with the same `--seed`, and report its first difference",
            ],
        },
    ),
    (
        "the inline shaper's RTL equals",
        Advice {
            cause: "the Verilog was changed by hand, or a fault of posicast",
            remedies: [
                "generate into an empty folder and run again",
                "run `posicast verify` with `--block inline_shaper`, and report its first difference",
            ],
        },
    ),
    (
        "the inline shaper gives every step",
        Advice {
            cause: "the move is faster than `limits.velocity`, or the motor is pulled over",
            remedies: [
                "leave out `--speed`, or raise `limits.velocity` as far as the drive's lines allow",
                "lower acceleration and velocity of the axis, or raise the force of [axis.stepper]",
            ],
        },
    ),
    (
        "the stage carries out its commands",
        Advice {
            cause: "a limit is tighter than the loop can follow, or the loop oscillates: see the cause that the check names",
            remedies: [
                "leave the gains out of [axis.controller], and look at the margins that `design` prints",
                "lower acceleration and jerk, or raise the limit that tripped",
            ],
        },
    ),
    (
        "the axes follow",
        Advice {
            cause: "the gains do not overcome friction or the dead time of the bridge, the drive is at its limit, or the encoder is too \
                    coarse for the move",
            remedies: [
                "raise the gains as far as the margins of `design` allow, or shorten dead_time_s and minimum_pulse_s",
                "check counts_per_unit against unit, lower acceleration, or raise following_error",
            ],
        },
    ),
    (
        "the shapers suppress",
        Advice {
            cause: "the loop oscillates, or the drive or a word is at its limit, so that the load does not get the shaped command",
            remedies: [
                "look at plots/stage-move.svg, and lower acceleration or the gains",
                "check frequency_hz and damping, and the mode's participation",
            ],
        },
    ),
    (
        "the error tables lead",
        Advice {
            cause: "the axis does not come to rest, or friction keeps it from its target",
            remedies: [
                "look at plots/stage-error-table.svg, and raise the gains as far as the margins of `design` allow",
                "compare the rows of the CSV file with `posicast design`, which says how far the table departs from them",
            ],
        },
    ),
    (
        "at the corners",
        Advice {
            cause: "the shaped step saturates the command word, or a mode lies outside the band that was designed for",
            remedies: [
                "raise command_bits, or lower command_fraction",
                "run `posicast design --certify`, and compare its bound with tolerance",
            ],
        },
    ),
];

/// Advice for a comparison that was too short for a verdict.
const TOO_SHORT: Advice = Advice {
    cause: "too few clocks to exercise everything; nothing differed",
    remedies: [
        "leave out `--cycles`",
        "run `posicast verify`, which says how many clocks are enough",
    ],
};

/// Advice for a comparison that a fault of the stage ended.
const GIVEN_UP: Advice = Advice {
    cause: "a fault of the stage ended the run; nothing differed until then",
    remedies: [
        "find the cause of the fault: see the check of the commands",
        "look at plots/stage-move.svg, which marks the fault",
    ],
};

/// Returns the advice for a failed check: by its name, or for a run that ended too early.
pub(super) fn for_failed(check: &Check) -> Option<&'static Advice> {
    match check.coverage {
        Coverage::TooFewClocks => Some(&TOO_SHORT),
        Coverage::GivenUp => Some(&GIVEN_UP),
        Coverage::Enough | Coverage::Nothing => for_check(check.name),
    }
}

fn for_check(name: &str) -> Option<&'static Advice> {
    ADVICE
        .iter()
        .find(|(start, _)| name.starts_with(start))
        .map(|(_, advice)| advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_check_of_a_run_has_advice() {
        let sources = [
            include_str!("checks.rs"),
            include_str!("closed_loop/verdicts.rs"),
            include_str!("closed_loop/probing.rs"),
            include_str!("closed_loop/pulses.rs"),
            include_str!("closed_loop/touches.rs"),
            include_str!("inline.rs"),
        ];
        let words = sources.map(|source| source.split_whitespace().collect::<Vec<_>>().join(" "));
        let mut names = 0;
        for before in [
            "let name = \"",
            "Check::new( \"",
            "not_exercised( \"",
            "compared( \"",
            "compared(\"",
            ": &str = \"",
        ] {
            for rest in words.iter().flat_map(|words| words.split(before).skip(1)) {
                let name = rest.split('"').next().unwrap_or_default();
                names += 1;
                // Open checks are named, but are not failures; a move that is too short gets its advice in the check
                // of the error.
                let is_never_failed = ["every shaper", "the line to the host", "the components on"]
                    .iter()
                    .any(|open| name.starts_with(open));
                assert!(for_check(name).is_some() || is_never_failed, "{name}");
            }
        }
        assert_eq!(names, 22);
    }
}
