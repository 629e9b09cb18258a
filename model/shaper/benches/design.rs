//! Time to design shapers: one of each family; all single-mode kinds over a thousand random modes and tolerances; and
//! a refusal beyond a family's limits: `cargo bench -p posicast-shaper --bench design`.

#![allow(missing_docs, reason = "a benchmark")]

use criterion::{Criterion, criterion_group, criterion_main};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, bias_point, hump_ei, negative, zv};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use std::hint::black_box;

const KINDS: [ShaperKind; 19] = [
    ShaperKind::Zv,
    ShaperKind::Zvd,
    ShaperKind::Zvdd,
    ShaperKind::Zvddd,
    ShaperKind::Mzv,
    ShaperKind::Ei,
    ShaperKind::TwoHumpEi,
    ShaperKind::ThreeHumpEi,
    ShaperKind::UmZv,
    ShaperKind::UmZvd,
    ShaperKind::UmEi,
    ShaperKind::PsZv,
    ShaperKind::PsZvd,
    ShaperKind::PsEi,
    ShaperKind::ZvEi,
    ShaperKind::ZvEi2,
    ShaperKind::ZvdEi,
    ShaperKind::MultiEi,
    ShaperKind::ChebyshevEi,
];

fn design(kind: ShaperKind, mode: &Mode, tolerance: f64) -> Result<ImpulseSequence, DesignError> {
    match kind {
        ShaperKind::Zv => zv::design(kind, mode, 1),
        ShaperKind::Zvd => zv::design(kind, mode, 2),
        ShaperKind::Zvdd => zv::design(kind, mode, 3),
        ShaperKind::Zvddd => zv::design(kind, mode, 4),
        ShaperKind::Mzv => zv::design_mzv(mode),
        ShaperKind::Ei | ShaperKind::TwoHumpEi | ShaperKind::ThreeHumpEi => {
            hump_ei::design(kind, mode, tolerance).map(|found| found.impulses)
        }
        ShaperKind::UmZv
        | ShaperKind::UmZvd
        | ShaperKind::UmEi
        | ShaperKind::PsZv
        | ShaperKind::PsZvd
        | ShaperKind::PsEi => negative::design(kind, mode, tolerance),
        _ => bias_point::design(kind, 3, mode, tolerance),
    }
}

/// Returns a thousand pairs (damping, tolerance) for which all kinds exist, from a generator without a seed.
fn random_points() -> Vec<(f64, f64)> {
    let mut state = 0x9E37_79B9_7F4A_7C15u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut points = Vec::new();
    while points.len() < 1000 {
        let (damping, tolerance) = (0.3 * uniform(), 0.01 + 0.29 * uniform());
        let mode = Mode {
            frequency_hz: 1.0,
            damping,
        };
        let exist = |kind: ShaperKind| design(kind, &mode, tolerance).is_ok();
        if [ShaperKind::ThreeHumpEi, ShaperKind::ZvdEi, ShaperKind::ChebyshevEi]
            .into_iter()
            .all(exist)
        {
            points.push((damping, tolerance));
        }
    }
    points
}

fn families(criterion: &mut Criterion) {
    let mode = Mode {
        frequency_hz: 131.1,
        damping: 0.15,
    };
    let mut group = criterion.benchmark_group("design");
    for kind in KINDS {
        group.bench_function(kind.name(), |bencher| {
            bencher.iter(|| black_box(design(kind, black_box(&mode), 0.05)));
        });
    }
    let beyond = Mode { damping: 0.5, ..mode };
    group.bench_function("three-hump-ei, beyond its limits", |bencher| {
        bencher.iter(|| black_box(design(ShaperKind::ThreeHumpEi, black_box(&beyond), 0.05)));
    });
    group.finish();
}

fn sweep(criterion: &mut Criterion) {
    let points = random_points();
    let mut group = criterion.benchmark_group("sweep");
    group.sample_size(10);
    group.bench_function(
        "all single-mode kinds, 1000 random dampings and tolerances",
        |bencher| {
            bencher.iter(|| {
                for &(damping, tolerance) in &points {
                    let mode = Mode {
                        frequency_hz: 1.0,
                        damping,
                    };
                    for kind in KINDS {
                        black_box(design(kind, black_box(&mode), tolerance).is_ok());
                    }
                }
            });
        },
    );
    group.finish();
}

criterion_group!(benches, families, sweep);
criterion_main!(benches);
