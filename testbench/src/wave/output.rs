//! A VCD that appears under its name only when it is complete.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use vcd::{IdCode, Writer};

use super::SignalKind;
use crate::Error;

pub(super) type Vcd = Writer<BufWriter<NamedTempFile>>;

/// The writer, with the file that it will become.
pub(super) struct Output {
    path: PathBuf,
    vcd: Vcd,
}

impl Output {
    pub(super) fn create(path: &Path) -> Result<Self, Error> {
        let path = &target(path)?;
        let file = temporary(path)?;
        let mut vcd = Writer::new(BufWriter::with_capacity(1 << 16, file));
        vcd.version(concat!("posicast ", env!("CARGO_PKG_VERSION")))
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
        self.vcd.flush().map_err(Error::file(&self.path, "write"))?;
        // The writer does not give its file back: swap in an empty one. It is removed at once.
        let empty = BufWriter::new(temporary(&self.path)?);
        let full = std::mem::replace(self.vcd.writer(), empty);
        let file = full.into_inner().map_err(|cause| cause.into_error());
        put(file.map_err(Error::file(&self.path, "write"))?, &self.path)
    }
}

/// Writes a text file, complete or not at all.
///
/// # Errors
/// [`Error::File`] if it cannot be written, or if something else than a file stands in its place.
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    let path = &target(path)?;
    let mut file = temporary(path)?;
    file.write_all(text.as_bytes()).map_err(Error::file(path, "write"))?;
    put(file, path)
}

/// What is to be replaced: behind a link the file that it names. A device or a pipe is refused: renaming over it would
/// destroy it.
fn target(path: &Path) -> Result<PathBuf, Error> {
    match std::fs::metadata(path) {
        Err(_) => Ok(path.to_owned()),
        Ok(found) if found.is_file() => path.canonicalize().map_err(Error::file(path, "follow")),
        Ok(_) => {
            let problem = std::io::Error::other("it is no regular file; name a new file or one to replace");
            Err(Error::file(path, "replace")(problem))
        }
    }
}

fn temporary(path: &Path) -> Result<NamedTempFile, Error> {
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The default of temporary files, 0600, would stay on the finished file.
        builder.permissions(std::fs::Permissions::from_mode(0o644));
    }
    builder
        .prefix(".posicast-")
        .tempfile_in(folder)
        .map_err(Error::file(path, "create"))
}

fn put(file: NamedTempFile, path: &Path) -> Result<(), Error> {
    let renamed = file.persist(path).map_err(|cause| cause.error);
    renamed.map(drop).map_err(Error::file(path, "write"))
}

/// Writes one change. Reals with an exponent: written out, the large ones are longer than readers take.
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
