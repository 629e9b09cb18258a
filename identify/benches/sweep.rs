//! Time that a printer's log of 419,000 rows takes, of either test of the firmware or of another sweep: to read the file, to find its
//! sweep and modes, and to recommend shapers for them.

use criterion::{Criterion, criterion_group, criterion_main};
use posicast_identify::log;
use posicast_identify::recommend::{Judgement, recommend};
use posicast_identify::sweep::{self, Sweep};
use posicast_identify::synthetic::{Sensor, known, present_test, resonance_test};
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
    let seven = vec![
        known(21.0, 0.05, 0.2),
        known(29.0, 0.05, 0.2),
        known(41.0, 0.03, 0.2),
        known(52.0, 0.03, 0.1),
        known(61.0, 0.03, 0.1),
        known(76.0, 0.06, 0.1),
        known(101.0, 0.02, 0.1),
    ];
    let old = Sweep {
        acceleration_per_hz: 0.075,
        ..Sweep::default()
    };
    let other = Sweep {
        start_hz: 8.0,
        end_hz: 113.0,
        rate_hz_per_s: 0.8,
        ..present_test()
    };
    for (name, modes, driven, rate_hz) in [
        ("old test, one mode", &one, old, 3200.0),
        ("another sweep, four modes", &four, other, 3200.0),
        ("present test, seven modes", &seven, present_test(), 3200.0),
        ("present test, one mode", &one, present_test(), 3200.0),
        ("present test, four modes", &four, present_test(), 3200.0),
        ("present test, four modes, 400 Hz", &four, present_test(), 400.0),
    ] {
        let sensor = Sensor {
            sample_s: 1.0 / rate_hz,
            rest_s: 0.8,
            ..Sensor::default()
        };
        let log = resonance_test(modes, &driven, &sensor, 1);
        group.bench_function(name, |bencher| bencher.iter(|| black_box(sweep::identify_any(&log))));
        if name.ends_with("seven modes")
            && let Ok(found) = sweep::identify_any(&log)
        {
            group.bench_function(format!("shapers for {} modes", found.modes.len()), |bencher| {
                bencher.iter(|| black_box(recommend(&found.modes, &Judgement::default())))
            });
        }
        let mut text = Vec::new();
        if name.starts_with("old") && log.write_csv(&mut text).is_ok() {
            group.bench_function("reading the file", |bencher| {
                bencher.iter(|| black_box(log::read(&text)))
            });
        }
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
