//! The inputs that all axes of the inline shaper share: enable, emergency stop, bypass and the clearing of faults.
//!
//! - `drive_enable` follows `enable` and `emergency_stop_n` without a clock. An emergency stop that lasts three clocks is
//!   remembered until the faults are cleared.
//! - The axes run while `enable` is high and there is no fault; a fault of one axis stops all of them.
//! - `bypass`, or with registers `bypass_request`, takes effect at a tick before which all axes are settled, or while none
//!   runs: then shaped and unshaped positions are equal, and no axis jumps.
//! - A rising edge of `clear_faults` clears the faults.
//!
//! ```text
//! clock                0   1   2   3   4
//! enable              _/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! drive_enable        _/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾   without a clock
//! run                 ____________/‾‾‾‾‾‾‾   two flip-flops, and a register
//! ```

use super::{ClockedBlock, FOREVER, Moore, OutputKind, Port, StepError, ports, show_each};

/// Number of inputs with one port.
const SINGLE: usize = 6;
/// Number of outputs.
const OUTPUTS: usize = 6;

ports! {
    inline_group_ports(N, R);

    inputs {
        /// Synchronous reset.
        rst: Bit;
        /// Pin: high lets the drives on and the axes follow; asynchronous.
        enable: Bit;
        /// Pin: low switches the drives off and stops the axes; asynchronous.
        emergency_stop_n: Bit;
        /// Pin: high asks for no shaping; asynchronous.
        bypass: Bit;
        /// Pin: its rising edge clears all faults; asynchronous.
        clear_faults: Bit;
        /// One clock: the sample tick.
        tick: Bit;
        /// `settled` of the axis.
        axis_settled[N]: Bit;
        /// `fault` of the axis.
        axis_fault[N]: Bit;
        /// Of the registers: high asks for no shaping, as the pin does.
        bypass_request[R]: Bit;
    }

    outputs {
        /// To the drives: `enable`, unless there is or was an emergency stop.
        drive_enable: Bit;
        /// To the axes: they follow their inputs.
        run: Bit;
        /// To the axes, one clock: clear the causes.
        clear: Bit;
        /// No axis shapes.
        bypassed: Bit;
        /// All axes are settled.
        settled: Bit;
        /// An axis has stopped with a cause, or there was an emergency stop.
        fault: Bit;
    }
}

/// Sizes of the group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InlineGroupConfig {
    /// Number of axes, 1 to [`MOST_AXES`](super::group::MOST_AXES).
    pub axes: usize,
    /// Whether registers, too, may ask for no shaping.
    pub with_registers: bool,
}

impl InlineGroupConfig {
    /// The group of this many axes, without registers.
    pub const fn without_registers(axes: usize) -> Self {
        Self {
            axes,
            with_registers: false,
        }
    }

    /// Number of ports `bypass_request`.
    pub const fn requests(self) -> usize {
        self.with_registers as usize
    }

    /// The ports of a group of these sizes.
    pub fn ports(self) -> Vec<Port> {
        ports(self.axes, self.requests())
    }

    const fn inputs(self) -> usize {
        SINGLE + 2 * self.axes + self.requests()
    }
}

/// The registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct State {
    /// Two flip-flops for each of enable, the emergency stop (high while it is pressed), bypass and clear.
    lines: [[bool; 2]; 4],
    clear_before: bool,
    awake: bool,
    emergency: bool,
    run: bool,
    clear: bool,
    bypassed: bool,
    settled: bool,
    fault: bool,
}

impl State {
    fn clock(&mut self, pins: [bool; 4], tick: bool, (all_settled, any_fault): (bool, bool), requested: bool) {
        let [enable, emergency, bypass, clear] = self.lines.map(|line| line[1]);
        let before = *self;
        self.awake = true;
        self.clear = clear && !before.clear_before;
        self.clear_before = clear;
        self.emergency = emergency || (before.emergency && !before.clear);
        self.run = enable && !emergency && !before.emergency && !any_fault;
        self.settled = all_settled;
        self.fault = before.emergency || any_fault;
        if tick && (all_settled || !before.run) {
            self.bypassed = bypass || requested;
        }
        for (line, pin) in self.lines.iter_mut().zip(pins) {
            *line = [pin, line[0]];
        }
    }
}

/// The cycle-accurate model of the group.
#[derive(Debug, Clone)]
pub struct InlineGroup {
    ports: Vec<Port>,
    config: InlineGroupConfig,
    state: State,
}

impl InlineGroup {
    /// The state after reset.
    pub fn new(config: InlineGroupConfig) -> Self {
        Self {
            ports: config.ports(),
            config,
            state: State::default(),
        }
    }

    /// The outputs while the drives are switched on, or off.
    fn outputs(&self, [enable, emergency_stop_n]: [bool; 2]) -> [u64; OUTPUTS] {
        let state = &self.state;
        let drives = enable && emergency_stop_n && state.awake && !state.emergency;
        [
            drives,
            state.run,
            state.clear,
            state.bypassed,
            state.settled,
            state.fault,
        ]
        .map(u64::from)
    }

    /// The state after a clock with these inputs.
    fn next(&self, inputs: &[u64]) -> State {
        let bit = |at: usize| inputs.get(at).is_some_and(|level| level & 1 != 0);
        let axes = self.config.axes;
        let mut settled = (0..axes).map(|axis| bit(SINGLE + axis));
        let mut faults = (0..axes).map(|axis| bit(SINGLE + axes + axis));
        let requested = self.config.with_registers && bit(SINGLE + 2 * axes);
        let mut state = self.state;
        if bit(0) {
            return State::default();
        }
        let pins = [bit(1), !bit(2), bit(3), bit(4)];
        state.clock(pins, bit(5), (settled.all(|is| is), faults.any(|is| is)), requested);
        state
    }
}

impl Moore for InlineGroup {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs([false; 2]));
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match output {
            "drive_enable" => OutputKind::Combinational,
            _ => OutputKind::Register,
        }
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        let pins = [1, 2].map(|at| inputs.get(at).is_some_and(|level| level & 1 != 0));
        show_each(outputs, self.outputs(pins));
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        if self.next(inputs) == self.state { FOREVER } else { 0 }
    }
}

impl ClockedBlock for InlineGroup {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        if (inputs.len(), outputs.len()) != (self.config.inputs(), OUTPUTS) {
            return Err(StepError(format!(
                "{} inputs and {} outputs: an inline group of {} axes has {} and {OUTPUTS}",
                inputs.len(),
                outputs.len(),
                self.config.axes,
                self.config.inputs()
            )));
        }
        self.show_with(inputs, outputs);
        self.state = self.next(inputs);
        Ok(())
    }
}
