//! Turns gate pins into the drive's command: the meaning of the levels in each mode, and their mean over a period of
//! the PWM.
//!
//! A drive smooths its command; otherwise its response would move by micrometres in each pulse. Its command is taken
//! as the mean over the last period, which has no ripple for any duty and phase, and lags by half a period.

use crate::machine_file::PwmMode;

/// Levels of the pins that go to the power stage, the drive and the brake.
///
/// The default has all pins low: the drive is disabled and the brake applied.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DrivePins {
    /// High side of leg A; in mode `direction` the PWM; on an axis with steps its first line.
    pub a_high: bool,
    /// Low side of leg A.
    pub a_low: bool,
    /// High side of leg B; in mode `direction` the direction; on an axis with steps its second line.
    pub b_high: bool,
    /// Low side of leg B.
    pub b_low: bool,
    /// Whether the drive may follow its command.
    pub drive_enable: bool,
    /// Whether the brake is open.
    pub brake_release: bool,
}

impl DrivePins {
    /// Fraction of full scale that the gates command in a mode: −1, 0 or 1. `active_low`: a gate is on at a low
    /// level.
    #[inline]
    fn command(&self, mode: PwmMode, active_low: bool) -> i64 {
        let [a_high, a_low, b_high, b_low] =
            [self.a_high, self.a_low, self.b_high, self.b_low].map(|level| level != active_low);
        match mode {
            PwmMode::Direction if b_high => -i64::from(a_high),
            PwmMode::Direction | PwmMode::HalfBridge => i64::from(a_high),
            PwmMode::FullBridge | PwmMode::LockedAntiphase => i64::from(a_high && b_low) - i64::from(b_high && a_low),
        }
    }

    /// Returns whether both sides of a leg are on.
    #[inline]
    fn shorts(&self, mode: PwmMode, active_low: bool) -> bool {
        let both = |high: bool, low: bool| high != active_low && low != active_low;
        mode != PwmMode::Direction && (both(self.a_high, self.a_low) || both(self.b_high, self.b_low))
    }
}

/// Command in a cell of the time grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Command {
    /// Mean command over the last period, as a fraction of full scale, −1 to 1.
    pub(super) share: f64,
    /// Steps that the drive has taken since the start, up less down; 0 with a PWM.
    pub(super) steps: i64,
    /// Whether the drive was enabled in every clock.
    pub(super) enabled: bool,
    /// Whether the brake was open in every clock.
    pub(super) released: bool,
}

/// Sums of the pins over the cells of a period. They are integers, so that the result does not depend on how a time
/// is divided into calls.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PinMean {
    mode: PwmMode,
    active_low: bool,
    cell_clocks: u32,
    /// Sums of the cells before this one, the oldest at `oldest`; together they make a period.
    cells: Vec<i64>,
    oldest: usize,
    period: i64,
    /// Sum of this cell.
    command: i64,
    enabled: i64,
    released: i64,
    shorted: u64,
}

impl PinMean {
    /// Starts with a command of 0 so far. A period has `cells` cells of this many clocks.
    pub(super) fn new(mode: PwmMode, active_low: bool, cell_clocks: u32, cells: u32) -> Self {
        Self {
            mode,
            active_low,
            cell_clocks,
            cells: vec![0; cells as usize],
            oldest: 0,
            period: 0,
            command: 0,
            enabled: 0,
            released: 0,
            shorted: 0,
        }
    }

    #[inline]
    pub(super) fn add(&mut self, pins: &DrivePins, clocks: u32) {
        let count = i64::from(clocks);
        self.command += pins.command(self.mode, self.active_low) * count;
        self.enabled += i64::from(pins.drive_enable) * count;
        self.released += i64::from(pins.brake_release) * count;
        if pins.shorts(self.mode, self.active_low) {
            self.shorted = self.shorted.saturating_add(u64::from(clocks));
        }
    }

    /// Ends a cell, and returns its command.
    pub(super) fn take(&mut self) -> Command {
        let all = i64::from(self.cell_clocks);
        self.period += self.command - std::mem::replace(&mut self.cells[self.oldest], self.command);
        self.oldest = (self.oldest + 1) % self.cells.len();
        let command = Command {
            share: self.period as f64 / (all * self.cells.len() as i64) as f64,
            steps: 0,
            enabled: self.enabled == all,
            released: self.released == all,
        };
        (self.command, self.enabled, self.released) = (0, 0, 0);
        command
    }

    /// Number of clocks in which both sides of a leg were on.
    pub(super) fn shorted(&self) -> u64 {
        self.shorted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_blocks::pwm::{ActiveLow, Inputs, Pwm, PwmConfig};

    /// Mean command of the PWM's own pins, cell by cell over 20 periods, after 20 periods to settle.
    fn mean_command_of_pwm(mode: PwmMode, register: u8, duty: i32, active_low: bool) -> f64 {
        let all = ActiveLow {
            a_high: active_low,
            a_low: active_low,
            b_high: active_low,
            b_low: active_low,
        };
        let mut pwm = Pwm::new(&PwmConfig::new(all, 10, 20).unwrap());
        let inputs = Inputs {
            enable: true,
            mode: register,
            period: 1000,
            duty,
            max_duty: 1000,
            fault_n: true,
            pll_locked: true,
            filtered_fault_n: 3,
            clear_trip: true,
            ..Inputs::default()
        };
        pwm.hold(&inputs, 20_000);
        let mut mean = PinMean::new(mode, active_low, 100, 10);
        let mut shares = vec![];
        for clock in 1..=20_000 {
            let shown = pwm.step(&inputs);
            let pins = DrivePins {
                a_high: shown.a_high,
                a_low: shown.a_low,
                b_high: shown.b_high,
                b_low: shown.b_low,
                drive_enable: true,
                brake_release: true,
            };
            mean.add(&pins, 1);
            if clock % 100 == 0 {
                let command = mean.take();
                assert!(command.enabled && command.released);
                shares.push(command.share);
            }
        }
        assert_eq!(mean.shorted(), 0);
        // After one period there is no ripple.
        assert!(shares[10..].iter().all(|share| *share == shares[10]));
        shares[10]
    }

    #[test]
    fn the_pins_of_the_pwm_mean_its_duty() {
        for active_low in [false, true] {
            for duty in [-1000, -600, 0, 400, 1000] {
                let share = f64::from(duty) / 1000.0;
                // One side alone loses the dead time, and moves in one direction only.
                let less =
                    |share: f64| share.signum() * (share.abs() - if share.abs() == 1.0 { 0.0 } else { 0.01 }).max(0.0);
                let of = |mode, register| mean_command_of_pwm(mode, register, duty, active_low);
                let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
                assert!(near(of(PwmMode::LockedAntiphase, 3), share), "{duty}");
                assert!(near(of(PwmMode::FullBridge, 2), less(share)), "{duty}");
                assert!(near(of(PwmMode::Direction, 0), less(share)), "{duty}");
                assert!(near(of(PwmMode::HalfBridge, 1), less(share.max(0.0))), "{duty}");
            }
        }
    }

    #[test]
    fn two_sides_of_a_leg_are_a_short() {
        let mut mean = PinMean::new(PwmMode::FullBridge, false, 10, 1);
        let leg = DrivePins {
            b_high: true,
            b_low: true,
            ..DrivePins::default()
        };
        mean.add(&leg, 7);
        mean.add(&DrivePins::default(), 3);
        assert_eq!((mean.shorted(), mean.take().share), (7, 0.0));
    }
}
