//! The processor time of the design, on one core: one mode, four modes, two modes with signed commands.
//!
//! ```text
//! cargo bench --workspace --bench shortest
//! ```
//!
//! Other programs on the machine do not change processor time much. It is Linux's; elsewhere the bench measures time on the clock.

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{Criterion, criterion_group, criterion_main};
use posicast_optimal::{Band, Command, Prefer, Request, shortest};
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::{Duration, Instant};

fn request(sample_hz: f64, modes: &[(f64, f64)], tolerance: f64, width: f64, command: Command) -> Request {
    let band = |&(frequency_hz, damping): &(f64, f64)| Band {
        frequency_hz: [frequency_hz * (1.0 - width), frequency_hz * (1.0 + width)],
        damping: [damping; 2],
        tolerance,
    };
    Request {
        sample_hz,
        bands: modes.iter().map(band).collect(),
        command,
        prefer: Prefer::default(),
        most_taps: 256,
        longest_samples: 16_382,
        delay_samples: None,
    }
}

/// Processor time of the thread in nanoseconds; `None` where the system does not tell.
fn processor_ns() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// Measures processor time.
struct ProcessorTime {
    begin: Instant,
    clock: WallTime,
}

impl ProcessorTime {
    fn now(&self) -> u64 {
        processor_ns().unwrap_or_else(|| self.begin.elapsed().as_nanos() as u64)
    }
}

impl Measurement for ProcessorTime {
    type Intermediate = u64;
    type Value = Duration;

    fn start(&self) -> u64 {
        self.now()
    }

    fn end(&self, start: u64) -> Duration {
        Duration::from_nanos(self.now() - start)
    }

    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }

    fn zero(&self) -> Duration {
        Duration::ZERO
    }

    fn to_f64(&self, value: &Duration) -> f64 {
        value.as_nanos() as f64
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        self.clock.formatter()
    }
}

fn benches(c: &mut Criterion<ProcessorTime>) {
    let four = [10.0, 35.0, 68.0, 124.0].map(|omega| (omega / TAU, 0.0));
    let two = [(76.6, 0.057), (231.2, 0.017)];
    let signed = Command::PartialSums { low: -1.0, high: 1.0 };
    let cases = [
        (
            "one mode, insensitivity 0.4",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.2, Command::Positive),
        ),
        (
            "one mode, insensitivity 0.2",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.1, Command::Positive),
        ),
        (
            "one mode, insensitivity 0.73",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.365, Command::Positive),
        ),
        (
            "one mode, insensitivity 0.964",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.482, Command::Positive),
        ),
        ("four modes, exact", request(400.0, &four, 0.05, 0.0, Command::Positive)),
        ("four modes, ±5 %", request(400.0, &four, 0.05, 0.05, Command::Positive)),
        ("four modes, ±10 %", request(400.0, &four, 0.05, 0.1, Command::Positive)),
        ("four modes, ±20 %", request(400.0, &four, 0.05, 0.2, Command::Positive)),
        (
            "two modes, positive",
            request(20_000.0, &two, 0.001, 0.0, Command::Positive),
        ),
        ("two modes, signed, 0.1 %", request(20_000.0, &two, 0.001, 0.0, signed)),
        ("two modes, signed, 5 %", request(20_000.0, &two, 0.05, 0.0, signed)),
    ];
    let mut group = c.benchmark_group("shortest");
    group.sample_size(10);
    for (name, request) in &cases {
        group.bench_function(*name, |bench| bench.iter(|| shortest(black_box(request))));
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default().with_measurement(ProcessorTime { begin: Instant::now(), clock: WallTime });
    targets = benches
}
criterion_main!(all);
