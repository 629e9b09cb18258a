//! The modes found in a log, whatever the method.

use super::excitation::LogExcitation;
use super::log_file::axis_of;
use crate::failure::Failure;
use crate::template::MachineKind;
use posicast_identify::log::{Log, Reading};
use posicast_identify::modal::ResponsePoint;
use posicast_identify::output_only;
use posicast_identify::position::{self, FoundInPosition, PositionError, motor};
use posicast_identify::recommend::{Judgement, Recommendation, recommend};
use posicast_identify::ring_down::{self, FoundInRingDown, RingDownError};
use posicast_identify::sweep::{self, Band, FoundInSweep, Sweep, SweepError};
use posicast_identify::{AccelerationLog, DriveLog, FoundMode, PositionLog};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::trimmed;

/// Measured data and the fit of the modes to it, for the plots.
pub(super) enum Evidence {
    /// A transfer function, and the fitted one at the same points.
    Transfer {
        points: Vec<ResponsePoint>,
        fitted: Vec<(f64, f64)>,
    },
    /// A response over time, and the fit of the modes to it.
    Response {
        /// Name of the response.
        name: &'static str,
        row_s: f64,
        measured: Vec<f64>,
        fitted: Vec<f64>,
    },
}

impl Evidence {
    fn response(name: &'static str, found: &FoundInPosition) -> Self {
        Self::Response {
            name,
            row_s: found.row_s,
            measured: found.response.clone(),
            fitted: found.fitted.clone(),
        }
    }
}

/// Modes and shapers, with their source.
pub(super) struct Findings {
    pub(super) rows: usize,
    pub(super) sample_s: f64,
    /// Description of the log.
    pub(super) source: String,
    /// Description of the method by which the modes were found.
    pub(super) method: String,
    /// Name of the method in the JSON document.
    pub(super) method_name: &'static str,
    /// Whether the modes are known to be those with the motor held.
    pub(super) is_motor_held: bool,
    /// The axis that the log names.
    pub(super) axis: Option<String>,
    pub(super) modes: Vec<FoundMode>,
    pub(super) recommended: Vec<Recommendation>,
    /// Unit of the axis of the modes, in which the shapers' figures are shown.
    pub(super) unit: AxisUnit,
    pub(super) judgement: Judgement,
    /// Problems of the log, and missing information in it.
    pub(super) remarks: Vec<String>,
    pub(super) evidence: Evidence,
    /// Name of the direction of an accelerometer that was used.
    pub(super) direction: Option<String>,
}

impl Findings {
    /// Finds the modes of a log.
    pub(super) fn of(reading: &Reading, excitation: &LogExcitation, judgement: &Judgement) -> Result<Self, Failure> {
        let mut remarks: Vec<String> = reading.remarks.iter().map(ToString::to_string).collect();
        let sample_s = match &reading.log {
            Log::Acceleration(log) => log.sample_s,
            Log::Position(log) => log.sample_s,
            Log::Drive(log) => log.sample_s,
        };
        if sample_s > SLOW_S {
            remarks.push(MILLISECONDS.to_owned());
        }
        let mut findings = match &reading.log {
            Log::Acceleration(log) if excitation.output_only => identify_output(log)?,
            Log::Acceleration(log) if excitation.ring_down => identify_ring_down(log)?,
            Log::Acceleration(log) => identify_acceleration(log, excitation)?,
            Log::Position(log) => identify_position(log)?,
            Log::Drive(log) => identify_motor(log)?,
        };
        let found = std::mem::replace(&mut findings.remarks, remarks);
        findings.remarks.extend(found);
        findings.rows = reading.rows;
        findings.judgement = *judgement;
        findings.recommended = recommend(&findings.modes, judgement);
        Ok(findings)
    }

    /// The template for a machine with these modes.
    pub(super) fn kind(&self) -> MachineKind {
        const SLOW_HZ: f64 = 2.0;
        if self.modes.iter().any(|found| found.mode.frequency_hz < SLOW_HZ) {
            MachineKind::Crane
        } else {
            MachineKind::Printer
        }
    }
}

/// Time between samples above which the user is asked whether it is in milliseconds.
const SLOW_S: f64 = 0.2;
const MILLISECONDS: &str =
    "the log has less than 5 samples per second; if its times are in milliseconds, say so: --columns time_ms,…";

/// Identifies an accelerometer log without a described excitation: as a sweep, or else as the decay after a stop.
fn identify_acceleration(log: &AccelerationLog, excitation: &LogExcitation) -> Result<Findings, Failure> {
    /// Length of a log in seconds below which it has no sweep.
    const SHORT_S: f64 = 2.0;
    let samples = log.directions.iter().map(|(_, record)| record.len()).min().unwrap_or(0);
    if (samples as f64) * log.sample_s < SHORT_S {
        return identify_ring_down(log);
    }
    let no_sweep = match identify_sweep(log, excitation.sweep.as_ref()) {
        Err(failure) => failure,
        Ok(findings) => return Ok(findings),
    };
    match ring_down::identify(log) {
        Ok(found) if !found.modes.is_empty() && found.explained > RINGS && found.part > PART => {
            Ok(findings_in_decay(log, found))
        }
        _ => Err(no_sweep),
    }
}

/// Fraction of the power after the last push that modes must explain if the log is not said to be of a stop, and the fraction of the whole
/// log's power that this must be, because the end of a sweep rings too.
const RINGS: f64 = 0.95;
const PART: f64 = 0.1;

/// Identifies the decay after a stop.
fn identify_ring_down(log: &AccelerationLog) -> Result<Findings, Failure> {
    Ok(findings_in_decay(
        log,
        ring_down::identify(log).map_err(ring_down_failure)?,
    ))
}

fn findings_in_decay(log: &AccelerationLog, found: FoundInRingDown) -> Findings {
    let mut remarks: Vec<String> = found.decay.remarks.iter().map(ToString::to_string).collect();
    if found.modes.is_empty() {
        remarks.push("the motion after the last push does not decay as a mode would: log a sudden stop, until the machine is at rest".into());
    }
    let method = format!(
        "modes that decay freely after a stop, fitted from {} s after the first sample on; they explain {:.2} % of it",
        trimmed(found.begin_s, 4),
        100.0 * found.explained
    );
    let evidence = Evidence::response("acceleration", &found.decay);
    in_direction(
        log,
        &found.direction,
        ("ring-down", method),
        found.modes,
        remarks,
        evidence,
    )
}

/// Findings in a direction of an accelerometer, by a method with this name and description.
fn in_direction(
    log: &AccelerationLog,
    direction: &str,
    (method_name, method): (&'static str, String),
    modes: Vec<FoundMode>,
    remarks: Vec<String>,
    evidence: Evidence,
) -> Findings {
    Findings {
        rows: 0,
        sample_s: log.sample_s,
        source: format!("accelerometer, direction {direction}"),
        method,
        method_name,
        is_motor_held: false,
        axis: axis_of(direction),
        modes,
        recommended: Vec::new(),
        unit: AxisUnit::default(),
        judgement: Judgement::default(),
        remarks,
        evidence,
        direction: Some(direction.to_owned()),
    }
}

fn ring_down_failure(error: RingDownError) -> Failure {
    let help = match error {
        RingDownError::Directions(..) => "--direction names the direction of the sensor along the axis",
        RingDownError::Log(_) => "log from before the stop until the machine is at rest",
    };
    Failure::input(error.to_string()).with_help(help)
}

fn identify_sweep(log: &AccelerationLog, given: Option<&Sweep>) -> Result<Findings, Failure> {
    let found = match given {
        Some(sweep) => sweep::identify(log, sweep),
        None => sweep::identify_any(log),
    };
    let found = found.map_err(|error| {
        let help = match error {
            SweepError::Unrelated(_) | SweepError::Unlike(_) | SweepError::Piece(_) => {
                "--sweep START:END:RATE:ACCEL describes another sweep; --ring-down says that it is the log of a stop; --output-only looks for modes without knowing the excitation"
            }
            SweepError::Description(_) if log.sample_s > SLOW_S => MILLISECONDS,
            SweepError::Description(_) => "--sweep START:END:RATE:ACCEL, for example 5:135:1:60",
            SweepError::Short { .. } | SweepError::Empty => "log the whole resonance test, from rest to rest",
        };
        Failure::input(error.to_string()).with_help(help)
    })?;
    let sweep = found.sweep;
    // The sensor's gain is 1 at low frequencies, so the log determines an acceleration that was not described.
    let per_hz = match given {
        Some(_) => sweep.acceleration_per_hz,
        None => sweep.acceleration_per_hz * found.static_gain,
    };
    let beside = match found.wave {
        Some(wave) => format!(
            " beside a square wave of {} mm/s² and {} s",
            trimmed(1e3 * wave.acceleration, 2),
            trimmed(wave.period_s, 4)
        ),
        None => " without a square wave beside it".into(),
    };
    let description = format!(
        "sweep{} of {} … {} Hz at {} Hz/s and {} mm/s² per Hz{beside}, begun {} s after the first sample",
        if found.is_estimated {
            ", estimated from the log,"
        } else {
            ""
        },
        trimmed(sweep.start_hz, 4),
        trimmed(sweep.end_hz, 4),
        trimmed(sweep.rate_hz_per_s, 4),
        trimmed(1e3 * per_hz, if given.is_some() { 4 } else { 2 }),
        trimmed(found.start_s, 5),
    );
    let method = format!(
        "transfer function of a {description}; it explains {:.2} % of the log in its band",
        100.0 * found.transfer.explained
    );
    let remarks = remarks(&found, &sweep);
    let fitted = found.transfer.points.iter().zip(&found.fitted);
    let evidence = Evidence::Transfer {
        fitted: fitted
            .map(|(point, value)| (point.frequency_hz, value.norm()))
            .collect(),
        points: found.transfer.points,
    };
    Ok(in_direction(
        log,
        &found.direction,
        ("sweep", method),
        found.modes,
        remarks,
        evidence,
    ))
}

fn identify_output(log: &AccelerationLog) -> Result<Findings, Failure> {
    let found = output_only::identify(log).map_err(position_failure)?;
    let mut remarks: Vec<String> = vec![
        "the excitation was assumed to be even over the frequencies: a peak of the excitation itself, such as that of a fan, looks like \
         a mode here, and shares are rough"
            .into(),
    ];
    if found.modes.is_empty() {
        remarks.push("no vibration in the log decays as a mode would".into());
    }
    let method = "decay of the autocorrelation of the response, with unknown excitation".into();
    let evidence = Evidence::response("autocorrelation of the acceleration", &found.decay);
    Ok(in_direction(
        log,
        &found.direction,
        ("output-only", method),
        found.modes,
        remarks,
        evidence,
    ))
}

fn identify_position(log: &PositionLog) -> Result<Findings, Failure> {
    let found = position::identify(log).map_err(position_failure)?;
    let (source, method_name) = if found.is_forced {
        ("command and response", "output-error")
    } else {
        ("response", "decay")
    };
    let driven = if found.is_forced {
        "modes under the command, held between samples"
    } else {
        "modes that decay freely"
    };
    let remarks = found.remarks.iter().map(ToString::to_string).collect();
    Ok(Findings {
        rows: 0,
        sample_s: log.sample_s,
        source: source.into(),
        method: format!(
            "{driven}, fitted to {}; they leave {:.2e} (root mean square, in the response's SI unit)",
            match found.decimation {
                1 => "every sample".into(),
                joined => format!("means of {joined} samples"),
            },
            found.noise,
        ),
        method_name,
        is_motor_held: false,
        axis: None,
        evidence: Evidence::response("response", &found),
        modes: found.modes,
        recommended: Vec::new(),
        unit: AxisUnit::default(),
        judgement: Judgement::default(),
        remarks,
        direction: None,
    })
}

/// Identifies the modes with the motor held from a drive and its own motor.
fn identify_motor(log: &DriveLog) -> Result<Findings, Failure> {
    let found = motor::identify(log).map_err(position_failure)?;
    let acts = if found.is_force { "force" } else { "velocity" };
    let remarks = found.held.remarks.iter().map(ToString::to_string).collect();
    Ok(Findings {
        rows: 0,
        sample_s: log.sample_s,
        source: "drive and its motor".into(),
        method: format!(
            "modes with the motor held: the zeros of the motor's motion, which follows the drive's command as a {acts}, {} samples late; \
             they leave {:.2e} (root mean square, in the position's SI unit)",
            found.delay, found.held.noise,
        ),
        method_name: "motor",
        is_motor_held: true,
        axis: None,
        evidence: Evidence::response("motor", &found.held),
        modes: found.held.modes,
        recommended: Vec::new(),
        unit: AxisUnit::default(),
        judgement: Judgement::default(),
        remarks,
        direction: None,
    })
}

fn position_failure(error: PositionError) -> Failure {
    let help = "log longer, from before the command moves until the machine is at rest";
    Failure::input(error.to_string()).with_help(help)
}

fn remarks(found: &FoundInSweep, swept: &Sweep) -> Vec<String> {
    /// Ratio of the square of the residual to that of the noise, above which the fit is incomplete.
    const LEFT_OVER: f64 = 4.0;
    /// Smallest relative clock difference worth reporting; a smaller one changes no mode.
    const TOLD_CLOCK: f64 = 1e-5;
    /// Smallest ratio by which an end of the sweep must be missing to be reported.
    const PART: f64 = 1.05;
    let mut remarks = Vec::new();
    if found.reduced_square > LEFT_OVER {
        remarks.push(format!(
            "the residual of the fitted modes is {:.1} times the noise of the transfer function: the response contains something that no \
             linear mode explains, such as backlash or stiction; the intervals are widened accordingly",
            found.reduced_square.sqrt()
        ));
    }
    if found.clock_error.abs() > TOLD_CLOCK {
        remarks.push(format!(
            "the clock of the log runs {} % {} than that of the sweep; frequencies are given by the clock of the sweep",
            trimmed(100.0 * found.clock_error.abs(), 3),
            if found.clock_error > 0.0 { "faster" } else { "slower" }
        ));
    }
    for Band { low_hz, high_hz } in &found.unseen {
        remarks.push(format!(
            "samples are missing while the sweep passed {} to {} Hz: modes there are not seen",
            trimmed(*low_hz, 4),
            trimmed(*high_hz, 4)
        ));
    }
    for mode in found.modes.iter().filter(|mode| found.is_at_end(mode)) {
        remarks.push(format!(
            "only one side of the mode at {} Hz lies within the sweep: its figures are doubtful beyond their intervals; sweep further",
            trimmed(mode.mode.frequency_hz, 2)
        ));
    }
    for frequency_hz in &found.doubtful_hz {
        remarks.push(format!(
            "the peak at {} Hz, at an end of the sweep, may be a mode or an error of that end: sweep further to find out",
            trimmed(*frequency_hz, 2)
        ));
    }
    let Band { low_hz, high_hz } = found.covered;
    let (low, high) = (trimmed(low_hz, 4), trimmed(high_hz, 4));
    if found.order.first_harmonic() > 1.0 {
        remarks.push(
            "the log fits this sweep only if all pushes moved the axis in one direction, which shakes it at twice the sweep's \
             frequencies; if they did not, describe the sweep: --sweep START:END:RATE:ACCEL"
                .to_owned(),
        );
    }
    if low_hz > swept.start_hz * PART || high_hz * PART < swept.end_hz {
        remarks.push(format!(
            "the log contains only a part of this sweep, from {low} to {high} Hz, and modes near a missing end are doubtful; if it was \
             another sweep, describe it: --sweep START:END:RATE:ACCEL"
        ));
    }
    remarks.push(if found.modes.is_empty() {
        format!(
            "between {low} and {high} Hz the sensor follows the sweep without a resonance above the noise"
        )
    } else {
        // A slow mode rings much for its share of the response, and is shaken less.
        let part = trimmed(100.0 * sweep::TOLD_RINGING, 3);
        let visible = found.visible.map_or(low_hz, |visible| visible.from_hz);
        let slower = match found.visible.filter(|visible| visible.from_hz > PART * low_hz) {
            Some(visible) => format!(
                "; a slower mode shows only if it rings more, at {} Hz {} times as much as all modes found, and no mode shows below \
                 {low} Hz or above {high} Hz",
                trimmed(visible.least_at_hz, 2),
                trimmed(visible.least_ringing, 2)
            ),
            None => format!("; no mode shows below that or above {high} Hz"),
        };
        format!(
            "from {} Hz on, the log shows every mode with at least {part} % of the ringing{slower}",
            trimmed(visible.max(low_hz), 3)
        )
    });
    remarks
}
