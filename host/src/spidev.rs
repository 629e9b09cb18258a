//! A controller of Linux, `/dev/spidevB.C`.

use std::io;

use spidev::{SpiModeFlags, Spidev, SpidevOptions, SpidevTransfer};

use crate::spi::SpiTransfer;
use crate::{LinkError, SpiLine};

/// Bits of a byte.
const BYTE_BITS: u8 = 8;

/// A controller of Linux.
#[derive(Debug)]
pub struct LinuxSpi(Spidev);

impl SpiLine<LinuxSpi> {
    /// Opens a device such as `/dev/spidev0.0` with a clock in Hz: mode 0, most significant bit first.
    ///
    /// # Errors
    /// [`LinkError::Spi`] if the operating system refuses it.
    pub fn open(device: &str, sck_hz: u32) -> Result<Self, LinkError> {
        let options = SpidevOptions::new()
            .bits_per_word(BYTE_BITS)
            .max_speed_hz(sck_hz)
            .lsb_first(false)
            .mode(SpiModeFlags::SPI_MODE_0)
            .build();
        let opened = Spidev::open(device).and_then(|mut opened| {
            opened.configure(&options)?;
            Ok(opened)
        });
        match opened {
            Ok(opened) => Ok(Self::new(LinuxSpi(opened))),
            Err(error) => Err(LinkError::Spi {
                device: device.to_owned(),
                reason: error.to_string(),
                remedy: remedy(error.kind()),
            }),
        }
    }
}

/// What to check if a device cannot be opened.
fn remedy(kind: io::ErrorKind) -> &'static str {
    match kind {
        io::ErrorKind::NotFound => {
            "is SPI switched on (on a Raspberry Pi `dtparam=spi=on` in config.txt)? `ls /dev/spidev*` shows the devices"
        }
        io::ErrorKind::PermissionDenied => "may you use it? On most systems it belongs to the group `spi`",
        _ => "is it an SPI device? `ls /dev/spidev*` shows those of this computer",
    }
}

impl SpiTransfer for LinuxSpi {
    fn transfer(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        let sent = bytes.to_vec();
        self.0.transfer(&mut SpidevTransfer::read_write(&sent, bytes))
    }
}
