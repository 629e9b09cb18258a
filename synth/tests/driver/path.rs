//! The path between LinuxCNC's servo periods and those of a stage whose clock differs.

use crate::driver::bridge;
use crate::driver::support::{Driver, beside};
use std::path::{Path, PathBuf};

fn hal(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/hal/c").join(name)
}

#[test]
fn a_path_keeps_its_points_while_the_clocks_differ() {
    let driver = Driver::write();
    let folder = hal("");
    let options = ["-I", folder.to_str().unwrap(), "-Wl,--no-as-needed", "-lm"];
    let program = driver.program("path", &options, &[beside("path.c"), hal("posicast_path.c")]);
    for ppm in ["0", "100", "-100", "1500", "-1500"] {
        let said = bridge::talk(&program, &[ppm, "60000"], &mut |_| None);
        // Thousandths of a count: the points are rounded to 1/256 of one.
        assert!(said["position"] <= 3 && said["velocity"] <= 2, "{ppm} ppm: {said:?}");
        // The level varies by one point of 10 ticks, and does not run away.
        assert!(said["low"] >= -10 && said["high"] <= 10, "{ppm} ppm: {said:?}");
    }
}
