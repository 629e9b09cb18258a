//! What several tests use.

use std::io::Write;
use std::path::Path;

use wavecmp::WaveError;
use wavecmp::files::{OutputSink, WriteContent};

/// Files that are just written.
pub(crate) struct PlainFiles;

impl OutputSink for PlainFiles {
    fn mark(&self) -> String {
        "written by a test".to_owned()
    }

    fn write(&self, path: &Path, fill: &mut WriteContent<'_>) -> Result<(), WaveError> {
        let mut content = Vec::new();
        fill(&mut content)?;
        std::fs::write(path, content).map_err(WaveError::file(path, "write"))
    }
}

/// A recording of 25 MHz: `clk` and the signals `sW` of the widths W in `top.dut`. Row k stands before rising edge k.
pub(crate) fn record(path: &Path, clock: &str, widths: &[u32], rows: &[Vec<u64>]) {
    let mut out = Vec::new();
    let mut put = |text: String| out.write_all(text.as_bytes()).unwrap();
    put("$timescale 1ns $end\n$scope module top $end\n$scope module dut $end\n".to_owned());
    put(format!("$var wire 1 ! {clock} $end\n"));
    for (at, width) in widths.iter().enumerate() {
        put(format!("$var wire {width} s{at} s{width} $end\n"));
    }
    put("$upscope $end\n$upscope $end\n$enddefinitions $end\n".to_owned());
    let mut last = vec![None; widths.len()];
    for (clock, row) in rows.iter().enumerate() {
        put(format!("#{}\n1!\n", 40 * clock));
        for (at, value) in row.iter().enumerate() {
            if last[at].replace(*value) != Some(*value) {
                let digits = format!("{value:0width$b}", width = widths[at] as usize);
                put(if widths[at] == 1 {
                    format!("{digits}s{at}\n")
                } else {
                    format!("b{digits} s{at}\n")
                });
            }
        }
        put(format!("#{}\n0!\n", 40 * clock + 20));
    }
    put(format!("#{}\n1!\n", 40 * rows.len()));
    std::fs::write(path, out).unwrap();
}
