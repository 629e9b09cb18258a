//! Writes a VCD that appears under its name only when it is complete.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use posicast_system::output::{self, Draft, seal};
use vcd::{IdCode, Writer};
use wavecmp::WaveError;
use wavecmp::files::{OutputSink, WriteContent};
use wavecmp::merge::{DifferenceSignal, MergePart};

use crate::Error;

/// The type of a signal's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalKind {
    /// A vector of this many bits, 1..=64.
    Bits(u32),
    /// A real number; its value is passed as [`f64::to_bits`].
    Real,
}

pub(super) type Vcd = Writer<BufWriter<Draft>>;

/// The writer and the file that it writes.
pub(super) struct Output {
    path: PathBuf,
    vcd: Vcd,
}

impl Output {
    pub(super) fn create(path: &Path) -> Result<Self, Error> {
        let draft = Draft::new(path).map_err(Error::file(path, "create"))?;
        let mut vcd = Writer::new(BufWriter::with_capacity(1 << 16, draft));
        vcd.version(concat!("posicast ", env!("CARGO_PKG_VERSION")))
            .and_then(|()| vcd.comment(&seal::blank()))
            .map_err(Error::file(path, "write"))?;
        Ok(Self {
            path: path.to_owned(),
            vcd,
        })
    }

    pub(super) fn write<T>(&mut self, action: impl FnOnce(&mut Vcd) -> io::Result<T>) -> Result<T, Error> {
        action(&mut self.vcd).map_err(Error::file(&self.path, "write"))
    }

    pub(super) fn finish(mut self) -> Result<(), Error> {
        let written = self.vcd.flush().and_then(|()| self.vcd.writer().get_mut().put());
        written.map_err(Error::file(&self.path, "write"))
    }
}

/// Writes a text file with posicast's seal, complete or not at all ([`output::write_text`]).
///
/// # Errors
/// [`Error::File`] if it cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    output::write_text(path, text).map_err(Error::file(path, "write"))
}

/// Writes files with posicast's seal, complete or not at all.
#[derive(Debug, Clone, Copy, Default)]
pub struct SealedFiles;

impl OutputSink for SealedFiles {
    fn mark(&self) -> String {
        seal::blank()
    }

    fn write(&self, path: &Path, fill: &mut WriteContent<'_>) -> Result<(), WaveError> {
        let mut draft = Draft::new(path).map_err(WaveError::file(path, "create"))?;
        fill(&mut draft)?;
        draft.put().map_err(WaveError::file(path, "write"))
    }
}

/// Merges several waveforms side by side into `path`, with posicast's seal ([`wavecmp::merge::merge`]).
///
/// # Errors
/// [`Error::Wave`] for a part that cannot be read, a difference that names no signal, or a file that cannot be written.
pub fn merge(path: &Path, parts: &[MergePart<'_>], differences: &[DifferenceSignal<'_>]) -> Result<(), Error> {
    Ok(wavecmp::merge::merge(&SealedFiles, path, parts, differences)?)
}

/// Writes one change. Reals are written with an exponent, because large ones written out are longer than readers
/// accept.
pub(super) fn change(vcd: &mut Vcd, id: IdCode, kind: SignalKind, value: u64) -> io::Result<()> {
    match kind {
        SignalKind::Bits(1) => vcd.change_scalar(id, value & 1 == 1),
        SignalKind::Bits(width) => {
            let mut digits = [b'0'; 64];
            for (at, digit) in digits.iter_mut().enumerate() {
                *digit += (value >> (63 - at) & 1) as u8;
            }
            let out = vcd.writer();
            out.write_all(b"b")?;
            out.write_all(&digits[64 - width.clamp(1, 64) as usize..])?;
            writeln!(out, " {id}")
        }
        SignalKind::Real => real(vcd, id, f64::from_bits(value)),
    }
}

pub(super) fn real(vcd: &mut Vcd, id: IdCode, value: f64) -> io::Result<()> {
    writeln!(vcd.writer(), "r{value:e} {id}")
}
