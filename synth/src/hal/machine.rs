//! From a machine file's machine to LinuxCNC's units.

use super::{HalAxis, HalMachine, HalProbe};
use posicast_blocks::shaper_tables::{AxisShaperTables, ShaperTables, ShaperTablesError};
use posicast_machine::machine_file::{AxisSection, ClockSection, Machine};
use posicast_machine::motion::TickLimits;
use posicast_machine::plan::{MachineDesign, design_machine};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::design::DesignError;
use posicast_taps::TapTable;

/// Why the machine cannot be driven at this servo rate.
#[derive(Debug, thiserror::Error)]
pub enum ServoError {
    /// The stage's tick is not an integral fraction of a servo period.
    #[error(
        "a servo rate of {servo_hz} Hz: the stage's tick rate of {sample_hz} Hz must be a whole multiple of it, 2 to 256 times; give \
         such a servo rate"
    )]
    Rate {
        /// Servo rate.
        servo_hz: f64,
        /// Tick rate.
        sample_hz: f64,
    },
    /// The shapers cannot be designed for the servo rate.
    #[error("tap tables at {servo_hz} Hz: {source}")]
    Design {
        /// Servo rate.
        servo_hz: f64,
        /// The reason.
        #[source]
        source: Box<DesignError>,
    },
    /// The component does not hold the tables.
    #[error("tap tables at {servo_hz} Hz: {source}")]
    Tables {
        /// Servo rate.
        servo_hz: f64,
        /// The reason.
        #[source]
        source: ShaperTablesError,
    },
}

impl<'a> HalMachine<'a> {
    /// Creates the machine from its design at its own tick rate, for a servo thread of `servo_hz`.
    ///
    /// # Errors
    /// [`ServoError`] for a rate that does not suit the machine.
    pub fn of(
        machine: &'a Machine,
        design: &MachineDesign,
        servo_hz: f64,
        has_stage: bool,
    ) -> Result<Self, ServoError> {
        let sample_hz = machine.clock.sample_hz;
        let ticks = sample_hz / servo_hz;
        // A point lasts 2 to POSICAST_STREAM_TICKS_MAX ticks.
        if has_stage && !(ticks.fract() == 0.0 && (2.0..=256.0).contains(&ticks)) {
            return Err(ServoError::Rate { servo_hz, sample_hz });
        }
        let axes = machine.axes.iter().zip(&design.axes);
        let axes = axes.map(|(axis, designed)| hal_axis(axis, &machine.clock, &designed.table));
        Ok(Self {
            name: &machine.name,
            servo_hz,
            axes: axes.collect(),
            has_stage,
            captures: machine.capture.is_some(),
            tables: servo_tables(machine, servo_hz)?,
        })
    }
}

fn is_rotary(axis: &AxisSection) -> bool {
    axis.unit.si_name() == "rad"
}

/// LinuxCNC's units in one m or rad.
fn units_per_si(axis: &AxisSection) -> f64 {
    if is_rotary(axis) {
        AxisUnit::Degree.per_si()
    } else {
        AxisUnit::Millimetre.per_si()
    }
}

fn hal_axis<'a>(axis: &'a AxisSection, clock: &ClockSection, table: &TapTable) -> HalAxis<'a> {
    let per_si = units_per_si(axis);
    let counts_per_unit = axis.loop_counts_per_unit() / per_si;
    let limits = TickLimits::of_axis(axis, clock);
    let section = axis.limits.as_ref();
    HalAxis {
        name: &axis.name,
        rotary: is_rotary(axis),
        counts_per_unit,
        velocity: limits.velocity * clock.sample_hz / counts_per_unit,
        acceleration: limits.acceleration * clock.sample_hz.powi(2) / counts_per_unit,
        travel: section
            .and_then(|limits| limits.travel)
            .map(|ends| ends.map(|end| end * per_si)),
        following_error: section
            .and_then(|limits| limits.following_error)
            .map(|error| error * per_si),
        delay_s: table.mean_delay_samples() / clock.sample_hz,
        index: axis.encoder.as_ref().is_some_and(|encoder| encoder.index),
        absolute: axis.absolute_encoder().is_some(),
        probe: axis.probe.map(|probe| HalProbe {
            velocity: probe.side.sign() * probe.slow_velocity * per_si,
            position: probe.position * per_si,
            rest: (probe.position - probe.side.sign() * probe.retract) * per_si,
        }),
    }
}

/// The machine's shapers, digitised for the servo rate.
fn servo_tables(machine: &Machine, servo_hz: f64) -> Result<ShaperTables, ServoError> {
    let mut slow = machine.clone();
    slow.clock.sample_hz = servo_hz;
    let source = |source| ServoError::Design {
        servo_hz,
        source: Box::new(source),
    };
    let design = design_machine(&slow).map_err(source)?;
    let fraction = design.coefficient_fraction;
    let taps = |table: &TapTable| {
        table
            .taps()
            .iter()
            .map(|tap| (tap.delay_samples, tap.coefficient))
            .collect()
    };
    let axes = machine
        .axes
        .iter()
        .zip(&design.axes)
        .map(|(axis, designed)| AxisShaperTables {
            name: axis.name.clone(),
            lsb_per_unit: axis.loop_counts_per_unit() / units_per_si(axis)
                * f64::from(machine.fixed_point.command_fraction).exp2(),
            word_bits: machine.fixed_point.command_bits,
            modulo: axis.modulo,
            coefficient_fraction: fraction,
            tables: vec![taps(&designed.table), vec![(0, 1 << fraction)]],
        });
    let tables = ShaperTables {
        sample_hz: servo_hz,
        axes: axes.collect(),
    };
    for axis in &tables.axes {
        axis.shaper()
            .map_err(|source| ServoError::Tables { servo_hz, source })?;
    }
    Ok(tables)
}
