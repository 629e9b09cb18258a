//! Shapers for the papers' examples, designed by the same functions as those of a machine file.

use posicast_machine::machine_file::AxisSection;
use posicast_machine::unit::AxisUnit;
use posicast_shaper::axis::{AxisMode, ShaperChoice};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, design_axis};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;

/// The papers' shapers are in continuous time: none looks at the samples.
const SAMPLE_HZ: f64 = 1.0;

/// An axis with these modes, all shaped as `shaper` says.
pub(super) fn axis(shaper: ShaperChoice, modes: &[Mode]) -> AxisSection {
    AxisSection {
        name: "paper".into(),
        unit: AxisUnit::default(),
        counts_per_unit: 1.0,
        modulo: false,
        shaper: Some(shaper),
        modes: modes.iter().map(|mode| axis_mode(*mode, None)).collect(),
        mechanics: None,
        family: None,
        encoder: None,
        pwm: None,
        drive: None,
        controller: None,
        limits: None,
        scale: None,
        error_table: None,
        trace: None,
        steps: None,
        input: None,
        stepper: None,
        probe: None,
        compare: None,
        correction: None,
    }
}

fn axis_mode(mode: Mode, shaper: Option<ShaperKind>) -> AxisMode {
    AxisMode {
        mode,
        free: None,
        shaper,
        tolerance: None,
        order: None,
        frequency_band: None,
        damping_band: None,
        participation: 1.0,
        points: Vec::new(),
    }
}

/// Returns a mode, given its undamped frequency in rad/s.
pub(super) fn mode_of_omega(omega: f64, damping: f64) -> Mode {
    Mode {
        frequency_hz: omega / TAU,
        damping,
    }
}

/// Designs the shaper of a kind for these modes, with the default tolerance of 5 %.
pub(super) fn shaper(kind: ShaperKind, modes: &[Mode]) -> Result<ImpulseSequence, DesignError> {
    chosen(ShaperChoice::of_kind(kind), modes)
}

/// Designs the shaper of a choice for these modes.
pub(super) fn chosen(shaper: ShaperChoice, modes: &[Mode]) -> Result<ImpulseSequence, DesignError> {
    design_axis(axis(shaper, modes).shaped(), SAMPLE_HZ).map(|design| design.impulses)
}

/// Returns the convolution of one shaper per mode.
pub(super) fn hybrid(parts: &[(ShaperKind, Mode)]) -> Result<ImpulseSequence, DesignError> {
    let axis = AxisSection {
        shaper: None,
        modes: parts.iter().map(|(kind, mode)| axis_mode(*mode, Some(*kind))).collect(),
        ..axis(ShaperChoice::of_kind(ShaperKind::None), &[])
    };
    design_axis(axis.shaped(), SAMPLE_HZ).map(|design| design.impulses)
}

/// Returns the amplitudes of a shaper in order of time.
pub(super) fn amplitudes(shaper: &ImpulseSequence) -> Vec<f64> {
    shaper.impulses().iter().map(|i| i.amplitude).collect()
}

/// Returns the times of a shaper in seconds, without that of the first impulse.
pub(super) fn times_s(shaper: &ImpulseSequence) -> Vec<f64> {
    shaper.impulses().iter().skip(1).map(|i| i.time_s).collect()
}
