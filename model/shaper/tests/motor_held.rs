//! A mode that was measured with the motor free, compared with the eigenvalues of two masses with a spring and a
//! damper between them.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix4};
use posicast_shaper::mode::Mode;

/// Two masses, and the stiffness and the damping between them.
struct TwoMasses {
    motor: f64,
    load: f64,
    stiffness: f64,
    damping: f64,
}

/// Returns the mode of a complex pole: its magnitude is ω, its decay rate is ζω.
fn mode_of(poles: impl IntoIterator<Item = nalgebra::Complex<f64>>) -> Mode {
    let pole = poles.into_iter().max_by(|a, b| a.im.total_cmp(&b.im)).unwrap();
    Mode {
        frequency_hz: pole.norm() / TAU,
        damping: -pole.re / pole.norm(),
    }
}

impl TwoMasses {
    /// Returns the mode with both masses free; the states are two positions and two velocities.
    #[rustfmt::skip]
    fn free(&self) -> Mode {
        let Self { motor, load, stiffness: k, damping: c } = *self;
        let system = Matrix4::new(
            0.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
            -k / motor, k / motor, -c / motor, c / motor,
            k / load, -k / load, c / load, -c / load,
        );
        mode_of(system.complex_eigenvalues().iter().copied())
    }

    /// Returns the mode with the motor held.
    fn motor_held(&self) -> Mode {
        let system = Matrix2::new(0.0, 1.0, -self.stiffness / self.load, -self.damping / self.load);
        mode_of(system.complex_eigenvalues().iter().copied())
    }
}

#[test]
fn golden_a_free_mode_becomes_that_of_a_held_motor_as_the_eigenvalues_say() {
    for (motor, load, stiffness, damping) in [
        (2.0, 2.0, 1.4e5, 20.0),
        (0.5, 12.0, 4e5, 35.0),
        (30.0, 0.4, 2.5e4, 3.0),
        (3e-4, 1.1e-3, 60.0, 4e-3),
        (1.0, 1.0, 1e4, 100.0),
    ] {
        let machine = TwoMasses {
            motor,
            load,
            stiffness,
            damping,
        };
        let (converted, held) = (machine.free().with_motor_held(motor, load), machine.motor_held());
        assert!(held.damping > 1e-4 && held.damping < 0.9, "{held:?}");
        let frequency = (converted.frequency_hz / held.frequency_hz - 1.0).abs();
        let ratio = (converted.damping / held.damping - 1.0).abs();
        assert!(frequency < 1e-9 && ratio < 1e-9, "{converted:?} is not {held:?}");
    }
}
