//! Writes a simulated accelerometer log of a resonance test on a machine with two known modes:
//! `cargo run -p posicast-identify --example resonance_test > log.csv`, then `posicast identify log.csv`.
//!
//! With the argument `small` it writes `examples/printer-x.csv`: a shorter sweep, with a sensor that is read 400 times per second.

use posicast_identify::sweep::Sweep;
use posicast_identify::synthetic::{Sensor, known, resonance_test};
use std::io::{BufWriter, stdout};

fn main() -> std::io::Result<()> {
    let (mut sweep, mut sensor) = (Sweep::default(), Sensor::default());
    if std::env::args().nth(1).as_deref() == Some("small") {
        (sweep.start_hz, sweep.end_hz, sweep.rate_hz_per_s) = (30.0, 85.0, 2.0);
        sensor.sample_s = 1.0 / 400.0;
    }
    let modes = [known(44.3, 0.053, 0.8), known(71.0, 0.04, 0.2)];
    let log = resonance_test(&modes, &sweep, &sensor, 1);
    log.write_csv(&mut BufWriter::new(stdout().lock()))
}
