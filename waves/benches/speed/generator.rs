//! Writes large files like those of Verilator: a clock, counters, accumulators, flags; about seven changes at a time
//! and 26 bytes per change.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Widths of the signals other than the clock.
const WIDTHS: [u32; 100] = {
    let mut widths = [1; 100];
    let mut at = 0;
    while at < 70 {
        widths[at] = if at < 30 {
            32
        } else if at < 50 {
            48
        } else {
            16
        };
        at += 1;
    }
    widths
};
const CHANGES_PER_CLOCK: u64 = 13;

/// Writes at least `bytes` bytes; with `flip`, one bit differs near the end. Returns a description of the file.
pub(crate) fn write(path: &Path, bytes: u64, flip: bool) -> io::Result<String> {
    let mut out = Counting {
        inner: BufWriter::with_capacity(1 << 20, File::create(path)?),
        bytes: 0,
    };
    let ids: Vec<String> = (0..=WIDTHS.len() as u64)
        .map(|number| vcd::IdCode::from(number).to_string())
        .collect();
    write!(
        out,
        "$timescale 1ps $end\n $scope module TOP $end\n  $var wire 1 {} clk $end\n",
        ids[0]
    )?;
    for (at, width) in WIDTHS.iter().enumerate() {
        let range = if *width > 1 {
            format!(" [{}:0]", width - 1)
        } else {
            String::new()
        };
        writeln!(out, "  $var wire {width} {} s{at}{range} $end", ids[at + 1])?;
    }
    out.write_all(b" $upscope $end\n$enddefinitions $end\n#0\n0!\n")?;
    let mut values = [0u64; WIDTHS.len()];
    let mut random = 0x9e37_79b9_7f4a_7c15u64;
    let (mut clocks, mut changes, mut flipped) = (0u64, 0u64, !flip);
    let mut line = Vec::new();
    while out.bytes < bytes {
        line.clear();
        writeln!(line, "#{}\n1!", clocks * 10_000 + 5_000)?;
        let start = (clocks * 7) as usize;
        for at in 0..CHANGES_PER_CLOCK as usize {
            let signal = (start + at * 9) % WIDTHS.len();
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let width = WIDTHS[signal];
            let mask = u64::MAX >> (64 - width);
            let before = values[signal];
            values[signal] = match width {
                1 => before ^ 1,
                _ => before.wrapping_add(random >> 44 | 1) & mask,
            };
            let mut shown = values[signal];
            if !flipped && out.bytes > bytes - bytes / 50 {
                flipped = true;
                shown ^= 1;
            }
            put(&mut line, shown, width, &ids[signal + 1]);
        }
        writeln!(line, "#{}\n0!", clocks * 10_000 + 10_000)?;
        out.write_all(&line)?;
        changes += CHANGES_PER_CLOCK + 2;
        clocks += 1;
    }
    out.inner.flush()?;
    Ok(format!(
        "{:.0} MB, {} signals, {:.1} M changes at {:.1} M times",
        out.bytes as f64 / 1e6,
        WIDTHS.len() + 1,
        changes as f64 / 1e6,
        2.0 * clocks as f64 / 1e6
    ))
}

fn put(line: &mut Vec<u8>, value: u64, width: u32, id: &str) {
    if width > 1 {
        line.push(b'b');
    }
    line.extend((0..width).rev().map(|bit| b'0' + (value >> bit & 1) as u8));
    if width > 1 {
        line.push(b' ');
    }
    line.extend_from_slice(id.as_bytes());
    line.push(b'\n');
}

struct Counting {
    inner: BufWriter<File>,
    bytes: u64,
}

impl Write for Counting {
    fn write(&mut self, data: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(data)?;
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
