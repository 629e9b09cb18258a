//! The words of the supervisor: computed by hand, never less strict than the file, and an error for what does not
//! fit.

use posicast_blocks::stage::Supervision;
use posicast_machine::control::{LostSign, SupervisionError, TableBounds, lost_sign, no_travel, supervision};
use posicast_machine::machine_file::{self, LimitsSection, Machine, ScaleUse};
use posicast_machine::motion::TickLimits;
use posicast_shaper::unit::short;
use posicast_taps::{Tap, TapTable};
use proptest::prelude::*;

const TORQUE: &str = "mode = \"torque\"\nequivalent_mass = 64.274\nforce_constant = 475.01\ncurrent_limit_a = 2.73\n\
                      full_scale_a = 3.0";
const VELOCITY: &str = "mode = \"velocity\"\nfull_scale_velocity = 0.5";

/// Returns one controlled axis of a million counts per metre at 10 kHz with these limits.
fn machine(axis: &str, drive: &str, limits: &str) -> Machine {
    let text = format!(
        "name = \"one\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\n\
         counts_per_unit = 1_000_000\n{axis}\n[[axis.mode]]\nfrequency_hz = 131.1\ndamping = 0.158\n[axis.shaper]\n\
         kind = \"zvd\"\n[axis.encoder]\n[axis.scale]\ncounts_per_unit = 10_000_000\n[axis.pwm]\nmode = \"locked-antiphase\"\n\
         frequency_hz = 20_000\n[axis.drive]\n{drive}\n[axis.controller]\nkind = \"pd\"\n[axis.limits]\n{limits}\n"
    );
    machine_file::parse("one.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the bounds of a table with this many samples and this largest step.
fn bounds(longest_delay_samples: u32, farthest: f64) -> TableBounds {
    TableBounds {
        longest_delay_samples,
        farthest,
    }
}

fn of(machine: &Machine) -> Result<Supervision, SupervisionError> {
    supervision(&machine.axes[0], &machine.clock, bounds(79, 1.0))
}

fn with(limits: &str) -> Result<Supervision, SupervisionError> {
    of(&machine("", TORQUE, limits))
}

/// Supervision with every check disabled and every wait zero.
const LEFT_OUT: Supervision = Supervision {
    off_causes: 0b1000_1101_1000_0111,
    brake_release_ticks: 0,
    brake_apply_ticks: 0,
    settle_ticks: 79,
    soft_limit_plus: 0,
    soft_limit_minus: 0,
    limits_after_homing: false,
    following_error_limit: 0,
    deviation_limit: 0,
    deviation_ticks: 0,
    saturation_ticks: 0,
    lost_command: 0,
    lost_ticks: 0,
    watches_direction: false,
    watchdog_ticks: 0,
    filter_clocks: 0,
    stop_deceleration: 0,
    direct_limit: 250,
    direct_hold_ticks: 2000,
    excitation_limit: 1024,
};

#[test]
fn a_key_left_out_gives_its_documented_word() {
    assert_eq!(with(""), Ok(LEFT_OUT));
    let mut without = machine("", TORQUE, "");
    without.axes[0].limits = None;
    assert_eq!(of(&without), Ok(LEFT_OUT));
    // Here 0.2 s are more ticks than the word holds, or less than one.
    for (sample_hz, ticks) in [(1e6, 65535), (1.0, 1)] {
        without.clock.sample_hz = sample_hz;
        assert_eq!(of(&without).unwrap().direct_hold_ticks, ticks);
    }
}

#[test]
fn golden_words_worked_out_by_hand() {
    let limits = "travel = [-0.1, 0.1]\nsoft_limits_after_homing = true\nfollowing_error = 0.001\nbrake_release_s = 0.05\nbrake_apply_s = 0.03\n\
                  acceleration = 8.0\ndeviation = 50e-6\ndeviation_s = 0.02\nsaturation_s = 0.3\nencoder_lost_s = 0.02\nwatchdog_s = 0.5\n\
                  line_filter_s = 1e-6\noff = [\"watchdog\"]\ndirect_duty = 0.05\ndirect_hold_s = 0.1\nexcitation = 10e-6";
    let expected = Supervision {
        off_causes: 0b0010_0000_0000_0011,
        brake_release_ticks: 500,
        brake_apply_ticks: 300,
        settle_ticks: 79,
        // 100,000 counts in units of 1/256.
        soft_limit_plus: 25_600_000,
        soft_limit_minus: -25_600_000,
        limits_after_homing: true,
        // 1000 counts in units of 1/65536.
        following_error_limit: 65_536_000,
        deviation_limit: 50,
        deviation_ticks: 200,
        saturation_ticks: 3000,
        // Half of 3000 mA, times 4096.
        lost_command: 6_144_000,
        lost_ticks: 200,
        watches_direction: false,
        watchdog_ticks: 5000,
        filter_clocks: 50,
        // 0.08 counts per tick², times 2^24: 1342177.28.
        stop_deceleration: 1_342_177,
        direct_limit: 125,
        direct_hold_ticks: 1000,
        excitation_limit: 2560,
    };
    assert_eq!(with(limits), Ok(expected));
    let stop = format!("{limits}\nstop_deceleration = 16.0");
    assert_eq!(with(&stop).unwrap().stop_deceleration, 2_684_354);
    let names: Vec<&str> = expected.words().iter().map(|(name, _)| *name).collect();
    let found: Vec<i64> = expected.words().iter().map(|(_, word)| *word).collect();
    assert_eq!(
        names[4..8],
        [
            "soft_limit_plus",
            "soft_limit_minus",
            "limits_after_homing",
            "following_error_limit"
        ]
    );
    assert_eq!(found[4..8], [25_600_000, -25_600_000, 1, 65_536_000]);
    assert_eq!(found.len(), 20);
    // A velocity drive has half of 500 mm/s.
    let velocity = of(&machine("", VELOCITY, limits)).unwrap();
    assert_eq!((velocity.lost_command, velocity.watches_direction), (1_024_000, true));
    // The scale's position has ten times as many counts; the test signal's word then ends at 25.6 µm.
    let mut scale = machine("", TORQUE, limits);
    scale.axes[0].scale.as_mut().unwrap().usage = ScaleUse::Position;
    let scale = of(&scale).unwrap();
    assert_eq!((scale.deviation_limit, scale.following_error_limit), (500, 655_360_000));
    assert_eq!((scale.soft_limit_plus, scale.excitation_limit), (256_000_000, 25_600));
    // An axis that turns without end does not stop at its travel.
    let modulo = of(&machine("modulo = true", TORQUE, limits)).unwrap();
    assert_eq!((modulo.soft_limit_plus, modulo.soft_limit_minus), (0, 0));
}

#[test]
fn what_does_not_fit_names_its_key_and_the_range() {
    let refused = |limits: &str, key: &str, message: &str| {
        let error = with(limits).unwrap_err();
        assert_eq!((error.key(), error.to_string().as_str()), (key, message), "{limits}");
    };
    let range = |key: &str, found: &str, allowed: &str| {
        let dotted = format!("axis.limits.{key}");
        let shown = short(found.parse().unwrap());
        refused(
            &format!("{key} = {found}"),
            &dotted,
            &format!("axis x: found {shown} {allowed}"),
        );
    };
    let counts = "m; allowed: 1.52588e-11 to 0.0327679 m, which are counts in a word of 32 bits";
    range("following_error", "0.04", counts);
    range("following_error", "0.000000000001", counts);
    range(
        "deviation",
        "0.0000009",
        "m; allowed: 0.000001 to 2147.48 m, which are counts in a word of 32 bits",
    );
    let amplitude = "m; allowed: 3.90625e-9 to 0.000255996 m, which are less than 256 counts";
    range("excitation", "0.000256", amplitude);
    let ticks = "s; allowed: 0.0001 to 6.5535 s, which are ticks of 16 bits";
    for key in ["saturation_s", "encoder_lost_s", "watchdog_s", "direct_hold_s"] {
        range(key, "0.00009", ticks);
    }
    // The reader of the file refuses times above the ticks; a machine from elsewhere may have them.
    type Set = fn(&mut LimitsSection);
    let long: [(&str, &str, Set); 3] = [
        ("watchdog_s", "0.0001", |limits| limits.watchdog_s = 6.6),
        ("direct_hold_s", "0.0001", |limits| limits.direct_hold_s = Some(6.6)),
        ("brake_apply_s", "0", |limits| limits.brake_apply_s = 6.6),
    ];
    for (key, least, set) in long {
        let mut machine = machine("", TORQUE, "");
        set(machine.axes[0].limits.as_mut().unwrap());
        let error = of(&machine).unwrap_err();
        let text = format!("axis x: found 6.6 s; allowed: {least} to 6.5535 s, which are ticks of 16 bits");
        assert_eq!(
            (error.key(), error.to_string()),
            (format!("axis.limits.{key}").as_str(), text)
        );
        assert_eq!(error.remedy(), format!("write `{key} = 6.5535`, or less"));
    }
    range(
        "line_filter_s",
        "0.0000013",
        "s; allowed: 0 to 0.00000126 s, which are up to 63 clocks",
    );
    let deceleration = "m/s²; allowed: 0.00000596047 to 12799.9 m/s², with which a quick stop can slow \
                        down, in counts per tick²";
    range("stop_deceleration", "12800", deceleration);
    range("stop_deceleration", "0.000001", deceleration);
    range("acceleration", "20000", deceleration);
    let lost = "encoder_lost_s = 1\nencoder_lost_command = 0.92";
    let error = with(lost).unwrap_err();
    assert_eq!(error.key(), "axis.limits.encoder_lost_command");
    assert!(error.to_string().contains("allowed: 0 to 0.909999"), "{error}");
    let narrow = "axis x: found a travel from 1e-7 to 1.001e-7 m; allowed: one that is wider than a count, 0.000001 m";
    refused("travel = [1e-7, 1.001e-7]", "axis.limits.travel", narrow);
    let around_0 = "travel = [-1e-10, 1e-10]";
    assert_eq!(with(around_0).unwrap_err().key(), "axis.limits.travel");
    let long = supervision(
        &machine("", TORQUE, "").axes[0],
        &machine("", TORQUE, "").clock,
        bounds(65_536, 1.0),
    );
    assert_eq!(long.unwrap_err().key(), "axis.shaper");
    let mut bare = machine("", TORQUE, "");
    bare.axes[0].drive = None;
    assert!(matches!(
        of(&bare),
        Err(SupervisionError::Missing { table: "drive", .. })
    ));
}

#[test]
fn a_travel_beyond_the_command_is_refused_where_the_machine_has_a_wider_word() {
    let mut wide = machine("", TORQUE, "travel = [0.0, 1.0]");
    wide.axes[0].limits.as_mut().unwrap().travel = Some([0.0, 8.4]);
    let error = of(&wide).unwrap_err();
    assert_eq!(error.key(), "axis.limits.travel");
    assert!(error.to_string().contains("allowed: -8.3886 to 8.3886 m"), "{error}");
}

#[test]
fn limits_of_moves_in_ticks() {
    let limits = |limits: &str| {
        let machine = machine("", TORQUE, limits);
        TickLimits::of_axis(&machine.axes[0], &machine.clock)
    };
    assert_eq!(
        limits("velocity = 0.1\njerk = 100"),
        TickLimits::new(0.1, 8.0, 100.0, 1e6, 1e4)
    );
    assert_eq!(limits(""), TickLimits::new(0.25, 8.0, 400.0, 1e6, 1e4));
}

#[test]
fn a_travel_fits_wherever_the_axis_stands_at_reset() {
    // The count is 0 there, perhaps at one end: a scale of 12.5 nm has 8 million counts on either side of the middle.
    let mut fine = machine("", TORQUE, "travel = [-0.1, 0.1]");
    let scale = fine.axes[0].scale.as_mut().unwrap();
    (scale.usage, scale.counts_per_unit) = (ScaleUse::Position, 80e6);
    let error = of(&fine).unwrap_err();
    assert_eq!(error.key(), "axis.limits.travel");
    let text = error.to_string();
    assert!(
        text.contains("covers 0.2 m;") && text.contains("at most 0.1015808 m together at 80000000 counts"),
        "{text}"
    );
    // A resolution of one micrometre reaches 8.126464 m; with 8 m/s² at 0.25 m/s, a stop takes 3.9 mm of it. A shaper
    // may go further than its command.
    let reaches = |travel: f64, farthest: f64| {
        let mut machine = machine("", TORQUE, "velocity = 0.25\nacceleration = 8.0");
        machine.axes[0].limits.as_mut().unwrap().travel = Some([-1.0, travel - 1.0]);
        supervision(&machine.axes[0], &machine.clock, bounds(79, farthest)).is_ok()
    };
    assert!(reaches(8.122, 1.0) && !reaches(8.123, 1.0));
    assert!(reaches(4.061, 2.0) && !reaches(4.062, 2.0));
    let taps = |coefficients: [i32; 3]| {
        let taps = (0..).zip(coefficients).map(|(delay_samples, coefficient)| Tap {
            delay_samples,
            coefficient,
        });
        TableBounds::from(&TapTable::new(15, taps.collect()).unwrap())
    };
    assert_eq!(taps([1 << 14, 1 << 13, 1 << 13]), bounds(2, 1.0));
    assert_eq!(taps([1 << 15, -(1 << 16), 1 << 16]), bounds(2, 2.0));
    assert_eq!(taps([3 << 14, -(1 << 15), 1 << 14]).farthest, 1.5);
    // Without a travel, a warning tells the reach; a rotary axis turns for ever.
    let warning = no_travel(&machine("", TORQUE, "").axes[0]).unwrap().to_string();
    assert!(warning.contains("reaches 8.126464 m"), "{warning}");
    assert_eq!(no_travel(&machine("modulo = true", TORQUE, "").axes[0]), None);
    assert_eq!(no_travel(&fine.axes[0]), None);
}

proptest! {
    /// Over the whole range of the file and beyond the words, the result is a limit or an error, and never a less
    /// strict limit.
    #[test]
    fn prop_no_word_is_looser_than_its_value(
        exponent in prop::collection::vec(-14.0..9.0f64, 8),
        counts in -3.0..12.0f64,
        sample in 0.0..6.0f64,
    ) {
        let mut machine = machine("", TORQUE, "");
        let value = |at: usize| 10f64.powf(exponent[at]);
        let (counts_per_unit, sample_hz) = (10f64.powf(counts), 10f64.powf(sample));
        machine.axes[0].counts_per_unit = counts_per_unit;
        machine.clock.sample_hz = sample_hz;
        let limits = machine.axes[0].limits.as_mut().unwrap();
        // One value changes at a time, so that each meets its own word.
        let which = (exponent[7] * 1e3).abs() as usize % 7;
        match which {
            0 => limits.following_error = Some(value(0)),
            1 => limits.deviation = Some(value(1)),
            2 => limits.saturation_s = value(2).min(60.0),
            3 => limits.stop_deceleration = Some(value(3)),
            4 => limits.travel = Some([-value(4), value(5)]),
            5 => limits.brake_apply_s = value(2).min(60.0),
            _ => limits.excitation = Some(value(6)),
        }
        let limits = *limits;
        let near = 1.0 + 2e-9;
        match of(&machine) {
            Err(error) => prop_assert!(error.key().starts_with("axis.limits."), "{}", error),
            Ok(words) => {
                let below = |word: f64, asked: f64| word > 0.0 && word <= asked * near;
                let [low, high] = limits.travel.unwrap_or([0.0; 2]).map(|m| m * counts_per_unit * 256.0);
                let holds = match which {
                    0 => below(words.following_error_limit.into(), value(0) * counts_per_unit * 65536.0),
                    1 => below(words.deviation_limit.into(), value(1) * counts_per_unit),
                    2 => below(words.saturation_ticks.into(), limits.saturation_s * sample_hz),
                    3 => below(
                        words.stop_deceleration.into(),
                        value(3) * counts_per_unit / sample_hz.powi(2) * f64::from(1 << 24),
                    ),
                    4 => f64::from(words.soft_limit_plus) <= high * near
                        && f64::from(words.soft_limit_minus) >= low * near
                        && (words.soft_limit_plus, words.soft_limit_minus) != (0, 0),
                    5 => f64::from(words.brake_apply_ticks) * near >= limits.brake_apply_s * sample_hz,
                    _ => below(words.excitation_limit.into(), value(6) * counts_per_unit * 256.0),
                };
                prop_assert!(holds, "{:?} {:?}", words, limits);
            }
        }
    }
}

#[test]
fn a_wrong_sign_is_watched_where_a_sound_axis_stops_sooner() {
    // Half of 3 A give 11.085 m/s²: 0.25 m/s take 22.55 ms, and a fifth more 27.06 ms.
    let of = |drive, limits: &str| lost_sign(&machine("", drive, limits).axes[0]);
    let velocity = "velocity = 0.25\n";
    let LostSign::TooShort { least_s } = of(TORQUE, &format!("{velocity}encoder_lost_s = 0.027")) else {
        panic!("27 ms are too short");
    };
    assert!((least_s - 0.027_063).abs() < 1e-6, "{least_s}");
    for (drive, limits, expected) in [
        (TORQUE, format!("{velocity}encoder_lost_s = 0.0271"), LostSign::Watched),
        (TORQUE, "encoder_lost_s = 0.05".to_owned(), LostSign::Unknown),
        (TORQUE, velocity.to_owned(), LostSign::Unknown),
        (
            TORQUE,
            format!("{velocity}encoder_lost_s = 0.05\nencoder_lost_command = 0.0"),
            LostSign::Unknown,
        ),
        (VELOCITY, "encoder_lost_s = 0.001".to_owned(), LostSign::Watched),
        (VELOCITY, String::new(), LostSign::Unknown),
    ] {
        assert_eq!(of(drive, &limits), expected, "{limits}");
        let watched = supervision(
            &machine("", drive, &limits).axes[0],
            &machine("", drive, &limits).clock,
            bounds(79, 1.0),
        );
        assert_eq!(watched.unwrap().watches_direction, expected == LostSign::Watched);
    }
}
