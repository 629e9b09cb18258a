//! Stribeck friction: what it takes to slide, and to leave.

/// Friction over velocity, eq (2-20) of the thesis on the XY stage: `[F_c + (F_s − F_c) e^{−(v/v_s)²}] sgn v + b v`.
///
/// Forces in N over m/s, or torques in N·m over rad/s. All at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    /// Dry friction F_c while it slides fast.
    pub coulomb: f64,
    /// Dry friction F_s at rest, at least `coulomb`.
    pub breakaway: f64,
    /// Velocity v_s over which the one becomes the other; 0: at once.
    pub velocity: f64,
    /// Viscous friction b, per velocity.
    pub viscous: f64,
}

impl Stribeck {
    /// No friction.
    pub const NONE: Self = Self {
        coulomb: 0.0,
        breakaway: 0.0,
        velocity: 0.0,
        viscous: 0.0,
    };

    /// Size of the dry part at this velocity: without its sign, and without what is viscous.
    ///
    /// ```
    /// use posicast_model::plant::drive_train::Stribeck;
    ///
    /// let guide = Stribeck { coulomb: 40.0, breakaway: 60.0, velocity: 0.005, viscous: 200.0 };
    /// assert_eq!(guide.dry(0.0), 60.0);
    /// assert!((guide.dry(-0.005) - (40.0 + 20.0 / std::f64::consts::E)).abs() < 1e-12);
    /// ```
    pub fn dry(&self, velocity: f64) -> f64 {
        let excess = self.breakaway - self.coulomb;
        if excess == 0.0 {
            return self.coulomb;
        }
        let ratio = velocity / self.velocity;
        // Over no velocity at all the excess is there at rest only.
        let left = if velocity == 0.0 { 1.0 } else { (-ratio * ratio).exp() };
        self.coulomb + excess * left
    }

    /// Whether there is a dry part.
    pub fn is_dry(&self) -> bool {
        self.coulomb != 0.0 || self.breakaway != 0.0
    }
}

/// Friction of one mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Over velocity.
    pub stribeck: Stribeck,
    /// The velocity near rest, at least 0: `v_0` of the smooth contact, where it must be above 0, or Karnopp's band, in which a mass whose
    /// friction holds it stands still.
    pub rest_velocity: f64,
}

impl Friction {
    /// No friction.
    pub const NONE: Self = Self {
        stribeck: Stribeck::NONE,
        rest_velocity: 0.0,
    };

    /// Dry part of the smooth contact, with its sign.
    pub(super) fn smooth(&self, velocity: f64) -> f64 {
        if self.stribeck.is_dry() {
            self.stribeck.dry(velocity) * (velocity / self.rest_velocity).tanh()
        } else {
            0.0
        }
    }

    /// Which way dry friction lets a mass slide on which this force acts: 1, −1, or 0 where it holds it.
    pub(super) fn direction(&self, velocity: f64, applied: f64) -> f64 {
        let holds = applied.abs() <= self.stribeck.breakaway;
        if velocity == 0.0 && applied == 0.0 || velocity.abs() <= self.rest_velocity && holds {
            0.0
        } else if velocity == 0.0 {
            applied.signum()
        } else {
            velocity.signum()
        }
    }
}

/// What becomes of dry friction at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// `tanh(v/v_0)` in the place of the sign: smooth, and it creeps at rest.
    Smooth,
    /// Karnopp's: a mass within its band of rest stands still while the force on it is at most the breakaway friction.
    StickSlip,
}
