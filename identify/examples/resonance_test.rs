//! Writes a simulated accelerometer log of a resonance test on a machine with two known modes:
//! `cargo run -p posicast-identify --example resonance_test > log.csv`, then `posicast identify log.csv`.

use posicast_identify::sweep::Sweep;
use posicast_identify::synthetic::{Sensor, known, resonance_test};
use std::io::{BufWriter, stdout};

fn main() -> std::io::Result<()> {
    let modes = [known(44.3, 0.053, 0.8), known(71.0, 0.04, 0.2)];
    let log = resonance_test(&modes, &Sweep::default(), &Sensor::default(), 1);
    log.write_csv(&mut BufWriter::new(stdout().lock()))
}
