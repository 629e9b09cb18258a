//! The steps of a bitstream, from its Verilog to the comparisons.

use super::document::Evidence;
use super::durations::{Durations, Part};
use super::subject::Subject;
use crate::observer::Observer;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::flips::{self, FaultFree, FlipReport};
use posicast_bitstream::label::BitsLabel;
use posicast_bitstream::toolchain::{BitsNetlist, Routed, Toolchain};
use posicast_bitstream::top::TopFiles;
use posicast_system::{kept, scratch};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::time::Instant;
use std::{fs, io, thread};

/// Prefix of the kept files.
pub(super) const KEPT_PREFIX: &str = "bitstream-";

/// What the steps work with.
pub(super) struct Run<'a> {
    pub(super) subject: &'a Subject<'a>,
    pub(super) files: &'a TopFiles,
    pub(super) tools: &'a dyn Toolchain,
    pub(super) folder: &'a Path,
    /// A packed file that is checked in place of a new one.
    pub(super) given: Option<&'a Path>,
    /// Name of the machine.
    pub(super) machine: &'a str,
    /// Number of its axes.
    pub(super) axes: usize,
    pub(super) clocks: Option<u64>,
    pub(super) seed: u64,
    pub(super) observer: &'a dyn Observer,
}

impl Run<'_> {
    /// Builds the bitstream of these Verilog files, reads it back, and compares it.
    pub(super) fn evidence(&self, sources: &[PathBuf]) -> Result<Evidence, BitstreamError> {
        let (tools, folder) = (self.tools, self.folder);
        let mut durations = Durations::of_kind(&self.kind());
        let versions = tools.versions(folder)?;
        let key = self.key(sources, &versions)?;
        let label = BitsLabel::new(self.machine, &self.board(), &key);
        let given = self.given.map(|path| self.read_given(path, &label)).transpose()?;
        let routed = self.routed(sources, &key, &mut durations)?;
        let (packed, text, netlist, tiles, cells) = self.timed(&mut durations, Part::ReadingBack, || {
            let own = tools.pack(&tools.labelled(&routed.text, &label.line()), folder)?;
            let (packed, text) = match given {
                Some(given) => given,
                None => {
                    let text = tools.unpack(&own, folder)?;
                    (own.clone(), text)
                }
            };
            let netlist = tools.decode(&text, folder)?;
            let mut tiles = tools.compare_tiles(&routed, &packed, &text, folder)?;
            if packed != own && tiles.differences.is_empty() {
                tiles.differences = tools.different_tiles(&tools.unpack(&own, folder)?, &text);
                if tiles.differences.is_empty() {
                    tiles.differences.push("bytes outside the tiles".to_owned());
                }
            }
            let cells = netlist.compare_cells(&routed.netlist)?;
            Ok((packed, text, netlist, tiles, cells))
        })?;
        let network = netlist.network();
        let first_difference =
            |netlist: &dyn BitsNetlist| self.subject.first_difference(netlist, &routed.netlist, self.seed);
        let fault_free = FaultFree {
            routed: &routed,
            packed: &packed,
            text: &text,
            netlist: netlist.as_ref(),
            network: &network,
            lock_step: &first_difference,
        };
        // Reading the flips back takes as long as the lock step, and neither needs the other.
        let begun = Instant::now();
        let (lock_step, flips) = thread::scope(|scope| {
            let flips = scope.spawn(|| self.flips(&fault_free));
            (self.lock_step(netlist.as_ref(), &routed), flips.join())
        });
        let (lock_step, flips) = (
            lock_step?,
            flips.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?,
        );
        // With another number of clocks, the checks take another time.
        if self.clocks.is_none() {
            durations.took(Part::Checks, begun.elapsed());
        }
        Ok(Evidence {
            versions,
            highest_mhz: routed.highest_mhz,
            tiles,
            cells,
            lock_step,
            flips,
            packed,
            verilog: netlist.verilog(&format!("{}_netlist", self.files.module)),
            seed: self.seed,
        })
    }

    /// The kind of bitstream, as a name without blanks: bitstreams of one kind take about the same time.
    fn kind(&self) -> String {
        let family = self.files.board.device.family().constraints_ending();
        format!("{family}-{}-{}", self.subject.what(), self.axes)
    }

    /// Does a part of the work, and keeps its time.
    fn timed<T>(
        &self,
        durations: &mut Durations,
        part: Part,
        work: impl FnOnce() -> Result<T, BitstreamError>,
    ) -> Result<T, BitstreamError> {
        let _shown = self.observer.begin_timed(part.what(), durations.expected(part));
        let begun = Instant::now();
        let done = work()?;
        durations.took(part, begun.elapsed());
        Ok(done)
    }

    /// Name of the board in a label.
    fn board(&self) -> String {
        let bare = if self.files.is_bare { "-bare" } else { "" };
        format!("{}{bare}", self.files.board.name)
    }

    /// Reads a packed file, and its text, if its label is that of this design.
    fn read_given(&self, path: &Path, label: &BitsLabel) -> Result<(Vec<u8>, String), BitstreamError> {
        let packed = fs::read(path).map_err(|source| BitstreamError::Io {
            path: path.to_owned(),
            source,
        })?;
        let refused = |reason: String| BitstreamError::NotThisDesign {
            path: path.to_owned(),
            reason,
        };
        let text = self.tools.unpack(&packed, self.folder).map_err(|error| {
            let device = self.files.board.device.name();
            refused(format!("this is no intact bitstream of {device}: {error}"))
        })?;
        let found = BitsLabel::read(&text).ok_or_else(|| {
            refused(
                "it has no label of posicast among its comments: give a file that `posicast bitstream` has written"
                    .to_owned(),
            )
        })?;
        if (&found.machine, &found.board) != (&label.machine, &label.board) {
            return Err(refused(format!(
                "it is of the machine {} on {}; this machine file and --board are of {} on {}",
                found.machine, found.board, label.machine, label.board
            )));
        }
        if found.checksum != label.checksum {
            return Err(refused(format!(
                "it is of another state of the machine file, or other versions of the tools built it: its checksum is {}, that of this design {}; \
                 build the bitstream anew",
                found.checksum, label.checksum
            )));
        }
        Ok((packed, text))
    }

    /// The routed design of these Verilog files: that of an earlier run, if nothing has changed.
    fn routed(&self, sources: &[PathBuf], key: &str, durations: &mut Durations) -> Result<Routed, BitstreamError> {
        let file = kept::folder().join(format!("{KEPT_PREFIX}{key}.json"));
        let earlier = kept::holds(&file).then(|| fs::read(&file).ok()).flatten();
        if let Some(routed) = earlier.and_then(|text| serde_json::from_slice(&text).ok()) {
            self.observer
                .say("note: neither the Verilog nor the tools have changed since an earlier run, whose routed design is used again");
            return Ok(routed);
        }
        let (tools, folder) = (self.tools, self.folder);
        let synthesised = self.timed(durations, Part::Synthesis, || {
            tools.synthesise(sources, &self.files.module, folder)
        })?;
        synthesised.check_fit(&self.files.board)?;
        let routed = self.timed(durations, Part::PlaceAndRoute, || {
            tools.place_and_route(&self.files.constraints(), folder)
        })?;
        // Where nothing can be kept, the next run takes as long as this one.
        let _ = keep(&routed, &file);
        Ok(routed)
    }

    /// A checksum of everything on which the routed design depends.
    fn key(&self, sources: &[PathBuf], versions: &[String; 2]) -> Result<String, BitstreamError> {
        let mut hash = Sha256::new();
        let mut add = |text: &[u8]| {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        };
        versions.iter().for_each(|version| add(version.as_bytes()));
        add(self.tools.recipe(&self.files.module).as_bytes());
        add(self.files.constraints().as_bytes());
        for source in sources {
            let text = fs::read(source).map_err(|error| BitstreamError::Io {
                path: source.clone(),
                source: error,
            })?;
            add(&text);
        }
        Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }

    fn lock_step(
        &self,
        netlist: &dyn BitsNetlist,
        routed: &Routed,
    ) -> Result<super::document::LockStepDocument, BitstreamError> {
        let clocks = self.subject.clocks(self.clocks);
        let bar = self
            .observer
            .begin("lock step of the bits with the model", Some(*clocks.start()));
        let mut progress = |done| bar.reach(done);
        self.subject
            .lock_step(netlist, &routed.netlist, (clocks, self.seed), &mut progress)
    }

    fn flips(&self, fault_free: &FaultFree<'_>) -> Result<Vec<FlipReport>, BitstreamError> {
        let chosen = flips::choose(fault_free);
        let bar = self
            .observer
            .begin("single faults in the bits", Some(chosen.len() as u64));
        flips::flips(fault_free, (self.tools, self.folder), &chosen, &|| bar.advance(1))
    }
}

/// Keeps a value, such as a routed design, for later runs.
pub(super) fn keep(value: &impl Serialize, file: &Path) -> io::Result<()> {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    kept::remove_old(folder, KEPT_PREFIX);
    let work = scratch::Folder::new_in("build-", folder)?;
    let made = work.path().join("value.json");
    fs::write(&made, serde_json::to_vec(value)?)?;
    kept::keep(&made, file)
}
