//! The proofs of the step generator: the times of a drive, every mode, and the line between samples at a small size.

use posicast_blocks::step_generator::{StepGeneratorConfig, StepLinesActiveLow, StepMode, StepTimes, ports};
use posicast_hdl::step_generator::emit;

use super::trials::small;
use super::{FAST, FRACTION_BITS};
use crate::Error;
use crate::formal::{INDUCTION, Task, refused};

/// The line between samples is multiplied out in its proof, so its ticks are short.
const SHORT: StepTimes = StepTimes {
    pulse_clocks: 1,
    space_clocks: 2,
    direction_setup_clocks: 4,
    direction_hold_clocks: 3,
};

pub(super) fn all() -> Result<Vec<Task>, Error> {
    let a_low = StepLinesActiveLow { a: true, b: false };
    let exact = StepGeneratorConfig::new(4, 2, StepMode::StepDirection, SHORT, 2);
    let whole = StepGeneratorConfig::new(5000, FRACTION_BITS, StepMode::StepDirection, FAST, 100);
    Ok(vec![
        proof(
            exact.map_err(refused)?,
            true,
            "exact, 4 clocks per tick, 2 fraction bits",
        )?,
        proof(
            whole.map_err(refused)?,
            false,
            "5000 clocks per tick, step and direction",
        )?,
        proof(
            small(StepMode::UpDown)?.active_low(a_low),
            false,
            "50 clocks per tick, up and down, a active low",
        )?,
        proof(small(StepMode::Quadrature)?, false, "50 clocks per tick, quadrature")?,
    ])
}

fn bit(level: bool) -> String {
    format!("1'b{}", u8::from(level))
}

/// Macros for what the lines show.
pub(crate) fn lines(config: &StepGeneratorConfig) -> Vec<(String, String)> {
    let low = config.lines_active_low();
    let mode = match config.mode() {
        StepMode::StepDirection => 0,
        StepMode::UpDown => 1,
        StepMode::Quadrature => 2,
    };
    [
        ("MODE", format!("2'd{mode}")),
        ("A_OFF", bit(low.a)),
        ("B_OFF", bit(low.b)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

fn proof(config: StepGeneratorConfig, exact: bool, size: &str) -> Result<Task, Error> {
    let times = config.times();
    let clocks = |clocks: u64| format!("17'd{clocks}");
    let macros = [
        ("PULSE", clocks(times.pulse_clocks)),
        ("SPACE", clocks(times.space_clocks)),
        ("SETUP", clocks(times.direction_setup_clocks)),
        ("TURNED", clocks(config.turned_clocks())),
        ("HOLD", clocks(times.direction_hold_clocks)),
        ("OWED_LIMIT", format!("16'sd{}", config.owed_limit())),
        (
            "USED_OWED",
            format!(
                "16'd{}",
                2 * (u32::from(config.owed_limit()) + 2).next_power_of_two() - 1
            ),
        ),
        ("SUM_BITS", config.accumulator_bits().to_string()),
        ("STEP_UNITS", config.step_units().to_string()),
        ("TICK_CLOCKS", config.tick_clocks().to_string()),
        ("FRACTION", config.fraction_bits().to_string()),
        ("LARGEST", config.largest_difference().to_string()),
        ("EXACT", bit(exact)),
    ];
    let block = (emit(&config, "")?, ports());
    Ok(Task::new("step_generator", size, INDUCTION, block)
        .macros(&lines(&config))
        .properties(&macros, include_str!("step_generator.sv")))
}
