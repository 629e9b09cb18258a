//! The devices of the boards, and their families.

/// A family of devices whose bitstreams are read back alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FpgaFamily {
    /// Lattice iCE40.
    Ice40,
    /// Lattice ECP5.
    Ecp5,
    /// Gowin LittleBee and Arora.
    Gowin,
}

impl FpgaFamily {
    /// Ending of a file of constraints.
    #[must_use]
    pub fn constraints_ending(self) -> &'static str {
        match self {
            Self::Ice40 => "pcf",
            Self::Ecp5 => "lpf",
            Self::Gowin => "cst",
        }
    }

    /// Ending of a packed bitstream.
    #[must_use]
    pub fn bitstream_ending(self) -> &'static str {
        match self {
            Self::Ice40 => "bin",
            Self::Ecp5 => "bit",
            Self::Gowin => "fs",
        }
    }
}

/// A device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardDevice {
    /// iCE40 UltraPlus 5K.
    Up5k,
    /// iCE40 HX8K.
    Hx8k,
    /// ECP5 with 12,000 look-up tables by its data sheet: the same as [`Lfe5u25f`](Self::Lfe5u25f) but for its identity.
    Lfe5u12f,
    /// ECP5 with 24,000 look-up tables.
    Lfe5u25f,
    /// ECP5 with 84,000 look-up tables.
    Lfe5u85f,
    /// Gowin LittleBee with 8,640 look-up tables.
    Gw1nr9c,
    /// Gowin Arora with 20,736 look-up tables.
    Gw2ar18c,
}

impl BoardDevice {
    /// Its family.
    #[must_use]
    pub fn family(self) -> FpgaFamily {
        match self {
            Self::Up5k | Self::Hx8k => FpgaFamily::Ice40,
            Self::Lfe5u12f | Self::Lfe5u25f | Self::Lfe5u85f => FpgaFamily::Ecp5,
            Self::Gw1nr9c | Self::Gw2ar18c => FpgaFamily::Gowin,
        }
    }

    /// Name of the device.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Up5k => "iCE40UP5K",
            Self::Hx8k => "iCE40HX8K",
            Self::Lfe5u12f => "LFE5U-12F",
            Self::Lfe5u25f => "LFE5U-25F",
            Self::Lfe5u85f => "LFE5U-85F",
            Self::Gw1nr9c => "GW1NR-9C",
            Self::Gw2ar18c => "GW2AR-18C",
        }
    }

    /// The option of nextpnr that selects it; for Gowin the part after `--device`.
    #[must_use]
    pub fn nextpnr_option(self) -> &'static str {
        match self {
            Self::Up5k => "--up5k",
            Self::Hx8k => "--hx8k",
            Self::Lfe5u12f => "--12k",
            Self::Lfe5u25f => "--25k",
            Self::Lfe5u85f => "--85k",
            Self::Gw1nr9c => "GW1NR-LV9QN88PC6/I5",
            Self::Gw2ar18c => "GW2AR-LV18QN88C8/I7",
        }
    }

    /// The name by which the timing model of Yosys for iCE40 knows it; empty for others.
    #[must_use]
    pub fn yosys_timing(self) -> &'static str {
        match self {
            Self::Up5k => "u",
            Self::Hx8k => "hx",
            _ => "",
        }
    }

    /// The name of the die in apycula's database; empty for other families.
    #[must_use]
    pub fn gowin_die(self) -> &'static str {
        match self {
            Self::Gw1nr9c => "GW1N-9C",
            Self::Gw2ar18c => "GW2A-18C",
            _ => "",
        }
    }

    /// Number of logic cells.
    #[must_use]
    pub fn logic_cells(self) -> u64 {
        match self {
            Self::Up5k => 5280,
            Self::Hx8k => 7680,
            // nextpnr uses the whole of a 12F.
            Self::Lfe5u12f | Self::Lfe5u25f => 24_288,
            Self::Lfe5u85f => 83_640,
            Self::Gw1nr9c => 8640,
            Self::Gw2ar18c => 20_736,
        }
    }

    /// Number of block RAMs: of 4,096 bits in iCE40, of 18,432 bits in ECP5 and Gowin.
    #[must_use]
    pub fn memories(self) -> u64 {
        match self {
            Self::Up5k => 30,
            Self::Hx8k => 32,
            Self::Lfe5u12f | Self::Lfe5u25f => 56,
            Self::Lfe5u85f => 208,
            Self::Gw1nr9c => 26,
            Self::Gw2ar18c => 46,
        }
    }
}
