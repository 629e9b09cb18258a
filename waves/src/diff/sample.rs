//! Reads a recording as values of a block's ports, clock by clock. It uses the names, the clock and the reset of a
//! comparison, with the ports instead of the second file.
//!
//! ```
//! use wavecmp::diff::DiffOptions;
//! use wavecmp::sample::{PortMap, WantedSignal};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("a.vcd");
//! # std::fs::write(&path, "$scope module t $end $var wire 1 ! clk $end $var wire 4 \" y $end $upscope $end \
//! #     $enddefinitions $end\n#0\n0!\nb1010 \"\n#5\n1!\nb11 \"\n#10\n0!\n#15\n1!\n")?;
//!
//! let y = WantedSignal { name: "y".to_owned(), width: 4 };
//! let map = PortMap::find(&path, "t", &[y], &DiffOptions::default())?.ok_or("nothing in common")?;
//! let mut player = map.play()?;
//! let mut row = [None];
//! let mut values = Vec::new();
//! while player.next(&mut row)?.is_some() {
//!     values.extend(row[0].map(|value| value.bits));
//! }
//! assert_eq!(values, [0b1010, 0b11]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::{Path, PathBuf};

use super::clocking::{Clocking, Slots};
use super::matching::{Matched, Pair};
use super::names::{Filter, Names};
use super::parts::Derived;
use super::side::Side;
use super::touched::Touched;
use super::{DiffOptions, SamplingEdge};
use crate::WaveError;
use crate::reader::{Declarations, FileEnd, Kind, Value, Watch, Wave};
use crate::wording::{counted, time};

const CLOCK: &str = "clk";

/// A signal to find in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WantedSignal {
    /// Its name below the scope.
    pub name: String,
    /// Its width in bits.
    pub width: u32,
}

/// A port's value in a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Recorded {
    /// The bits that are 1.
    pub bits: u64,
    /// The bits that are `x` or `z`, or have no value yet.
    pub unknown: u64,
}

/// The signals of a file that belong to the ports of a block.
#[derive(Debug, Clone)]
pub struct PortMap {
    path: PathBuf,
    /// Slot in the file of each port, in the order of the ports.
    slots: Vec<Option<u32>>,
    derived: Vec<Derived>,
    clock: Slots,
    reset: Option<(Slots, bool)>,
    options: DiffOptions,
    /// How clock and reset were found.
    pub notes: Vec<String>,
    /// Number of signals of the file that are not ports.
    pub strangers: usize,
}

impl PortMap {
    /// Matches the signals of the file with `clk` and `ports` below the scope `top`; `None` if no port is in the
    /// file.
    ///
    /// # Errors
    /// [`WaveError::Option`] where there is no clock, an option fits nothing, or a signal does not have the width of
    /// its port; [`WaveError::File`] and [`WaveError::Damaged`] for a file that cannot be read, or cannot be read
    /// again, such as a pipe.
    pub fn find(
        path: &Path,
        top: &str,
        ports: &[WantedSignal],
        options: &DiffOptions,
    ) -> Result<Option<Self>, WaveError> {
        let mut wave = Wave::open(path)?;
        if wave.bytes().is_none() {
            let pipe = std::io::Error::other("it is not a regular file, and must be read several times; save it first");
            return Err(WaveError::file(path, "replay")(pipe));
        }
        let declared = declarations(top, ports).map_err(WaveError::Option)?;
        let mut options = options.clone();
        if let Some(clock) = &options.clock {
            options.maps.push((clock.clone(), CLOCK.to_owned()));
        }
        let filter = Filter::new(&options.only, &options.ignore)?;
        let file = Names::new(&wave.declarations, options.roots[0].as_deref(), &filter, "recorded")?;
        let block = Names::new(&declared, None, &Filter::new(&[], &[])?, "block's")?;
        let slots = [wave.declarations.kinds.len(), declared.kinds.len()];
        let mut matched = Matched::new(&file, &block, &options.maps, slots)?;
        // A port counts as missing if the file has only some of its bits.
        matched
            .pairs
            .retain(|pair| pair.b.is_none_or(|slot| (slot as usize) < slots[1]));
        let derived = std::mem::take(&mut matched.derived[0]);
        wave.declarations
            .kinds
            .extend(derived.iter().map(|derived| Kind::Bits(derived.width)));
        let kinds = &wave.declarations.kinds;
        let one_bit = |pair: &Pair| pair.a.is_some_and(|slot| kinds[slot as usize] == Kind::Bits(1));
        let is_port = |pair: &&Pair| pair.a.is_some() && pair.b.is_some_and(|slot| slot > 0);
        if matched.pairs.iter().filter(is_port).count() == 0 {
            return Ok(None);
        }
        let clocking = Clocking::find(&matched, &options, one_bit)?;
        let Some(clock) = clocking.clock else {
            return Err(WaveError::Option(format!(
                "{}: no clock among its signals is the block's `{CLOCK}`; name it with --clock NAME",
                path.display()
            )));
        };
        let mut slots = vec![None; ports.len()];
        for pair in matched.pairs.iter().filter(is_port) {
            let (Some(slot), Some(place)) = (pair.a, pair.b) else {
                continue;
            };
            let port = &ports[place as usize - 1];
            if kinds[slot as usize] != Kind::Bits(port.width) {
                return Err(WaveError::Option(format!(
                    "{}: `{}` is not a vector of {}, as the port `{}` is; map another signal to it with --map A=B",
                    path.display(),
                    pair.name,
                    counted(port.width.into(), "bit"),
                    port.name
                )));
            }
            slots[place as usize - 1] = Some(slot);
        }
        Ok(Some(Self {
            path: path.to_owned(),
            slots,
            derived,
            clock,
            reset: clocking.reset,
            notes: clocking.notes,
            strangers: matched.pairs.iter().filter(|pair| pair.b.is_none()).count(),
            options,
        }))
    }

    /// Returns whether a port, given by its index, is in the file.
    pub fn has(&self, port: usize) -> bool {
        self.slots.get(port).is_some_and(Option::is_some)
    }

    /// Returns the number of ports in the file.
    pub fn found(&self) -> usize {
        self.slots.iter().flatten().count()
    }

    /// Plays the file from its beginning.
    ///
    /// # Errors
    /// As [`PortMap::find`].
    pub fn play(&self) -> Result<Player, WaveError> {
        let mut wave = Wave::open(&self.path)?;
        let derived = self.derived.iter();
        wave.declarations
            .kinds
            .extend(derived.map(|derived| Kind::Bits(derived.width)));
        let (declarations, feed) = wave.play(
            Some(Watch {
                slot: self.clock[0],
                falling: self.options.edge == SamplingEdge::Falling,
            }),
            FileEnd::Refuse,
        )?;
        let Declarations { kinds, unit_fs, .. } = declarations;
        let mut side = Side::new(0, feed, &kinds, unit_fs, &self.derived, &mut [], &[]);
        side.start()?;
        Ok(Player {
            side,
            path: self.path.clone(),
            touched: Touched::new(0),
            slots: self.slots.clone(),
            reset: self.reset.map(|([slot, _], active)| (slot, active)),
            is_first: true,
        })
    }
}

/// Returns `clk` and the ports as a file would declare them: slot 0 is the clock, slot n + 1 is port n.
fn declarations(top: &str, ports: &[WantedSignal]) -> Result<Declarations, String> {
    let mut declarations = Declarations::default();
    declarations.enter(top)?;
    let clock = declarations.add_slot(Kind::Bits(1))?;
    declarations.add_name(CLOCK, clock)?;
    for port in ports {
        let slot = declarations.add_slot(Kind::Bits(port.width))?;
        declarations.add_name(&port.name, slot)?;
    }
    Ok(declarations)
}

/// Reads a file clock by clock.
pub struct Player {
    side: Side,
    path: PathBuf,
    touched: Touched,
    slots: Vec<Option<u32>>,
    /// The reset's slot and active value, until it has been released.
    reset: Option<(u32, bool)>,
    is_first: bool,
}

impl Player {
    /// Advances to the next edge of the clock, and fills in the values just before it: one per port, `None` if the
    /// port is not in the file. Returns `None` if there was no edge; the value tells whether the reset, if there is
    /// one, has been released.
    ///
    /// # Errors
    /// [`WaveError::Damaged`] where the file is damaged, or does not record some clocks; [`WaveError::File`] where it
    /// cannot be read.
    pub fn next(&mut self, row: &mut [Option<Recorded>]) -> Result<Option<bool>, WaveError> {
        let Some(edge) = self.side.next_edge(&mut self.touched)? else {
            return Ok(None);
        };
        if edge.gap && !std::mem::take(&mut self.is_first) {
            return Err(WaveError::Damaged {
                path: self.path.clone(),
                place: format!("before {}", time(edge.time_fs)),
                problem: "nothing is recorded for a while ($dumpoff), and what a block does in that time is not known; replay \
                          only what lies before, with --cycles"
                    .to_owned(),
            });
        }
        self.is_first = false;
        if let Some((slot, active)) = self.reset
            && *self.side.values.words(slot) == [u64::from(!active), 0]
        {
            self.reset = None;
        }
        for (value, slot) in row.iter_mut().zip(&self.slots) {
            *value = slot.map(|slot| match self.side.values.get(slot) {
                Value::Bits { bits, unknown, .. } => Recorded {
                    // In unknown bits, a one is `z`.
                    bits: bits[0] & !unknown[0],
                    unknown: unknown[0],
                },
                _ => Recorded::default(),
            });
        }
        Ok(Some(self.reset.is_none()))
    }
}
