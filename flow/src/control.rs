//! The controllers of a machine's axes: the gains computed from its file, and warnings about them.

use crate::plot::{Curve, Panel};
use crate::warning::Warning;
use posicast_blocks::sliding_mode::{Law, SettingRow};
use posicast_machine::control::DEFAULT_MARGIN;
use posicast_machine::control::sampled::Margins;
use posicast_machine::hardware::{AxisLoop, Hardware};
use posicast_machine::machine_file::Machine;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// The controller of one axis, prepared for output.
pub(crate) struct AxisControl {
    pub(crate) axis: String,
    pub(crate) of_axis: AxisLoop,
}

/// Half width and half height of the Nyquist plot, chosen so that circles are round in a panel.
const NYQUIST_REACH: [f64; 2] = [2.8, 1.0];

const ONE_SIDED: &str = "a half bridge outputs 0 for a negative command: choose direction, full-bridge or locked-antiphase for mode in \
                         [axis.pwm], unless something else pushes the axis back";

const ONE_CHANNEL: &str = "the shaper component has only the channel of the position, because three channels need command words of 18 to \
                           32 bits and delays of at most 4094 samples; the host must write shaped velocities and accelerations";

/// The controllers of a machine; `None` for an axis without one.
pub(crate) fn of_machine(machine: &Machine, hardware: &Hardware<'_>) -> Vec<Option<AxisControl>> {
    let axes = machine.axes.iter().zip(hardware.axes());
    let controls = axes.map(|(axis, built)| {
        built.control.clone().map(|of_axis| AxisControl {
            axis: axis.name.clone(),
            of_axis,
        })
    });
    controls.collect()
}

impl AxisControl {
    /// The warnings about the controller of the axis with this index.
    pub(crate) fn warnings_of(&self, index: usize) -> Vec<Warning> {
        let warnings = self.warnings().into_iter();
        let placed = warnings.map(|(key, text)| {
            let text = format!("controller of axis `{}`: {text}", self.axis);
            Warning::new(index, key, text)
        });
        placed.collect()
    }

    /// Texts of the warnings, each with its key.
    fn warnings(&self) -> Vec<(&'static str, String)> {
        let of_law = self.of_axis.derived.warnings.iter();
        let of_law = of_law.map(|warning| (warning.key(), warning.to_string()));
        let hardware = [
            (self.of_axis.is_one_sided, "axis.pwm.mode", ONE_SIDED),
            (self.of_axis.is_one_channel, "fixed_point.command_bits", ONE_CHANNEL),
        ];
        let hardware = hardware.into_iter().filter(|(holds, ..)| *holds);
        let hardware = hardware.map(|(_, key, text)| (key, text.to_owned()));
        let range = self.of_axis.no_travel.iter();
        let range = range.map(|warning| ("axis.limits.travel", warning.to_string()));
        of_law.chain(hardware).chain(range).collect()
    }

    /// The Nyquist curve round −1, with the circle that the default gains avoid.
    pub(crate) fn nyquist(&self) -> Panel {
        let curve = self.of_axis.derived.sampled.nyquist(&self.of_axis.derived.linear);
        let [reach_x, reach_y] = NYQUIST_REACH;
        let near = |x: f64, y: f64| x.abs() <= reach_x && y.abs() <= reach_y;
        let points = curve.into_iter().map(|point| (point.open_loop.re, point.open_loop.im));
        let circle = |centre: f64, radius: f64| {
            let places = (0..=180).map(|step| {
                let (sin, cos) = f64::from(2 * step).to_radians().sin_cos();
                (radius * cos + centre, radius * sin)
            });
            places.collect::<Vec<_>>()
        };
        // The curve is cut where it leaves the picture: the part that returns is a curve of its own.
        let mut parts: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
        for (x, y) in points {
            match (near(x, y), parts.last_mut()) {
                (true, Some(part)) => part.push((x, y)),
                (false, Some(part)) if !part.is_empty() => parts.push(Vec::new()),
                _ => {}
            }
        }
        parts.retain(|part| !part.is_empty());
        let mut curves = vec![
            Curve::reference("real axis", vec![(-reach_x, 0.0), (reach_x, 0.0)]),
            Curve::reference("distance 1 from 0", circle(0.0, 1.0)),
            Curve::limit(
                format!("distance {DEFAULT_MARGIN} from −1"),
                circle(-1.0, DEFAULT_MARGIN),
            ),
        ];
        curves.extend(parts.into_iter().enumerate().map(|(index, part)| match index {
            0 => Curve::new("open loop", part),
            _ => Curve::new("open loop, at higher frequencies", part),
        }));
        Panel {
            title: format!("axis {}: Nyquist curve of the loop, {}", self.axis, self.law()),
            x_label: "real part".into(),
            y_label: "imaginary part".into(),
            curves,
            ..Panel::default()
        }
    }

    /// The document for programs.
    pub(crate) fn json(&self) -> Control {
        Control {
            law: self.law(),
            lag_s: self.of_axis.lag_s,
            steady_error: self.of_axis.derived.steady_error,
            margins: StabilityMargins::new(&self.of_axis.derived.margins),
            settings: SettingRow::ALL
                .into_iter()
                .map(|row| ControlSetting {
                    row: format!("{row:?}").to_lowercase(),
                    value: self.of_axis.derived.gains.get(row),
                    word: self.of_axis.derived.settings.word(row as usize),
                })
                .collect(),
            supervision: self.of_axis.supervision.words().into(),
            warnings: self.warnings().into_iter().map(|(_, text)| text).collect(),
        }
    }

    fn law(&self) -> &'static str {
        match self.of_axis.derived.law {
            Law::SlidingMode => "sliding-mode",
            Law::Pd => "pd",
            Law::Pid => "pid",
        }
    }
}

/// `control` of an axis in `design --json` and `report.json`.
#[derive(Serialize, JsonSchema)]
pub struct Control {
    /// The law: `sliding-mode`, `pd` or `pid`.
    pub law: &'static str,
    /// Lag from the position to the drive's response, in s.
    pub lag_s: f64,
    /// Error in m or rad that Coulomb friction leaves.
    pub steady_error: f64,
    /// Margins of the sampled loop on the machine of the file.
    pub margins: StabilityMargins,
    /// Contents of the controller's memory after reset, by address.
    pub settings: Vec<ControlSetting>,
    /// Initial words of the axis's supervisor, by name.
    pub supervision: BTreeMap<&'static str, i64>,
    /// What is doubtful about the controller.
    pub warnings: Vec<String>,
}

/// Stability margins; null where there is no limit.
#[derive(Serialize, JsonSchema)]
pub struct StabilityMargins {
    /// Increase of the gains, in dB, that makes the loop unstable.
    pub gain_margin_db: Option<f64>,
    /// Reduction of the gains, in dB, that makes the loop unstable.
    pub gain_reduction_db: Option<f64>,
    /// Smallest distance of the phase from −180° where the gain is 1.
    pub phase_margin_deg: Option<f64>,
    /// Additional delay that makes the loop unstable.
    pub delay_margin_s: Option<f64>,
    /// Smallest distance of the open loop from −1.
    pub modulus_margin: f64,
    /// Highest frequency at which the gain of the open loop is 1.
    pub crossover_hz: Option<f64>,
}

impl StabilityMargins {
    fn new(margins: &Margins) -> Self {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        Self {
            gain_margin_db: finite(margins.gain_margin_db()),
            gain_reduction_db: finite(margins.gain_reduction.map(|factor| 20.0 * factor.log10())),
            phase_margin_deg: finite(margins.phase_margin_deg),
            delay_margin_s: finite(margins.delay_margin_s),
            modulus_margin: margins.modulus_margin,
            crossover_hz: finite(margins.crossover_hz),
        }
    }
}

/// A word of the controller's memory.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Setting")]
pub struct ControlSetting {
    /// Name of the row.
    pub row: String,
    /// Value in counts, ticks and command units.
    pub value: f64,
    /// The word.
    pub word: u32,
}
