//! The server for Linux, through which a host operates the stage over a network. Its numbers of the link's frames come from the model.

use super::{DriverFile, file};
use posicast_blocks::link::{
    MOST_REPLY_BYTES, MOST_REQUEST_BYTES, MOST_WORDS, POLYNOMIAL, REPLY_HEADER_BYTES, REQUEST_HEADER_BYTES, VERSION,
};

/// Path below the driver's folder, and text into which the numbers are inserted.
const FILES: [(&str, &str); 5] = [
    ("linux/posicast_frames.h", include_str!("c/linux/posicast_frames.h")),
    ("linux/posicast_frames.c", include_str!("c/linux/posicast_frames.c")),
    ("linux/posicast_server.h", include_str!("c/linux/posicast_server.h")),
    ("linux/posicast_server.c", include_str!("c/linux/posicast_server.c")),
    ("linux/posicast_serve.c", include_str!("c/linux/posicast_serve.c")),
];

pub(super) fn files() -> Vec<DriverFile> {
    let numbers = [
        ("@MOST_WORDS@", MOST_WORDS.to_string()),
        ("@MOST_REQUEST_BYTES@", MOST_REQUEST_BYTES.to_string()),
        ("@MOST_REPLY_BYTES@", MOST_REPLY_BYTES.to_string()),
        ("@REQUEST_HEADER_BYTES@", REQUEST_HEADER_BYTES.to_string()),
        ("@REPLY_HEADER_BYTES@", REPLY_HEADER_BYTES.to_string()),
        ("@POLYNOMIAL@", format!("{POLYNOMIAL:#x}")),
        ("@VERSION@", VERSION.to_string()),
    ];
    let fill = |text: &str| (numbers.iter()).fold(text.to_owned(), |text, (name, number)| text.replace(name, number));
    FILES.iter().map(|(path, text)| file(path, fill(text))).collect()
}
