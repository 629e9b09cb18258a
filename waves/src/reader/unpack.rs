//! Recognises packed files by their first bytes, and unpacks them.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use lzma_rust2::XzReader;
use ruzstd::decoding::StreamingDecoder;

use crate::WaveError;

const GZIP: &[u8] = &[0x1f, 0x8b];
const XZ: &[u8] = &[0xfd, b'7', b'z', b'X', b'Z', 0];
const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// Largest distance in bytes over which a packed file may refer back to its own output: `xz -9` needs 64 MiB, `zstd
/// --ultra -22` 128 MiB.
const WINDOW_KIB: u32 = 1 << 17;
/// Number of bytes by which the kinds of files are recognised.
const HEAD: u64 = 16;
/// The name of the standard input.
const DASH: &str = "-";

/// An open file, unpacked if it is packed.
pub(super) struct Source {
    pub(super) input: Box<dyn Read + Send>,
    /// The file itself, if it is a plain one that can be read at any place.
    pub(super) file: Option<File>,
    /// Its length, if that is the number of bytes that will be read.
    pub(super) bytes: Option<u64>,
}

/// Opens a file; `-` is the standard input.
pub(super) fn open(path: &Path) -> Result<Source, WaveError> {
    let read = || WaveError::file(path, "read");
    let (mut input, file, length): (Box<dyn Read + Send>, _, _) = if path == Path::new(DASH) {
        (Box::new(io::stdin()), None, None)
    } else {
        let file = File::open(path).map_err(WaveError::file(path, "open"))?;
        let data = file.metadata().map_err(read())?;
        if data.is_dir() {
            let folder = io::Error::from(io::ErrorKind::IsADirectory);
            return Err(read()(folder));
        }
        let again = if data.is_file() { file.try_clone().ok() } else { None };
        (Box::new(file), again, data.is_file().then_some(data.len()))
    };
    let mut head = Vec::new();
    input.by_ref().take(HEAD).read_to_end(&mut head).map_err(read())?;
    let kind = [GZIP, XZ, ZSTD].iter().position(|magic| head.starts_with(magic));
    let whole = BufReader::with_capacity(1 << 16, Cursor::new(head).chain(input));
    let (input, is_packed): (Box<dyn Read + Send>, bool) = match kind {
        Some(0) => (Box::new(UntilError::new(MultiGzDecoder::new(whole))), true),
        Some(1) => {
            let xz = XzReader::new_mem_limit(whole, true, WINDOW_KIB);
            (Box::new(UntilError::new(xz)), true)
        }
        Some(_) => (Box::new(UntilError::new(Frames(Frame::Between(Some(whole))))), true),
        None => (Box::new(whole.into_inner()), false),
    };
    Ok(Source {
        input,
        file: file.filter(|_| !is_packed),
        bytes: length.filter(|_| !is_packed),
    })
}

/// A reader that is not asked again after an error: the crate for xz would then search for its next byte for ever.
struct UntilError<R> {
    input: R,
    failed: Option<io::ErrorKind>,
}

impl<R: Read> UntilError<R> {
    fn new(input: R) -> Self {
        Self { input, failed: None }
    }
}

impl<R: Read> Read for UntilError<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(kind) = self.failed {
            return Err(kind.into());
        }
        let read = self.input.read(buffer);
        if let Err(cause) = &read
            && cause.kind() != io::ErrorKind::Interrupted
        {
            self.failed = Some(cause.kind());
        }
        read
    }
}

/// The frames of a zstd file, one after the other.
struct Frames<R: Read>(Frame<R>);

enum Frame<R: Read> {
    Between(Option<R>),
    Within(Box<StreamingDecoder<R, ruzstd::decoding::FrameDecoder>>),
}

impl<R: io::BufRead> Read for Frames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match &mut self.0 {
                Frame::Within(decoder) => {
                    let count = decoder.read(buffer)?;
                    if count > 0 || buffer.is_empty() {
                        return Ok(count);
                    }
                    let Frame::Within(decoder) = std::mem::replace(&mut self.0, Frame::Between(None)) else {
                        return Ok(0);
                    };
                    self.0 = Frame::Between(Some(decoder.into_inner()));
                }
                Frame::Between(input) => {
                    let Some(mut input) = input.take() else { return Ok(0) };
                    if input.fill_buf()?.is_empty() {
                        return Ok(0);
                    }
                    let decoder = StreamingDecoder::new_with_max_window_size(input, u64::from(WINDOW_KIB) << 10)
                        .map_err(io::Error::other)?;
                    self.0 = Frame::Within(Box::new(decoder));
                }
            }
        }
    }
}
