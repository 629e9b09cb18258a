//! Time to design a shaper for several modes: `cargo bench -p posicast-shaper --bench design_joint`.

#![allow(missing_docs, reason = "a benchmark")]

use criterion::{Criterion, criterion_group, criterion_main};
use posicast_shaper::design::antisymmetric::{self, AntisymmetricMethod, Participant};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::periodic::{self, Base};
use posicast_shaper::design::simultaneous::{self, Amplitudes, Constraint};
use posicast_shaper::design::vibrationless;
use posicast_shaper::mode::Mode;
use std::hint::black_box;

fn mode(frequency_hz: f64, damping: f64) -> Mode {
    Mode { frequency_hz, damping }
}

fn designs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("design of several modes");
    let four = [10.0, 35.0, 68.0, 124.0].map(|frequency_hz| (mode(frequency_hz, 0.0), 0.05));
    let base = Base {
        kind: ShaperKind::MultiEi,
        order: 2,
        tolerance: 0.05,
    };
    group.bench_function("periodic, four modes down to a tenth of the lowest", |bencher| {
        bencher.iter(|| periodic::design(black_box(&four), base, 1.0));
    });
    let robot = [mode(76.6, 0.057), mode(231.2, 0.017)];
    for constraint in [Constraint::Zv, Constraint::Zvd] {
        let modes = robot.map(|mode| (mode, constraint));
        group.bench_function(format!("simultaneous, two modes, {constraint:?}"), |bencher| {
            bencher.iter(|| simultaneous::design(black_box(&modes), Amplitudes::PartialSum));
        });
    }
    for order in 1..=vibrationless::ORDER_MAX {
        group.bench_function(format!("vibrationless, order {order}"), |bencher| {
            bencher.iter(|| vibrationless::design(black_box(&robot[0]), order, 0.05));
        });
    }
    let participants = [2.0, 14.0].map(|frequency_hz| Participant {
        mode: mode(frequency_hz, 0.01),
        participation: 1.0,
    });
    for method in [AntisymmetricMethod::Exact, AntisymmetricMethod::ThreeImpulse] {
        group.bench_function(format!("antisymmetric, {method:?}"), |bencher| {
            bencher.iter(|| antisymmetric::design(black_box(&participants), method, 0.0));
        });
    }
    group.finish();
}

criterion_group!(benches, designs);
criterion_main!(benches);
