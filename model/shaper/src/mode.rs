//! A vibration mode of the machine.

use std::f64::consts::{PI, TAU};

/// One lightly damped mode: `ω² / (s² + 2ζωs + ω²)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency `f` in Hz, positive and finite.
    pub frequency_hz: f64,
    /// Damping ratio `ζ`, in [0, 1).
    pub damping: f64,
}

impl Mode {
    /// Undamped natural frequency `ω = 2πf` in rad/s.
    pub fn omega(&self) -> f64 {
        TAU * self.frequency_hz
    }

    /// Damped frequency `ω_d = ω√(1−ζ²)` in rad/s, at which the mode visibly rings.
    pub fn omega_damped(&self) -> f64 {
        self.omega() * (1.0 - self.damping * self.damping).sqrt()
    }

    /// Damped frequency `f√(1−ζ²)` in Hz.
    pub fn damped_frequency_hz(&self) -> f64 {
        self.frequency_hz * (1.0 - self.damping * self.damping).sqrt()
    }

    /// Decay rate `σ = ζω` in 1/s.
    pub fn decay(&self) -> f64 {
        self.damping * self.omega()
    }

    /// Damped period `T_d = 2π/ω_d` in seconds.
    pub fn damped_period_s(&self) -> f64 {
        TAU / self.omega_damped()
    }

    /// Fraction of a swing that damping leaves after half a period: `K = e^{−ζπ/√(1−ζ²)}`, 1 without damping.
    pub fn half_swing_ratio(&self) -> f64 {
        (-PI * self.damping / (1.0 - self.damping * self.damping).sqrt()).exp()
    }

    /// Converts a mode of two masses joined by a spring, both free, to the mode with the first mass, the motor, held:
    /// frequency and damping ratio are both multiplied by `√(m_motor / (m_motor + m_load))`.
    ///
    /// ```text
    /// held  ω² = k/m_load,  2ζω = c/m_load      free  ω² = k/μ,  2ζω = c/μ,  μ = m_motor·m_load/(m_motor + m_load)
    /// ω_held/ω_free = √(μ/m_load) = r,   ζ_held/ζ_free = (μ/m_load)/r = r
    /// ```
    ///
    /// The damper acts in parallel with the spring; friction to the ground is not included.
    pub fn with_motor_held(&self, motor_mass: f64, load_mass: f64) -> Self {
        let ratio = (motor_mass / (motor_mass + load_mass)).sqrt();
        Self {
            frequency_hz: self.frequency_hz * ratio,
            damping: self.damping * ratio,
        }
    }

    /// The mode of a mass on a spring with a damper in parallel: `ω² = k/m`, `2ζω = c/m`. Mass in kg, above 0;
    /// stiffness in N/m, above 0; damping in N·s/m.
    pub fn of_spring(stiffness: f64, damping: f64, mass: f64) -> Self {
        let omega = (stiffness / mass).sqrt();
        Self {
            frequency_hz: omega / TAU,
            damping: damping / (2.0 * mass * omega),
        }
    }

    /// The mode with its frequency multiplied by `ratio` and its damping ratio unchanged, as of a machine that
    /// differs from its model.
    pub fn scaled(&self, ratio: f64) -> Self {
        Self {
            frequency_hz: self.frequency_hz * ratio,
            damping: self.damping,
        }
    }
}

/// A mode that is not known exactly: every frequency and damping ratio within these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeBand {
    /// Lowest and highest undamped natural frequency in Hz.
    pub frequency_hz: [f64; 2],
    /// Lowest and highest damping ratio.
    pub damping: [f64; 2],
}

impl ModeBand {
    /// The corners of the band, each once.
    pub fn corners(&self) -> Vec<Mode> {
        let mut corners: Vec<Mode> = Vec::with_capacity(4);
        for frequency_hz in self.frequency_hz {
            for damping in self.damping {
                let corner = Mode { frequency_hz, damping };
                if !corners.contains(&corner) {
                    corners.push(corner);
                }
            }
        }
        corners
    }
}
