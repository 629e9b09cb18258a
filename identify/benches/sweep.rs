//! Time to read a printer's log of 420,000 rows, and to find one mode and four modes in it.

use criterion::{Criterion, criterion_group, criterion_main};
use posicast_identify::log;
use posicast_identify::sweep::{self, Sweep};
use posicast_identify::synthetic::{Sensor, known, resonance_test};
use std::hint::black_box;

fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("identify");
    group.sample_size(10);
    let one = vec![known(44.0, 0.05, 1.0)];
    let four = vec![
        known(23.0, 0.05, 0.4),
        known(41.0, 0.03, 0.3),
        known(68.0, 0.06, 0.2),
        known(101.0, 0.02, 0.1),
    ];
    let sensor = Sensor {
        rest_s: 0.8,
        ..Sensor::default()
    };
    for (name, modes) in [("one mode", one), ("four modes", four)] {
        let log = resonance_test(&modes, &Sweep::default(), &sensor, 1);
        group.bench_function(name, |bencher| {
            bencher.iter(|| black_box(sweep::identify(&log, &Sweep::default())));
        });
        let mut text = Vec::new();
        if log.write_csv(&mut text).is_ok() && name == "one mode" {
            group.bench_function("reading the file", |bencher| {
                bencher.iter(|| black_box(log::read(&text)))
            });
        }
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
