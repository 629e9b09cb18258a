//! An axis as the design of its shaper sees it: its modes, and the choice of a shaper for them.

use crate::design::kind::ShaperKind;
use crate::mode::{Mode, ModeBand};
use posicast_optimal::{Command, Prefer};

/// Default of the residual that an EI kind tolerates, as a fraction of the unshaped vibration.
pub const DEFAULT_TOLERANCE: f64 = 0.05;
/// Default of the residual bound of `vibrationless`.
pub const DEFAULT_EPSILON: f64 = 0.05;
/// Default number of zero pairs of `chebyshev-ei`.
pub const DEFAULT_CHEBYSHEV_ORDER: u32 = 3;

/// What computes the shaper of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShaperStructure {
    /// A table of taps, each a product.
    #[default]
    Taps,
    /// Half sums in series, without a product: for `vibrationless` alone.
    Cascade,
}

impl ShaperStructure {
    /// Every structure with its name in the machine file.
    pub const ALL: [(Self, &str); 2] = [(Self::Taps, "taps"), (Self::Cascade, "cascade")];
}

/// Inputs of the design of an axis's shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapedAxis<'a> {
    /// Name of the axis, for messages.
    pub name: &'a str,
    /// The shaper of the whole axis; absent only if every mode names its own.
    pub shaper: Option<&'a ShaperChoice>,
    /// The modes; empty only for the kinds `custom` and `none`.
    pub modes: &'a [AxisMode],
}

impl ShapedAxis<'_> {
    /// The kind that treats all modes of this axis together, or `None` where each mode has a shaper of its own and the
    /// axis gets their convolution.
    pub fn joint_kind(&self) -> Option<ShaperKind> {
        let kind = self.shaper?.kind;
        kind.treats_modes_together().then_some(kind)
    }

    /// Kind of a mode's shaper: the mode's own; else `zv` under `simultaneous`; else the axis's.
    pub fn kind_of(&self, mode: &AxisMode) -> ShaperKind {
        let axis_kind = self.shaper.map_or(ShaperKind::None, |s| s.kind);
        let inherited = if axis_kind == ShaperKind::Simultaneous {
            ShaperKind::Zv
        } else {
            axis_kind
        };
        mode.shaper.unwrap_or(inherited)
    }

    /// Tolerance at a mode, for the EI kinds and for every insensitivity: the mode's, else the axis's, else
    /// [`DEFAULT_TOLERANCE`].
    pub fn tolerance_of(&self, mode: &AxisMode) -> f64 {
        let of_axis = self.shaper.and_then(|s| s.tolerance);
        mode.tolerance.or(of_axis).unwrap_or(DEFAULT_TOLERANCE)
    }

    /// Order at a mode: the mode's, else the axis's, else the default of the mode's kind; 1 for a kind without order.
    pub fn order_of(&self, mode: &AxisMode) -> u32 {
        let of_axis = self.shaper.and_then(|s| s.order);
        mode.order
            .or(of_axis)
            .unwrap_or_else(|| self.kind_of(mode).row().default_order)
    }

    /// Whether half sums in series compute the shaper.
    pub fn is_cascade(&self) -> bool {
        self.shaper.is_some_and(|s| s.structure == ShaperStructure::Cascade)
    }

    /// Whether every mode has a shaper of half sums.
    pub fn is_vibrationless(&self) -> bool {
        let mut modes = self.modes.iter();
        !self.modes.is_empty() && modes.all(|mode| self.kind_of(mode) == ShaperKind::Vibrationless)
    }

    /// Residual bound of `vibrationless`, default 0.05.
    pub fn epsilon(&self) -> f64 {
        self.shaper.and_then(|s| s.epsilon).unwrap_or(DEFAULT_EPSILON)
    }

    /// Search limit of `periodic` in Hz: the file's, else a tenth of the lowest mode's frequency.
    pub fn lowest_frequency_hz(&self) -> f64 {
        let given = self.shaper.and_then(|s| s.lowest_frequency_hz);
        let modes = self.modes.iter().map(|m| m.mode.frequency_hz);
        given.unwrap_or_else(|| modes.fold(f64::INFINITY, f64::min) / 10.0)
    }

    /// Kind as reports and JSON name it: the axis's where every mode follows it, else those of the modes joined by
    /// `+` in the order of the file.
    pub fn kind_name(&self) -> String {
        match self.shaper {
            Some(shaper)
                if self.joint_kind().is_some() || self.modes.iter().all(|m| self.kind_of(m) == shaper.kind) =>
            {
                shaper.kind.to_string()
            }
            _ => {
                let kinds: Vec<&str> = self.modes.iter().map(|m| self.kind_of(m).name()).collect();
                kinds.join("+")
            }
        }
    }
}

/// `[axis.shaper]`: the kind, and the parameters that the file gives for it.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaperChoice {
    /// Kind of shaper.
    pub kind: ShaperKind,
    /// What computes it.
    pub structure: ShaperStructure,
    /// Residual vibration that an EI kind tolerates at the mode, in (0, 1); default 0.05.
    pub tolerance: Option<f64>,
    /// Zero pairs of `chebyshev-ei`, or frequencies per mode of `vibrationless`: 1..=5.
    pub order: Option<u32>,
    /// Residual bound of `vibrationless`.
    pub epsilon: Option<f64>,
    /// Base shaper of `periodic`.
    pub base: Option<ShaperKind>,
    /// Search limit of `periodic` in Hz.
    pub lowest_frequency_hz: Option<f64>,
    /// Amplitudes of `simultaneous`: `ps` or `um`.
    pub amplitude: Option<String>,
    /// Method of `antisymmetric`: `exact`, `two-impulse`, `three-impulse`.
    pub method: Option<String>,
    /// Tolerance of the frequency ratios of `antisymmetric`.
    pub ratio_tolerance: Option<f64>,
    /// Bounds of the shaped command, for `optimal`.
    pub command: Option<Command>,
    /// Largest number of taps, for `optimal`.
    pub taps: Option<u32>,
    /// Preference of `optimal` among the shortest shapers.
    pub prefer: Option<Prefer>,
    /// Impulses of `custom`, as `(time_s, amplitude)`.
    pub impulses: Vec<(f64, f64)>,
}

impl ShaperChoice {
    /// Makes a choice of this kind with every other key left out.
    pub fn of_kind(kind: ShaperKind) -> Self {
        Self {
            kind,
            structure: ShaperStructure::default(),
            tolerance: None,
            order: None,
            epsilon: None,
            base: None,
            lowest_frequency_hz: None,
            amplitude: None,
            method: None,
            ratio_tolerance: None,
            command: None,
            taps: None,
            prefer: None,
            impulses: Vec::new(),
        }
    }
}

/// `[[axis.mode]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisMode {
    /// Frequency and damping ratio with the motor held, for which the shaper is designed.
    pub mode: Mode,
    /// The mode as the file gives it, where it was measured with the motor free and converted to `mode`.
    pub free: Option<Mode>,
    /// The mode's own kind, instead of the axis's.
    pub shaper: Option<ShaperKind>,
    /// The mode's own tolerance, instead of the axis's.
    pub tolerance: Option<f64>,
    /// The mode's own order, instead of the axis's.
    pub order: Option<u32>,
    /// Largest relative error of the frequency, to either side.
    pub frequency_band: Option<f64>,
    /// Lowest and highest damping ratio that the mode may have.
    pub damping_band: Option<[f64; 2]>,
    /// Share of the mode in the axis's response; only ratios count. Default 1.
    pub participation: f64,
    /// For a mode that moves, its frequency and damping at values of the variable in increasing order; else empty.
    pub points: Vec<ModePoint>,
}

impl AxisMode {
    /// The mode at a value of the variable. Frequency and damping are linear between two points, and constant beyond
    /// the first and the last.
    pub fn at(&self, value: f64) -> Mode {
        let above = self.points.partition_point(|point| point.value <= value);
        let (Some(low), Some(high)) = (self.points.get(above.saturating_sub(1)), self.points.get(above)) else {
            return self.points.last().map_or(self.mode, |point| point.mode);
        };
        if above == 0 {
            return low.mode;
        }
        let share = (value - low.value) / (high.value - low.value);
        let between = |low: f64, high: f64| low + share * (high - low);
        Mode {
            frequency_hz: between(low.mode.frequency_hz, high.mode.frequency_hz),
            damping: between(low.mode.damping, high.mode.damping),
        }
    }

    /// The frequencies and damping ratios that the mode may have: just its own where the file gives no band. The own ones always belong to it.
    pub fn band(&self) -> ModeBand {
        let Mode { frequency_hz, damping } = self.mode;
        let band = self.frequency_band.unwrap_or(0.0);
        let [low, high] = self.damping_band.unwrap_or([damping; 2]);
        ModeBand {
            frequency_hz: [frequency_hz * (1.0 - band), frequency_hz * (1.0 + band)],
            damping: [low.min(damping), high.max(damping)],
        }
    }
}

/// A mode that moves, at one value of the variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModePoint {
    /// Value of the variable: in m or rad for a position, else the number of the file.
    pub value: f64,
    /// Frequency and damping ratio at that value, with the motor held.
    pub mode: Mode,
}
