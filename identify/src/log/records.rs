//! Records of a text of separated values, each with its line.

use csv::{ByteRecord, ReaderBuilder, Trim};

/// The records of a text, one after the other; what it has may be quoted.
pub(super) struct Records<'a> {
    text: &'a [u8],
    separator: u8,
    reader: csv::Reader<&'a [u8]>,
    /// Byte of the text at which the reader began.
    reader_begin: usize,
    record: ByteRecord,
    /// Byte at which the record begins, and its line.
    begin: usize,
    line: u64,
}

impl<'a> Records<'a> {
    pub(super) fn new(text: &'a [u8], separator: u8) -> Self {
        Self {
            text,
            separator,
            reader: reader(text, separator),
            reader_begin: 0,
            record: ByteRecord::new(),
            begin: 0,
            line: 1,
        }
    }

    /// Goes to the next record, if there is one.
    pub(super) fn next(&mut self) -> bool {
        // The reader accepts any number of fields and any bytes, so it cannot fail on a text in memory.
        if !self.reader.read_byte_record(&mut self.record).unwrap_or(false) {
            return false;
        }
        let byte = self.record.position().map_or(0, csv::Position::byte) as usize + self.reader_begin;
        // The reader counts the end of the line before and empty lines to the record.
        let blank = self.text[byte..]
            .iter()
            .take_while(|byte| matches!(byte, b'\r' | b'\n'));
        let begin = byte + blank.count();
        self.line += memchr::memchr_iter(b'\n', &self.text[self.begin..begin]).count() as u64;
        self.begin = begin;
        true
    }

    /// The present record.
    pub(super) fn record(&self) -> &ByteRecord {
        &self.record
    }

    /// Its line, counted from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// The text from the present record on, and its line.
    pub(super) fn rest(&self) -> (&'a [u8], u64) {
        (&self.text[self.begin..], self.line)
    }

    /// Skips this many bytes from the current record on, which are this many lines.
    pub(super) fn skip_lines(&mut self, bytes: usize, lines: usize) {
        self.begin += bytes;
        self.line += lines as u64;
        self.reader = reader(&self.text[self.begin..], self.separator);
        self.reader_begin = self.begin;
    }
}

fn reader(text: &[u8], separator: u8) -> csv::Reader<&[u8]> {
    ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(Trim::All)
        .from_reader(text)
}
