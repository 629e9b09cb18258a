//! The speed of the design, on one core: one mode, four modes, two modes with signed commands.
//!
//! ```text
//! cargo bench -p posicast-optimal
//! ```

use criterion::{Criterion, criterion_group, criterion_main};
use posicast_optimal::{Band, Command, Prefer, Request, shortest};
use std::f64::consts::TAU;
use std::hint::black_box;

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

fn benches(c: &mut Criterion) {
    let four = [10.0, 35.0, 68.0, 124.0].map(|omega| (omega / TAU, 0.0));
    let two = [(76.6, 0.057), (231.2, 0.017)];
    let signed = Command::PartialSums { low: -1.0, high: 1.0 };
    let cases = [
        (
            "one mode, insensitivity 0.4",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.2, Command::Positive),
        ),
        (
            "one mode, insensitivity 0.964",
            request(200.0, &[(1.0, 0.0)], 0.05, 0.482, Command::Positive),
        ),
        ("four modes, ±20 %", request(400.0, &four, 0.05, 0.2, Command::Positive)),
        ("two modes, signed", request(20_000.0, &two, 0.001, 0.0, signed)),
    ];
    let mut group = c.benchmark_group("shortest");
    group.sample_size(10);
    for (name, request) in &cases {
        group.bench_function(*name, |bench| bench.iter(|| shortest(black_box(request))));
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
