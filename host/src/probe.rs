//! Probing: a move that ends at an edge of the capture line, and where the axes were at that edge.

use std::io::{Read, Write};

use posicast_machine::machine_file::CaptureEdge;

use crate::moves::HostMove;
use crate::{HostError, HostedStage};

/// The positions at an edge of the capture line.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedPositions {
    /// Count of each axis, from its origin.
    pub positions: Vec<i32>,
    /// Clocks since the stage's reset, modulo 2^32.
    pub stamp: u32,
    /// Whether the edge rises.
    pub rising: bool,
}

/// What a probing move found.
#[derive(Debug, Clone, PartialEq)]
pub struct Probing {
    /// The positions at the first edge.
    pub found: CapturedPositions,
    /// How far the axis went on, in its counts: where it stands, less where it was at the edge.
    pub overrun: i32,
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// Moves an axis that is switched on until the capture line has an edge, stops it, and returns where all axes were at the edge. The
    /// edges are those of `[capture]` in the machine file.
    ///
    /// The hardware takes the positions: how fast the host looks adds to the overrun and not to the error.
    ///
    /// # Errors
    /// [`HostError::NoEdge`] for a stage without `[capture]`, and where the move ends without an edge; otherwise those of
    /// [`move_axes`](Self::move_axes).
    pub fn probe(&mut self, way: HostMove) -> Result<Probing, HostError> {
        let axis = way.axis;
        if self.machine().capture.is_none() {
            return Err(self.not_probed(axis, "the machine file has no [capture]"));
        }
        self.begin_capture(axis)?;
        let found = self.seek(way, Self::oldest_capture);
        // A later touch is not one of this move.
        let control = self.register("capture_control")?.reset();
        self.write(&[("capture_control".to_owned(), control)])?;
        let found =
            found?.ok_or_else(|| self.not_probed(axis, "the move ended without an edge of the capture line"))?;
        let stands = self.read_one(axis, "position")? as i32;
        let at_edge = found.positions.get(axis).copied().unwrap_or_default();
        Ok(Probing {
            overrun: stands.wrapping_sub(at_edge),
            found,
        })
    }

    /// Forgets earlier edges, and demands that the line can have the edge that is wanted.
    fn begin_capture(&mut self, axis: usize) -> Result<(), HostError> {
        let [level, known] =
            ["capture_level", "capture_level_known"].map(|name| self.stage_field("capture_state", name));
        let (level, known) = (level?, known?);
        let [state] = self.read(&["capture_state".to_owned()])?[..] else {
            return Err(HostError::NoRegister("CAPTURE_STATE".to_owned()));
        };
        if known.of(state) == 0 {
            return Err(self.not_probed(axis, "the capture line is not stable for as long as its filter"));
        }
        let touches = match self.machine().capture.map(|capture| capture.edge) {
            Some(CaptureEdge::Rising) => level.of(state) != 0,
            Some(CaptureEdge::Falling) => level.of(state) == 0,
            Some(CaptureEdge::Both) | None => false,
        };
        if touches {
            return Err(self.not_probed(
                axis,
                "the probe touches before the move: move it free, or look at its line",
            ));
        }
        let register = self.register("capture_control")?;
        let enable = self.stage_field("capture_control", "capture_enable")?.mask();
        let (off, on) = (register.reset() & !enable, register.reset() | enable);
        self.write(&[
            ("capture_control".to_owned(), off),
            ("capture_clear".to_owned(), 0),
            ("capture_control".to_owned(), on),
        ])
    }

    /// The oldest entry of the capture, which stays; `None` if there is none.
    fn oldest_capture(&mut self) -> Result<Option<CapturedPositions>, HostError> {
        let axes = self.machine().axes.len();
        let own = ["capture_state", "capture_stamp"].map(str::to_owned);
        let counts = (0..axes).map(|axis| format!("capture_count_{axis}"));
        let origins = (0..axes).map(|axis| self.of(axis, "origin"));
        let names: Vec<String> = own.into_iter().chain(counts).chain(origins).collect();
        let words = self.read(&names)?;
        let [state, stamp, rest @ ..] = &words[..] else {
            return Ok(None);
        };
        let flag =
            |name: &str| -> Result<bool, HostError> { Ok(self.stage_field("capture_state", name)?.of(*state) != 0) };
        if !flag("capture_valid")? {
            return Ok(None);
        }
        let (counts, origins) = rest.split_at(axes);
        let positions = counts
            .iter()
            .zip(origins)
            .map(|(count, origin)| count.wrapping_sub(*origin) as i32);
        Ok(Some(CapturedPositions {
            positions: positions.collect(),
            stamp: *stamp,
            rising: flag("capture_rising")?,
        }))
    }

    fn not_probed(&self, axis: usize, what: &'static str) -> HostError {
        HostError::NoEdge {
            axis: self.axis(axis).name.clone(),
            what,
        }
    }
}
