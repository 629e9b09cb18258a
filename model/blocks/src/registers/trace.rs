//! Registers of a trace memory, which the axes of a stage and of an inline shaper have at the same offsets, and the nets that they
//! drive and read.

use super::{Access, Field, Register};
use crate::composition::Part;
use crate::trace::SIGNALS;

/// Ports of the trace memory, and the nets that registers drive and read.
const NETS: [(&str, &str); 19] = [
    ("select_0", "trace_select_0"),
    ("select_1", "trace_select_1"),
    ("select_2", "trace_select_2"),
    ("select_3", "trace_select_3"),
    ("signals", "trace_signals"),
    ("decimation", "trace_decimation"),
    ("trigger_select", "trace_trigger_select"),
    ("trigger_mode", "trace_trigger_mode"),
    ("trigger_level", "trace_trigger_level"),
    ("pre_trigger", "trace_pre_trigger"),
    ("arm", "trace_arm"),
    ("halt", "trace_halt"),
    ("read_address", "trace_address"),
    ("data", "trace_data"),
    ("state", "trace_state"),
    ("rows", "trace_rows"),
    ("trigger_row", "trace_trigger_row"),
    ("missed", "trace_missed"),
    ("done", "trace_done"),
];

/// Connects a trace memory to its registers and to the nets that it records; `None`, and what is beyond them, is recorded as 0.
pub(crate) fn connect<'n>(part: Part, nets: impl IntoIterator<Item = Option<&'n str>>) -> Part {
    let part = NETS.iter().fold(part, |part, (port, net)| part.on(port, net));
    let nets = nets.into_iter().chain(std::iter::repeat(None));
    nets.take(SIGNALS).enumerate().fold(part, |part, (place, net)| {
        let port = format!("signal_{place}");
        match net {
            Some(net) => part.on(&port, net),
            None => part.tied(&port, 0),
        }
    })
}

/// What can be recorded on an axis.
pub(crate) struct Traced<'a> {
    /// The signals in the order of their numbers: net, and meaning of its words.
    pub(crate) signals: &'a [(&'a str, &'a str)],
    /// Event that can trigger a trace: name and meaning.
    pub(crate) event: (&'a str, &'a str),
}

impl Traced<'_> {
    /// A field that selects a signal, with the list of signals.
    fn signal(&self, name: &str, low: u32, meaning: &str) -> Field {
        let signals = (0..)
            .zip(self.signals)
            .map(|(value, (net, words))| (value, *net, *words));
        Field::choice(name, low, 4, meaning, &signals.collect::<Vec<_>>())
    }

    /// The registers, in words of the axis's window, without the flag that a trace is over.
    pub(crate) fn registers(&self) -> Vec<Register> {
        let selects = [0, 1, 2, 3].map(|place| {
            let name = format!("trace_select_{place}");
            self.signal(&name, 4 * place, "signal that is recorded")
        });
        let counts = [
            (0, "one", "signal per row"),
            (1, "two", "signals"),
            (2, "four", "signals"),
        ];
        let modes = [
            (0, "at_once", "with `TRACE_ARM`"),
            (1, "rising", "through `TRACE_LEVEL`"),
            (2, "falling", "through `TRACE_LEVEL`"),
            (3, self.event.0, self.event.1),
        ];
        let more = vec![
            Field::choice("trace_signals", 16, 2, "signals per row", &counts).with_reset(2),
            self.signal("trace_trigger_select", 20, "signal that is compared with the level"),
            Field::choice("trace_trigger_mode", 24, 2, "event that triggers the trace", &modes),
        ];
        vec![
            Register::new(
                "trace_setup",
                0x48,
                Access::Configuration,
                "signals and trigger of the trace; must not change during a trace",
                [selects.to_vec(), more].concat(),
            ),
            Register::new(
                "trace_rate",
                0x49,
                Access::Configuration,
                "interval of the rows, and rows before the trigger",
                vec![
                    Field::new("trace_decimation", 0, 16, "time skipped between rows").with_unit("ticks"),
                    Field::new("trace_pre_trigger", 16, 11, "rows before the trigger"),
                ],
            ),
            Register::new(
                "trace_level",
                0x4a,
                Access::Configuration,
                "level of the trigger",
                vec![Field::new("trace_trigger_level", 0, 32, "in the unit of the signal").signed()],
            ),
            Register::new(
                "trace_arm",
                0x4b,
                Access::command("trace_arm"),
                "discards the trace and begins a new one",
                vec![],
            ),
            Register::new(
                "trace_halt",
                0x4c,
                Access::command("trace_halt"),
                "ends the trace now",
                vec![],
            ),
            Register::new(
                "trace_address",
                0x4d,
                Access::Configuration,
                "index of the word in `TRACE_DATA`; the oldest is 0",
                vec![Field::new("trace_address", 0, 11, "row times signals, plus signal")],
            ),
            Register::new(
                "trace_data",
                0x4e,
                Access::Live,
                "a word of the trace, while it is idle",
                vec![Field::new("trace_data", 0, 32, "value of the signal")],
            ),
            Register::new(
                "trace_status",
                0x4f,
                Access::Live,
                "progress of the trace",
                vec![
                    Field::new("trace_state", 0, 2, "0 idle, 1 filling, 2 waiting, 3 taking"),
                    Field::flag("trace_missed", 2, "a tick came too early"),
                    Field::new("trace_rows", 4, 12, "rows that can be read"),
                    Field::new("trace_trigger_row", 16, 11, "row of the trigger"),
                ],
            ),
        ]
    }
}
