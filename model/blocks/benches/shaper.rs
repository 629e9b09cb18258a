//! Clocks and samples per second of the shaper's models: `cargo bench -p posicast-blocks --bench shaper`.

#![allow(clippy::expect_used, missing_docs, reason = "a benchmark of a fixed machine")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use posicast_blocks::shaper::{Inputs, SampleShaper, Shaper, ShaperConfig};
use posicast_taps::{Tap, TapTable, TapTableError};
use std::hint::black_box;

/// Returns a machine with six taps: ZVD digitised with two taps per impulse. A sample takes 5000 clocks, as at 10 kHz
/// from 50 MHz.
fn machine() -> Result<ShaperConfig, TapTableError> {
    let taps = [(0, 25431), (38, 12000), (39, 18787), (77, 4000), (78, 5317), (79, 1)];
    let tap = |(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    };
    let table = TapTable::new(16, taps.map(tap).to_vec())?;
    Ok(ShaperConfig::new(32, table).expect("these sizes are listed"))
}

fn models(criterion: &mut Criterion) {
    let config = machine().expect("the coefficients sum to one");
    let mut group = criterion.benchmark_group("shaper");
    for clocks_per_sample in [5000, 64] {
        let mut shaper = Shaper::new(&config, 1);
        group.throughput(Throughput::Elements(clocks_per_sample));
        group.bench_function(format!("clocks, a strobe every {clocks_per_sample}"), |bencher| {
            let mut x = 0;
            bencher.iter(|| {
                x += 12345;
                shaper.step(&Inputs {
                    strobe: true,
                    x,
                    ..Inputs::default()
                });
                (1..clocks_per_sample).for_each(|_| {
                    black_box(shaper.step(black_box(&Inputs::default())));
                });
            });
        });
    }
    let mut fast = SampleShaper::new(&config);
    group.throughput(Throughput::Elements(1));
    group.bench_function("samples, 6 taps", |bencher| {
        let mut x = 0;
        bencher.iter(|| {
            x += 12345;
            fast.push(black_box(x))
        });
    });
    group.finish();
}

criterion_group!(benches, models);
criterion_main!(benches);
