//! Stribeck friction, sliding and at rest.

/// Friction over velocity, eq (2-20) of the thesis on the XY stage: `[F_c + (F_s − F_c) e^{−(v/v_s)²}] sgn v + b v`.
///
/// Forces are in N over m/s, or torques in N·m over rad/s. All fields are at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    /// Dry friction F_c at high velocity.
    pub coulomb: f64,
    /// Dry friction F_s at rest, at least `coulomb`.
    pub breakaway: f64,
    /// Velocity v_s over which friction falls from `breakaway` to `coulomb`; 0: at once.
    pub velocity: f64,
    /// Viscous friction b, per unit of velocity.
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

    /// Magnitude of the dry friction at this velocity, without the viscous part.
    ///
    /// ```
    /// use posicast_machine::plant::drive_train::Stribeck;
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
        // With a Stribeck velocity of 0 the excess exists at rest only.
        let left = if velocity == 0.0 { 1.0 } else { (-ratio * ratio).exp() };
        self.coulomb + excess * left
    }

    /// Returns whether there is dry friction.
    pub fn is_dry(&self) -> bool {
        self.coulomb != 0.0 || self.breakaway != 0.0
    }
}

/// Friction of one mass and its treatment near rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Friction as a function of velocity.
    pub stribeck: Stribeck,
    /// Velocity near rest, at least 0: `v_0` of the smooth contact, which must be above 0, or Karnopp's band, in
    /// which a mass that friction holds stands still.
    pub rest_velocity: f64,
}

impl Friction {
    /// No friction.
    pub const NONE: Self = Self {
        stribeck: Stribeck::NONE,
        rest_velocity: 0.0,
    };

    /// Dry friction of the smooth contact, with its sign.
    pub(super) fn smooth(&self, velocity: f64) -> f64 {
        if self.stribeck.is_dry() {
            self.stribeck.dry(velocity) * (velocity / self.rest_velocity).tanh()
        } else {
            0.0
        }
    }

    /// Direction in which a mass under this force slides against dry friction: 1, −1, or 0 where friction holds it.
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

/// Model of dry friction at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// `tanh(v/v_0)` in place of the sign: smooth, but the mass creeps at rest.
    Smooth,
    /// Karnopp's model: a mass within its velocity band stands still while the force on it is at most the breakaway
    /// friction.
    StickSlip,
}
