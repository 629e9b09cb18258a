//! Writes large files like those of simulators: a clock, counters, accumulators, flags; 13 changes per clock.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Number of signals other than the clock, and in a large design.
const SIGNALS: usize = 100;
const MANY_SIGNALS: usize = 50_000;
const CHANGES_PER_CLOCK: usize = 13;

/// Kind of the signals that change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Words of 16 to 48 bits, some flags: 26 bytes per change.
    Words,
    /// Flags, some words of 8 bits: 5 bytes per change.
    Flags,
    /// Words as above, in half of the values of which some digits are `x`.
    Unknown,
    /// 50,000 signals: flags, and a tenth words of 32 bits.
    Many,
}

/// How the second file differs from the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Second {
    /// It has other id codes, and another order at each time.
    OtherNames,
    /// It is equal.
    SameBytes,
    /// It is equal, and both are FST.
    Fst,
    /// The same, in blocks of another size, so that no packed bytes are equal.
    FstOtherBlocks,
}

impl Shape {
    fn signals(self) -> usize {
        match self {
            Self::Many => MANY_SIGNALS,
            _ => SIGNALS,
        }
    }

    fn width(self, at: usize) -> u32 {
        match (self, at) {
            (Self::Words | Self::Unknown, 0..30) => 32,
            (Self::Words | Self::Unknown, 30..50) => 48,
            (Self::Words | Self::Unknown, 50..70) => 16,
            (Self::Flags, 0..15) => 8,
            (Self::Many, at) if at % 10 == 0 => 32,
            _ => 1,
        }
    }
}

/// A new value: bits, and a mask of those that are `x`.
#[derive(Debug, Clone, Copy)]
struct Next {
    signal: usize,
    value: u64,
    unknown: u64,
}

/// Makes the values, clock by clock.
struct Process {
    shape: Shape,
    widths: Vec<u32>,
    values: Vec<u64>,
    random: u64,
    clocks: usize,
}

impl Process {
    fn new(shape: Shape) -> Self {
        Self {
            shape,
            widths: (0..shape.signals()).map(|at| shape.width(at)).collect(),
            values: vec![0; shape.signals()],
            random: 0x9e37_79b9_7f4a_7c15,
            clocks: 0,
        }
    }

    /// Returns the signals that change in the next clock, and their values.
    fn clock(&mut self) -> [Next; CHANGES_PER_CLOCK] {
        let start = self.clocks * 7;
        self.clocks += 1;
        std::array::from_fn(|at| {
            let signal = (start + at * 9) % self.widths.len();
            self.random ^= self.random << 13;
            self.random ^= self.random >> 7;
            self.random ^= self.random << 17;
            let mask = u64::MAX >> (64 - self.widths[signal]);
            let before = self.values[signal];
            let next = before.wrapping_add(self.random >> 44 | 1) & mask;
            self.values[signal] = if mask == 1 { before ^ 1 } else { next };
            let unknown = match self.shape {
                // The upper digits, or some in the middle.
                Shape::Unknown if mask > 1 && self.random & 1 == 1 => {
                    (self.random >> 20 & self.random >> 40) & mask & !1
                }
                _ => 0,
            };
            Next {
                signal,
                value: self.values[signal],
                unknown,
            }
        })
    }
}

/// One of two files.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recording {
    pub(crate) shape: Shape,
    /// Whether id codes and the order at each time are reversed.
    pub(crate) reversed: bool,
    /// Whether one bit near the end is inverted.
    pub(crate) flip: bool,
    /// Bytes of changes in a block of an FST.
    pub(crate) fst_block: usize,
}

impl Recording {
    /// Writes a VCD of at least `bytes`. Returns a description of the file.
    pub(crate) fn write(self, path: &Path, bytes: u64) -> io::Result<String> {
        let mut out = Counting {
            inner: BufWriter::with_capacity(1 << 20, File::create(path)?),
            bytes: 0,
        };
        let mut process = Process::new(self.shape);
        let mut ids: Vec<String> = (0..=process.widths.len() as u64)
            .map(|number| vcd::IdCode::from(number).to_string())
            .collect();
        if self.reversed {
            ids.reverse();
        }
        write!(
            out,
            "$timescale 1ps $end\n $scope module TOP $end\n  $var wire 1 {} clk $end\n",
            ids[0]
        )?;
        for (at, width) in process.widths.iter().enumerate() {
            let range = if *width > 1 {
                format!(" [{}:0]", width - 1)
            } else {
                String::new()
            };
            writeln!(out, "  $var wire {width} {} s{at}{range} $end", ids[at + 1])?;
        }
        writeln!(out, " $upscope $end\n$enddefinitions $end\n#0\n0{}", ids[0])?;
        let mut flipped = !self.flip;
        let mut text = Vec::new();
        let mut lines: Vec<Vec<u8>> = Vec::new();
        while out.bytes < bytes {
            lines.clear();
            lines.push(format!("1{}\n", ids[0]).into_bytes());
            let clock = process.clocks;
            for next in process.clock() {
                let flip = !flipped && out.bytes > bytes - bytes / 50;
                flipped |= flip;
                let mut line = Vec::new();
                put(
                    &mut line,
                    next,
                    flip,
                    process.widths[next.signal],
                    &ids[next.signal + 1],
                );
                lines.push(line);
            }
            if self.reversed {
                lines.reverse();
            }
            text.clear();
            writeln!(text, "#{}", clock * 10_000 + 5_000)?;
            lines.iter().for_each(|line| text.extend_from_slice(line));
            writeln!(text, "#{}\n0{}", clock * 10_000 + 10_000, ids[0])?;
            out.write_all(&text)?;
        }
        out.inner.flush()?;
        Ok(summary(out.bytes, &process))
    }

    /// Writes `clocks` clocks of the same as an FST.
    pub(crate) fn write_fst(self, path: &Path, clocks: usize) -> io::Result<String> {
        use fst_writer::{FstFileType, FstInfo, FstScopeType, FstSignalType, FstVarDirection, FstVarType, open_fst};

        let failed = |cause| io::Error::other(format!("{cause:?}"));
        let info = FstInfo {
            start_time: 0,
            timescale_exponent: -12,
            version: "wavecmp bench".to_owned(),
            date: String::new(),
            file_type: FstFileType::Verilog,
        };
        let mut process = Process::new(self.shape);
        let mut head = open_fst(path, &info).map_err(failed)?;
        head.scope("TOP", "", FstScopeType::Module).map_err(failed)?;
        let mut var = |name: &str, width: u32| {
            let kind = FstSignalType::bit_vec(width);
            head.var(name, kind, FstVarType::Wire, FstVarDirection::Implicit, None)
                .map_err(failed)
        };
        let clk = var("clk", 1)?;
        let ids = process.widths.iter().enumerate();
        let ids = ids
            .map(|(at, width)| var(&format!("s{at}"), *width))
            .collect::<io::Result<Vec<_>>>()?;
        head.up_scope().map_err(failed)?;
        let mut body = head.finish().map_err(failed)?;
        body.time_change(0).map_err(failed)?;
        body.signal_change(clk, b"0").map_err(failed)?;
        for clock in 0..clocks {
            if body.size() >= self.fst_block {
                body.flush().map_err(failed)?;
            }
            body.time_change(clock as u64 * 10_000 + 5_000).map_err(failed)?;
            body.signal_change(clk, b"1").map_err(failed)?;
            for (at, next) in process.clock().into_iter().enumerate() {
                let flip = self.flip && at == 0 && clock == clocks - clocks / 50;
                let mut digits = Vec::new();
                put_digits(&mut digits, next, flip, process.widths[next.signal]);
                body.signal_change(ids[next.signal], &digits).map_err(failed)?;
            }
            body.time_change(clock as u64 * 10_000 + 10_000).map_err(failed)?;
            body.signal_change(clk, b"0").map_err(failed)?;
        }
        body.finish().map_err(failed)?;
        Ok(summary(path.metadata()?.len(), &process))
    }
}

fn summary(bytes: u64, process: &Process) -> String {
    format!(
        "{:.0} MB, {} signals, {:.1} M changes at {:.1} M times",
        bytes as f64 / 1e6,
        process.widths.len() + 1,
        (process.clocks * (CHANGES_PER_CLOCK + 2)) as f64 / 1e6,
        2.0 * process.clocks as f64 / 1e6
    )
}

fn put_digits(line: &mut Vec<u8>, next: Next, flip: bool, width: u32) {
    let value = next.value ^ u64::from(flip);
    line.extend((0..width).rev().map(|bit| match next.unknown >> bit & 1 {
        1 => b'x',
        _ => b'0' + (value >> bit & 1) as u8,
    }));
}

fn put(line: &mut Vec<u8>, next: Next, flip: bool, width: u32, id: &str) {
    if width > 1 {
        line.push(b'b');
    }
    put_digits(line, next, flip, width);
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
