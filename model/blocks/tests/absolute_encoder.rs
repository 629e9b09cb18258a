//! The absolute encoder: what a configuration may be, when a reading is there, and what the count does.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoder, AbsoluteEncoderConfig, AbsoluteEncoderConfigError, AbsoluteFrame, AbsoluteLimits,
    AbsoluteProtocol, AbsoluteTimes, AbsoluteTimesInSeconds, FrameCheck, FrameStatusBit, Inputs, Outputs,
};

const TIMES: AbsoluteTimes = AbsoluteTimes {
    half_period_clocks: 5,
    pause_clocks: 100,
    answer_clocks: 120,
};
const LIMITS: AbsoluteLimits = AbsoluteLimits {
    largest_jump: 300,
    tolerated: 2,
};

fn ssi(position_bits: u32) -> AbsoluteEncoderConfig {
    AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, AbsoluteFrame::ssi(position_bits), TIMES, LIMITS).unwrap()
}

fn biss() -> AbsoluteEncoderConfig {
    AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(18), TIMES, LIMITS).unwrap()
}

fn refused(frame: AbsoluteFrame, times: AbsoluteTimes, limits: AbsoluteLimits) -> String {
    let of = |protocol| AbsoluteEncoderConfig::new(protocol, frame, times, limits);
    of(AbsoluteProtocol::BissC).unwrap_err().to_string()
}

#[test]
fn sizes_that_cannot_be_built_are_refused() {
    let frame = AbsoluteFrame::biss_c(18);
    let said = |message: String, words: &str| assert!(message.contains(words), "{message}");
    said(refused(AbsoluteFrame::biss_c(7), TIMES, LIMITS), "a position of 7 bits");
    said(
        refused(AbsoluteFrame::biss_c(41), TIMES, LIMITS),
        "a position of 41 bits",
    );
    let leading_bits = 17;
    said(
        refused(AbsoluteFrame { leading_bits, ..frame }, TIMES, LIMITS),
        "17 leading bits",
    );
    let trailing_bits = 17;
    said(
        refused(AbsoluteFrame { trailing_bits, ..frame }, TIMES, LIMITS),
        "17 trailing bits",
    );
    let trailing_bits = 1;
    said(
        refused(AbsoluteFrame { trailing_bits, ..frame }, TIMES, LIMITS),
        "the warning bit has place 1",
    );
    let check = FrameCheck::OddParity;
    said(
        refused(AbsoluteFrame { check, ..frame }, TIMES, LIMITS),
        "with the check `odd`",
    );
    for (times, words) in [
        (
            AbsoluteTimes {
                half_period_clocks: 1,
                ..TIMES
            },
            "`half period` takes 1 clocks: 2 to 4095",
        ),
        (
            AbsoluteTimes {
                pause_clocks: 7,
                ..TIMES
            },
            "`pause` takes 7 clocks",
        ),
        (
            AbsoluteTimes {
                answer_clocks: 39,
                ..TIMES
            },
            "`answer` takes 39 clocks: 40 to 32767",
        ),
    ] {
        said(refused(frame, times, LIMITS), words);
    }
    said(
        refused(
            frame,
            TIMES,
            AbsoluteLimits {
                tolerated: 256,
                ..LIMITS
            },
        ),
        "256 failed readings",
    );
    // Half the range of 18 bits is 131072 counts: 3 · 43690 are below, 3 · 43691 are not.
    let jump = |largest_jump| AbsoluteLimits { largest_jump, ..LIMITS };
    said(refused(frame, TIMES, jump(43_691)), "at most 131071 counts");
    said(refused(frame, TIMES, jump(0)), "a jump of 0 counts");
    AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, frame, TIMES, jump(43_690)).unwrap();
}

#[test]
fn times_are_rounded_so_that_the_line_is_never_too_fast() {
    let asked = |line_hz| AbsoluteTimesInSeconds {
        line_hz,
        pause_s: 20e-6,
        answer_s: 5e-6,
    };
    let of = |line_hz, protocol| AbsoluteTimes::from_seconds(asked(line_hz), protocol, 50e6);
    // 10 MHz are 2.5 clocks each half: 8.3 MHz are the fastest below.
    let fast = of(10e6, AbsoluteProtocol::BissC).unwrap();
    assert_eq!(
        (fast.half_period_clocks, fast.pause_clocks, fast.answer_clocks),
        (3, 1000, 250)
    );
    let slow = of(100e3, AbsoluteProtocol::Ssi).unwrap();
    assert_eq!((slow.half_period_clocks, slow.answer_clocks), (250, 0));
    let too_fast = of(2.1e6, AbsoluteProtocol::Ssi).unwrap_err();
    assert!(
        matches!(too_fast, AbsoluteEncoderConfigError::LineHz { .. }),
        "{too_fast}"
    );
    assert!(of(10.1e6, AbsoluteProtocol::BissC).is_err());
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = of(wrong, AbsoluteProtocol::BissC).unwrap_err();
        assert!(error.to_string().contains("line_hz"), "{error}");
    }
}

/// An encoder without delay, for one reading after the other; its bits are those of the frame given.
struct Bench {
    block: AbsoluteEncoder,
    config: AbsoluteEncoderConfig,
    clock_out: bool,
    rises: usize,
    data: bool,
}

impl Bench {
    fn new(config: &AbsoluteEncoderConfig) -> Self {
        let mut bench = Self {
            block: AbsoluteEncoder::new(config),
            config: *config,
            clock_out: true,
            rises: 0,
            data: true,
        };
        bench.clocks(4, &[]);
        bench
    }

    fn clock(&mut self, tick: bool, clear_flags: bool, stream: &[bool]) -> Outputs {
        let inputs = Inputs {
            tick,
            clear_flags,
            data: self.data,
            ..Inputs::default()
        };
        let shown = self.block.step(&inputs);
        let now = self.block.outputs().clock_out;
        if now && !self.clock_out {
            self.data = stream.get(self.rises).copied().unwrap_or(false);
            self.rises += 1;
        }
        self.clock_out = now;
        shown
    }

    fn clocks(&mut self, clocks: u64, stream: &[bool]) {
        for _ in 0..clocks {
            self.clock(false, false, stream);
        }
    }

    /// A reading with the levels after the rising edges; returns the clocks to `valid`, and the outputs then or at the end.
    fn reading(&mut self, stream: &[bool]) -> (Option<u64>, Outputs) {
        self.rises = 0;
        self.clock(true, false, stream);
        let mut valid = None;
        for clock in 1..self.config.least_tick_clocks() {
            let shown = self.clock(false, false, stream);
            if shown.valid {
                assert_eq!(valid, None, "twice");
                valid = Some((clock, shown));
            }
            if clock == self.config.most_valid_clocks() {
                // The encoder is ready again.
                self.data = true;
            }
        }
        valid.map_or((None, self.block.outputs()), |(clock, shown)| (Some(clock), shown))
    }
}

fn bits(word: u64, bits: u32) -> Vec<bool> {
    (0..bits).rev().map(|bit| word >> bit & 1 == 1).collect()
}

#[test]
fn a_reading_of_ssi_is_valid_in_its_time() {
    let config = ssi(12);
    let mut bench = Bench::new(&config);
    let (clocks, shown) = bench.reading(&bits(0xabd, 12));
    assert_eq!((shown.count, shown.extrapolated, shown.known), (0xabd, false, true));
    // Half a period, twelve bits, and the line is low two clocks after the edge behind the last bit.
    assert_eq!(clocks, Some(5 + 12 * 10 + 2 + 5));
    assert!(clocks <= Some(config.most_valid_clocks()));
    assert_eq!(config.latch_clocks(), 1);
}

#[test]
fn the_count_goes_on_beyond_the_range_both_ways() {
    let mut bench = Bench::new(&ssi(12));
    let mut expected = 3900;
    bench.reading(&bits(3900, 12));
    for change in [200, 200, 300, -300, -300, -300, -299, 0, 1] {
        expected += change;
        let (_, shown) = bench.reading(&bits((expected & 4095) as u64, 12));
        assert_eq!((shown.count, shown.extrapolated), (expected, false));
    }
    let mut bench = Bench::new(&ssi(12));
    bench.reading(&bits(5, 12));
    assert_eq!(bench.reading(&bits(4090, 12)).1.count, -6);
}

#[test]
fn failed_readings_continue_until_the_axis_is_lost() {
    let config = ssi(12);
    let mut bench = Bench::new(&config);
    for position in [1000, 1040] {
        bench.reading(&bits(position, 12));
    }
    // The line stays high: the encoder is not there.
    let silence = [true; 20];
    for expected in [1080, 1120] {
        let (clocks, shown) = bench.reading(&silence);
        assert_eq!((shown.count, shown.extrapolated, shown.silent), (expected, true, true));
        assert_eq!(clocks, Some(config.most_valid_clocks()));
    }
    // A good one counts from the last good one, even where it is three limits away.
    let (_, shown) = bench.reading(&bits(1940, 12));
    assert_eq!((shown.count, shown.extrapolated, shown.jumped), (1940, false, false));
    for _ in 0..2 {
        // The change of a single reading is still 40.
        bench.reading(&silence);
    }
    assert_eq!(bench.block.outputs().count, 2020);
    let (clocks, shown) = bench.reading(&silence);
    assert_eq!(
        (clocks, shown.lost, shown.known, shown.count),
        (None, true, false, 2020)
    );
    let (clocks, shown) = bench.reading(&bits(2030, 12));
    assert_eq!((clocks, shown.lost, shown.count), (None, true, 2020));
    bench.clock(false, true, &[]);
    let (_, shown) = bench.reading(&bits(77, 12));
    assert_eq!(
        (shown.count, shown.known, shown.lost, shown.silent),
        (77, true, false, false)
    );
}

#[test]
fn a_jump_is_one_count_beyond_the_limit() {
    for (change, jumps) in [(300, false), (-300, false), (301, true), (-301, true)] {
        let mut bench = Bench::new(&ssi(12));
        bench.reading(&bits(1000, 12));
        let (_, shown) = bench.reading(&bits((1000 + change) as u64, 12));
        assert_eq!((shown.jumped, shown.extrapolated), (jumps, jumps), "{change}");
        assert_eq!(shown.count, if jumps { 1000 } else { 1000 + change });
    }
}

#[test]
fn an_error_bit_of_ssi_fails_the_reading() {
    let frame = AbsoluteFrame {
        trailing_bits: 1,
        error: Some(FrameStatusBit {
            place: 0,
            active_low: false,
        }),
        ..AbsoluteFrame::ssi(12)
    };
    let config = AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, TIMES, LIMITS).unwrap();
    let mut bench = Bench::new(&config);
    bench.reading(&bits(100 << 1, 13));
    let (_, shown) = bench.reading(&bits(120 << 1 | 1, 13));
    assert_eq!((shown.count, shown.extrapolated, shown.error_bit), (100, true, true));
}

/// The frame of position 0 without error and warning: 18 zeros and two ones. x + 1 times x^6 leaves (x + 1)², which is x² + 1; inverted
/// 111010.
#[test]
fn a_frame_of_biss_has_the_crc_of_its_polynomial() {
    let config = biss();
    let mut stream = vec![true, false, true, false];
    stream.extend(bits(0b11, 20));
    stream.extend(bits(0b11_1010, 6));
    let mut bench = Bench::new(&config);
    let (clocks, shown) = bench.reading(&stream);
    assert_eq!((shown.count, shown.check_failed, shown.known), (0, false, true));
    assert_eq!(shown.line_delay, 0);
    // The second rising edge after three halves, two clocks of the synchroniser, answer and start bit, the bit 0, 26 bits.
    assert_eq!(clocks, Some(3 * 5 + 1 + 2 + 5 + 28 * 10 + 1 + 3));
    assert_eq!(config.latch_clocks(), 6);

    for place in 4..stream.len() {
        let mut wrong = stream.clone();
        wrong[place] ^= true;
        let mut bench = Bench::new(&config);
        let (clocks, shown) = bench.reading(&wrong);
        assert_eq!(
            (clocks, shown.check_failed, shown.known),
            (None, true, false),
            "bit {place}"
        );
    }
}
