//! The host program that operates the stage's registers.

use posicast_blocks::axis::{Cause, SupervisorState};
use posicast_blocks::error_table::FULL_WEIGHT;
use posicast_blocks::stage::StageConfig;
use std::fmt;

use super::shaping::Shaping;
use super::tables::AxisTables;
use crate::stage_bench::{StageBench, state};
use posicast_testbench::Error;

/// Number of clocks in which filters and encoders settle after a reset.
const SETTLE_CLOCKS: u64 = 1000;
/// A stage counts as stuck if it has not reacted after this many ticks.
const PATIENCE_TICKS: u64 = 100;
/// Word that kicks the watchdog: `KICK`.
const KICK: u32 = 0x4b49_434b;
/// Tap table bank that the host loads.
const BANK: u32 = 1;

/// A stage that did not do what it should.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    /// Number of clocks since the start.
    pub clock: u64,
    /// Name of the axis.
    pub axis: String,
    /// The expected action.
    pub wanted: &'static str,
    /// State that it was in instead, numbered as in [`state`].
    pub state: u32,
    /// Causes of a fault, a bit per [`Cause`].
    pub causes: u32,
}

impl Trouble {
    fn state_name(&self) -> &'static str {
        SupervisorState::from_value(self.state.into()).map_or("no state", SupervisorState::name)
    }

    fn cause_names(&self) -> Vec<&'static str> {
        let causes = Cause::ALL.into_iter().filter(|cause| self.causes & cause.bit() != 0);
        causes.map(Cause::name).collect()
    }

    /// Axis, state and causes, for a plot.
    pub fn in_short(&self) -> String {
        format!(
            "{} in {}: {}",
            self.axis,
            self.state_name(),
            self.cause_names().join(", ")
        )
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (state, causes) = (self.state_name(), self.cause_names());
        write!(
            f,
            "axis {} should have {}, and was in {state} in clock {}",
            self.axis, self.wanted, self.clock
        )?;
        if causes.is_empty() {
            Ok(())
        } else {
            write!(f, ", because of {}", causes.join(", "))
        }
    }
}

/// A stage on its bench, with the host that operates its registers.
pub(super) struct Host<'a> {
    pub(super) bench: StageBench,
    pub(super) config: &'a StageConfig,
    /// Clocks between kicks, if an axis has a watchdog.
    kick_clocks: Option<u64>,
    kicked: u64,
    /// Tables of the axes whose modes move with their position.
    tables: Vec<AxisTables>,
    /// Number of handovers from table to table.
    pub(super) handovers: u64,
    /// Whether the host homes the axes that have an error table.
    homes: bool,
}

impl<'a> Host<'a> {
    pub(super) fn new(bench: StageBench, config: &'a StageConfig, tables: Vec<AxisTables>, homes: bool) -> Self {
        let tick = u64::from(config.tick.tick_clocks());
        let ticks = config
            .axes
            .iter()
            .map(|axis| u64::from(axis.supervision.watchdog_ticks));
        let shortest = ticks.filter(|ticks| *ticks > 0).min();
        Self {
            bench,
            config,
            kick_clocks: shortest.map(|ticks| (ticks * tick / 2).max(1)),
            kicked: 0,
            tables,
            handovers: 0,
            homes,
        }
    }

    pub(super) fn tick_clocks(&self) -> u64 {
        self.config.tick.tick_clocks().into()
    }

    /// Lets time pass, and kicks the watchdogs in time.
    pub(super) fn pass(&mut self, clocks: u64) -> Result<(), Error> {
        let end = self.bench.now() + clocks;
        loop {
            let left = end.saturating_sub(self.bench.now());
            if left == 0 {
                return Ok(());
            }
            // Tables follow the position from tick to tick.
            let left = if self.tables.is_empty() {
                left
            } else {
                self.follow()?;
                left.min(self.tick_clocks())
            };
            let Some(pause) = self.kick_clocks else {
                self.bench.clocks(left)?;
                continue;
            };
            let due = (self.kicked + pause).saturating_sub(self.bench.now());
            if due == 0 {
                for axis in &self.config.axes {
                    self.bench.write(&format!("{}_kick", axis.name), KICK)?;
                }
                self.kicked = self.bench.now();
            }
            self.bench.clocks(left.min(due))?;
        }
    }

    /// Hands over to the tables for the present commands.
    fn follow(&mut self) -> Result<(), Error> {
        for tables in &mut self.tables {
            self.handovers += u64::from(tables.follow(&mut self.bench)?);
        }
        Ok(())
    }

    /// The axis's state, read internally; the bus would show the same slightly later.
    pub(super) fn state(&self, axis: usize) -> Result<u32, Error> {
        let net = format!("{}_state", self.config.axes[axis].name);
        Ok(self.bench.net(&net)? as u32)
    }

    /// Describes what an axis should have done and did not.
    pub(super) fn trouble(&mut self, axis: usize, wanted: &'static str) -> Result<Trouble, Error> {
        let name = &self.config.axes[axis].name;
        Ok(Trouble {
            clock: self.bench.now(),
            state: self.state(axis)?,
            causes: self.bench.read(&format!("{name}_causes"))?,
            axis: name.clone(),
            wanted,
        })
    }

    /// Waits, tick by tick, until `done` holds for each axis, or an axis is in a state from which that cannot happen.
    pub(super) fn wait(
        &mut self,
        wanted: &'static str,
        most_ticks: u64,
        done: impl Fn(&Self, usize) -> Result<bool, Error>,
    ) -> Result<Option<Trouble>, Error> {
        let end = self.bench.now() + most_ticks * self.tick_clocks();
        for axis in 0..self.config.axes.len() {
            while !done(self, axis)? {
                let lost = (0..self.config.axes.len()).map(|other| Ok((other, self.state(other)?)));
                let lost: Vec<(usize, u32)> = lost.collect::<Result<_, Error>>()?;
                let failed = |(_, state): &&(usize, u32)| [state::FAULT, state::QUICK_STOP].contains(state);
                if let Some((other, _)) = lost.iter().find(failed) {
                    return self.trouble(*other, wanted).map(Some);
                }
                if self.bench.now() >= end {
                    return self.trouble(axis, wanted).map(Some);
                }
                self.pass(self.tick_clocks())?;
            }
        }
        Ok(None)
    }

    /// Goes from reset to the state in which every axis holds its position.
    pub(super) fn switch_on(&mut self) -> Result<Option<Trouble>, Error> {
        self.pass(SETTLE_CLOCKS)?;
        for axis in &self.config.axes {
            self.bench.write(&format!("{}_clear_faults", axis.name), 0)?;
        }
        for axis in 0..self.config.axes.len() {
            // The cause of the PWM's first trip is over; others remain.
            let mut patience = PATIENCE_TICKS;
            while self.state(axis)? != state::READY {
                if patience == 0 {
                    return self.trouble(axis, "become ready").map(Some);
                }
                patience -= 1;
                self.pass(self.tick_clocks())?;
            }
        }
        for axis in &self.config.axes {
            self.bench.write(&format!("{}_control", axis.name), 1)?;
        }
        let trouble = self.wait("come to hold its position", PATIENCE_TICKS, |host, axis| {
            Ok(host.state(axis)? == state::HOLD)
        })?;
        match trouble {
            None if self.homes => self.home(),
            trouble => Ok(trouble),
        }
    }

    /// Declares the axes that have an error table homed, at the origin where their counters began at reset, and waits
    /// until the whole error counts.
    fn home(&mut self) -> Result<Option<Trouble>, Error> {
        let config = self.config;
        for axis in config.axes.iter().filter(|axis| axis.error_table.is_some()) {
            self.bench.write(&format!("{}_homed", axis.name), 1)?;
        }
        let most_ticks = u64::from(FULL_WEIGHT) + PATIENCE_TICKS;
        self.wait("taken its error table into account", most_ticks, |host, axis| {
            let axis = &host.config.axes[axis];
            match axis.error_table {
                None => Ok(true),
                Some(_) => Ok(host.bench.net(&format!("{}_error_weight", axis.name))? == u64::from(FULL_WEIGHT)),
            }
        })
    }

    /// Loads a table of one tap in place of each axis's own, if `shaping` asks for it.
    pub(super) fn shape(&mut self, shaping: Shaping) -> Result<Option<Trouble>, Error> {
        if shaping == Shaping::Shaped {
            return Ok(None);
        }
        for axis in &self.config.axes {
            let one = 1 << axis.shaper.coefficient_fraction();
            self.bench.write(&format!("{}_tap_address", axis.name), BANK << 8)?;
            self.bench.write(&format!("{}_tap", axis.name), one)?;
            self.bench.write(&format!("{}_swap", axis.name), BANK)?;
        }
        self.wait("taken another tap table", PATIENCE_TICKS, |host, axis| {
            let net = format!("{}_table_bank", host.config.axes[axis].name);
            Ok(host.bench.net(&net)? == u64::from(BANK))
        })
    }

    /// Waits for the brakes, then starts these axes together; there must be entries to play.
    pub(super) fn start(&mut self, axes: &[usize]) -> Result<Option<Trouble>, Error> {
        let release = self
            .config
            .axes
            .iter()
            .map(|axis| u64::from(axis.supervision.brake_release_ticks));
        let patience = PATIENCE_TICKS + release.max().unwrap_or(0);
        let trouble = self.wait("been able to start", patience, |host, axis| {
            let net = format!("{}_can_start", host.config.axes[axis].name);
            Ok(!axes.contains(&axis) || host.bench.net(&net)? != 0)
        })?;
        if trouble.is_some() {
            return Ok(trouble);
        }
        let mask = axes.iter().fold(0, |mask, axis| mask | 1 << axis);
        self.bench.write("start", mask)?;
        self.wait("started", PATIENCE_TICKS, |host, axis| {
            Ok(!axes.contains(&axis) || host.state(axis)? == state::RUN)
        })
    }

    /// Waits until all commands have reached their ends.
    pub(super) fn arrive(&mut self, most_ticks: u64) -> Result<Option<Trouble>, Error> {
        self.wait("come to the end of its motion", most_ticks, |host, axis| {
            Ok(host.state(axis)? == state::HOLD)
        })
    }

    /// Simulates this many ticks, in which every axis must hold its position (a fault would end that): the shapers'
    /// tail, and settling.
    pub(super) fn rest(&mut self, ticks: u64) -> Result<Option<Trouble>, Error> {
        for _ in 0..ticks {
            self.pass(self.tick_clocks())?;
            for axis in 0..self.config.axes.len() {
                if self.state(axis)? != state::HOLD {
                    return self.trouble(axis, "stayed at its target").map(Some);
                }
            }
        }
        Ok(None)
    }

    /// The present command position, Q24.8 counts.
    pub(super) fn command(&mut self, axis: usize) -> Result<i32, Error> {
        let name = &self.config.axes[axis].name;
        Ok(self.bench.read(&format!("{name}_command_position"))? as i32)
    }
}
