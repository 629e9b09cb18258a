//! Registers of the stand-alone PWM.

use super::super::{Access, Description, Field, FlagSource};
use crate::pwm::{BridgeMode, PwmConfig, TIME_BITS};

/// The map of a PWM that has this mode and period after reset. `period_clocks` is 2 to 65,536.
pub fn pwm(config: &PwmConfig, mode: BridgeMode, period_clocks: u32) -> Description {
    use Access::{Configuration, Live, Sticky};
    let guarded = || Access::Guarded {
        while_low: "running".to_owned(),
    };
    let clocks = |name: &str, low, width, meaning: &str| Field::new(name, low, width, meaning).with_unit("clocks");
    let floors = [config.dead_time_floor_clocks(), config.minimum_pulse_floor_clocks()].map(u32::from);
    let parameters = vec![
        clocks("dead_time_floor", 0, TIME_BITS, "shortest dead time").with_reset(floors[0]),
        clocks("minimum_pulse_floor", 0, TIME_BITS, "shortest minimum pulse").with_reset(floors[1]),
    ];
    let about = "PWM: turns a duty, from register or pins, into the gates of a bridge, with dead time and fault path.";
    Description::new("pwm", about, *b"PWM1", (1, 0), parameters)
        .with("control", 0x10, Configuration, "enable and mode", control(mode))
        .with(
            "status",
            0x11,
            Live,
            "state of the outputs",
            vec![
                Field::flag("running", 0, "the outputs are on"),
                Field::flag("tripped", 1, "a cause keeps the outputs off"),
                Field::flag("negative", 2, "the direction in use is negative"),
                Field::new(
                    "trip_causes",
                    8,
                    5,
                    "from the lowest bit: fault latch, filtered fault 0 and 1, PLL, watchdog",
                ),
            ],
        )
        .with(
            "flags",
            0x12,
            Sticky,
            "events since the flag was cleared",
            vec![
                Field::flag("saturated", 0, "a duty was limited"),
                Field::flag(
                    "refused",
                    1,
                    "a period, dead time or minimum pulse differed from that in use while running",
                ),
                Field::flag(
                    "below_floor",
                    2,
                    "a dead time or minimum pulse was below its lower limit, or the period is exactly twice their sum",
                ),
                Field::flag("unaligned", 3, "`sync` came at another phase while running"),
                super::partial_write(4),
                Field::flag(
                    "guard_refused",
                    5,
                    "a write to a guarded register was \
                    ignored",
                )
                .set_by(FlagSource::GuardRefused),
            ],
        )
        .with_interrupts(
            0x14,
            vec![
                Field::flag("tripped", 0, "a cause keeps the outputs off"),
                Field::flag("saturated", 1, "a duty was limited"),
                Field::flag("unaligned", 2, "`sync` came at another phase"),
                Field::flag("valley", 3, "a period has begun"),
                Field::flag("trigger", 4, "the trigger's phase has come"),
            ],
        )
        .with(
            "period",
            0x18,
            guarded(),
            "period of the PWM",
            vec![
                clocks("period", 0, 16, "length of the period, from 64; 0 stands for 65536")
                    .with_reset(period_clocks & 0xffff),
            ],
        )
        .with(
            "times",
            0x19,
            guarded(),
            "times that driver and bridge need",
            vec![
                clocks("dead_time", 0, TIME_BITS, "time from one side off to the other on")
                    .with_reset(floors[0])
                    .at_least(floors[0]),
                clocks("minimum_pulse", 16, TIME_BITS, "shortest pulse")
                    .with_reset(floors[1])
                    .at_least(floors[1]),
            ],
        )
        .with(
            "duty",
            0x1a,
            Configuration,
            "the next duty",
            vec![clocks("host_x_0", 0, 17, "high time; beyond the period is full").signed()],
        )
        .with(
            "max_duty",
            0x1b,
            Configuration,
            "largest magnitude of the duty",
            vec![clocks("max_duty", 0, 16, "largest high time").with_reset(period_clocks.min(0xffff))],
        )
        .with(
            "phase",
            0x1c,
            Configuration,
            "positions in the period, from the valley",
            vec![
                clocks(
                    "phase",
                    0,
                    16,
                    "position of the carrier when `sync` comes; below `period`",
                ),
                clocks("trigger_phase", 16, 16, "position at which `trigger` comes"),
            ],
        )
        .with(
            "supervision",
            0x1d,
            Configuration,
            "time limits of watchdog and fault filter",
            vec![
                Field::new(
                    "watchdog_periods",
                    0,
                    8,
                    "valleys allowed without a feed; 0 disables the \
                    watchdog",
                )
                .with_unit("periods"),
                clocks("filter_clocks", 8, 8, "longest filtered fault without effect"),
            ],
        )
        .with(
            "feed",
            0x1e,
            Access::command("host_strobe"),
            "feeds the watchdog: the controller is alive",
            vec![],
        )
        .with(
            "clear_trip",
            0x1f,
            Access::command("clear_trip"),
            "forgets the causes that are over",
            vec![],
        )
        .with(
            "times_used",
            0x20,
            Live,
            "times in use",
            vec![
                clocks("dead_time_used", 0, TIME_BITS, "dead time"),
                clocks("minimum_pulse_used", 16, TIME_BITS, "minimum pulse"),
            ],
        )
}

fn control(mode: BridgeMode) -> Vec<Field> {
    let modes = [
        (0, "direction", "PWM and direction"),
        (1, "half_bridge", "leg A"),
        (2, "unipolar", "full bridge, one leg switches"),
        (3, "locked", "full bridge, locked antiphase: 0 is 50 %"),
    ];
    vec![
        Field::flag(
            "enable",
            0,
            "1: outputs on from the next start of a period; 0: off at once",
        ),
        Field::flag(
            "from_pins",
            1,
            "`duty` and `feed` come from the pins, not the registers",
        ),
        Field::flag("update_at_peak", 2, "duty and mode are taken at the peak too"),
        Field::choice("mode", 8, 2, "use of the four pins", &modes).with_reset(mode as u32),
    ]
}
