//! Simulates the drive: a command is held for a period, which is integrated in steps.

use nalgebra::{Matrix5, Vector5};

use super::{Amplifier, Contact, DriveTrain, Winding};

/// Longest step, s.
const STEP_S: f64 = 20e-6;
/// Largest product of step and fastest pole: a tenth of the stability limit of Runge–Kutta steps, with an error of
/// 1e-5 of that pole's decay.
const POLE_STEP: f64 = 0.3;

/// State of drive and masses.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrainState {
    /// Current i, A.
    pub current_a: f64,
    /// Angle of the motor θ, rad.
    pub angle: f64,
    /// Speed of the motor ω, rad/s.
    pub speed: f64,
    /// Position of the table x, m.
    pub position: f64,
    /// Velocity of the table v, m/s.
    pub velocity: f64,
}

impl TrainState {
    fn vector(&self) -> Vector5<f64> {
        Vector5::new(self.current_a, self.angle, self.speed, self.position, self.velocity)
    }

    fn of_vector(vector: &Vector5<f64>) -> Self {
        let [current_a, angle, speed, position, velocity] = (*vector).into();
        Self {
            current_a,
            angle,
            speed,
            position,
            velocity,
        }
    }
}

/// Position as an encoder or a scale of this resolution shows it: rounded down to whole steps, in the unit of the
/// position.
///
/// ```
/// use posicast_machine::plant::drive_train::quantised;
///
/// assert_eq!(quantised(2.9e-6, 1e-6), 2e-6);
/// assert_eq!(quantised(-0.1e-6, 1e-6), -1e-6);
/// ```
pub fn quantised(position: f64, resolution: f64) -> f64 {
    (position / resolution).floor() * resolution
}

impl DriveTrain {
    /// Longest step in s: 20 µs; with a smooth contact at most `2 v_0 m/F_s`, beyond which it oscillates about rest;
    /// and short compared with the inverse of the fastest pole.
    pub fn longest_step_s(&self) -> f64 {
        let mut longest = STEP_S.min(POLE_STEP / self.fastest());
        if self.contact == Contact::Smooth {
            let masses = [
                (self.motor_friction, self.motor_inertia),
                (self.load_friction, self.load_mass),
            ];
            for (friction, mass) in masses {
                if friction.stribeck.is_dry() {
                    let steepest = friction.stribeck.breakaway.max(friction.stribeck.coulomb);
                    longest = longest.min(2.0 * friction.rest_velocity * mass / steepest);
                }
            }
        }
        longest
    }

    /// Commanded current; `None` where the command is a voltage.
    fn wanted_current(&self, state: &Vector5<f64>, command: f64) -> Option<f64> {
        match self.amplifier {
            Amplifier::TunedCurrent { .. } | Amplifier::ProportionalCurrent { .. } => Some(command),
            Amplifier::Velocity { velocity_gain, .. } => Some(velocity_gain * (command - state[2])),
            Amplifier::Voltage { .. } => None,
        }
    }

    /// The winding, and the voltage that its amplifier asks for at this commanded current.
    fn wanted_voltage(&self, state: &Vector5<f64>, command: f64, asked_a: f64) -> Option<(Winding, f64)> {
        match self.amplifier {
            Amplifier::TunedCurrent { .. } => None,
            Amplifier::ProportionalCurrent { winding, current_gain }
            | Amplifier::Velocity {
                winding, current_gain, ..
            } => Some((winding, current_gain * (asked_a - state[0]))),
            Amplifier::Voltage { winding, gain } => Some((winding, gain * command)),
        }
    }

    /// Returns whether a limit clamps the command in this state.
    fn is_limited(&self, state: &Vector5<f64>, command: f64) -> bool {
        let asked = self.wanted_current(state, command).unwrap_or(0.0);
        let voltage = self
            .wanted_voltage(state, command, asked)
            .map_or(0.0, |(_, volts)| volts);
        asked.abs() > self.current_limit_a || voltage.abs() > self.voltage_limit_v
    }

    /// Rate of change of the current, with the limits.
    fn current_rate(&self, state: &Vector5<f64>, command: f64) -> f64 {
        let limit_a = self.current_limit_a;
        let asked = self
            .wanted_current(state, command)
            .unwrap_or(0.0)
            .max(-limit_a)
            .min(limit_a);
        match (self.amplifier, self.wanted_voltage(state, command, asked)) {
            (Amplifier::TunedCurrent { bandwidth_rad_s }, _) => bandwidth_rad_s * (asked - state[0]),
            (_, Some((winding, wanted))) => {
                let volts = wanted.max(-self.voltage_limit_v).min(self.voltage_limit_v);
                (volts - winding.back_emf * state[2] - winding.resistance_ohm * state[0]) / winding.inductance_h
            }
            (_, None) => 0.0,
        }
    }

    /// Torque on the motor and force on the table, without dry friction.
    fn applied(&self, state: &Vector5<f64>) -> [f64; 2] {
        let [current, angle, speed, position, velocity] = (*state).into();
        let lead = self.lead_per_radian;
        let screw = self.stiffness * (lead * angle - position) + self.damping * (lead * speed - velocity);
        [
            self.torque_constant * current - self.motor_friction.stribeck.viscous * speed - lead * screw,
            screw - self.load_friction.stribeck.viscous * velocity,
        ]
    }

    /// Rates of change of all states. For a stick-slip contact, `directions` are those in which motor and table
    /// slide; 0 where they stick.
    fn rates(&self, state: &Vector5<f64>, command: f64, directions: Option<[f64; 2]>) -> Vector5<f64> {
        let [torque, force] = self.applied(state);
        let [motor, load] = match directions {
            None => [
                torque - self.motor_friction.smooth(state[2]),
                force - self.load_friction.smooth(state[4]),
            ],
            Some([motor, load]) => [
                motor.abs() * (torque - motor * self.motor_friction.stribeck.dry(state[2])),
                load.abs() * (force - load * self.load_friction.stribeck.dry(state[4])),
            ],
        };
        Vector5::new(
            self.current_rate(state, command),
            state[2],
            motor / self.motor_inertia,
            state[4],
            load / self.load_mass,
        )
    }

    /// A fourth-order Runge–Kutta step.
    fn step(&self, state: &Vector5<f64>, command: f64, step_s: f64, directions: Option<[f64; 2]>) -> Vector5<f64> {
        let first = self.rates(state, command, directions);
        let second = self.rates(&(state + first * (step_s / 2.0)), command, directions);
        let third = self.rates(&(state + second * (step_s / 2.0)), command, directions);
        let fourth = self.rates(&(state + third * step_s), command, directions);
        state + (first + (second + third) * 2.0 + fourth) * (step_s / 6.0)
    }

    /// A step with a stick-slip contact: a mass that friction holds stands still, and one whose velocity would change
    /// its sign in the step ends it at rest.
    fn stick_slip(&self, state: &Vector5<f64>, command: f64, step_s: f64) -> Vector5<f64> {
        let frictions = [self.motor_friction, self.load_friction];
        let (mut from, applied) = (*state, self.applied(state));
        let mut directions = [1.0; 2];
        for (mass, velocity) in [2, 4].into_iter().enumerate() {
            if frictions[mass].stribeck.is_dry() {
                directions[mass] = frictions[mass].direction(state[velocity], applied[mass]);
                from[velocity] *= directions[mass].abs();
            }
        }
        let mut to = self.step(&from, command, step_s, Some(directions));
        for (mass, velocity) in [2, 4].into_iter().enumerate() {
            if frictions[mass].stribeck.is_dry() && to[velocity] * directions[mass] < 0.0 {
                to[velocity] = 0.0;
            }
        }
        to
    }
}

/// A simulated drive. Each command is held for one period.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTrainPlant {
    train: DriveTrain,
    state: Vector5<f64>,
    steps: u32,
    step_s: f64,
    /// Matrices of the exact step, where there is no dry friction.
    exact: Option<(Matrix5<f64>, Vector5<f64>)>,
}

impl DriveTrainPlant {
    /// Starts at rest at 0. Commands are held for this many seconds, which must be above 0 and finite.
    pub fn new(train: DriveTrain, period_s: f64) -> Self {
        let steps = (period_s / train.longest_step_s() * (1.0 - 1e-9)).ceil().max(1.0) as u32;
        let step_s = period_s / f64::from(steps);
        let is_dry = train.motor_friction.stribeck.is_dry() || train.load_friction.stribeck.is_dry();
        Self {
            train,
            state: Vector5::zeros(),
            steps,
            step_s,
            exact: (!is_dry).then(|| train.held_matrices(step_s)),
        }
    }

    /// Starts in another state.
    pub fn starting(self, state: TrainState) -> Self {
        Self {
            state: state.vector(),
            ..self
        }
    }

    /// The drive's data.
    pub fn train(&self) -> &DriveTrain {
        &self.train
    }

    /// The present state.
    pub fn state(&self) -> TrainState {
        TrainState::of_vector(&self.state)
    }

    /// Length of a step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Holds a command, in A, rad/s or V by the amplifier, for one period.
    pub fn hold(&mut self, command: f64) {
        for _ in 0..self.steps {
            self.state = self.stepped(command);
        }
    }

    fn stepped(&self, command: f64) -> Vector5<f64> {
        if let Some((matrix, input)) = &self.exact
            && !self.train.is_limited(&self.state, command)
        {
            let exact = matrix * self.state + input * command;
            if !self.train.is_limited(&exact, command) {
                return exact;
            }
        }
        match self.train.contact {
            Contact::Smooth => self.train.step(&self.state, command, self.step_s, None),
            Contact::StickSlip => self.train.stick_slip(&self.state, command, self.step_s),
        }
    }
}
