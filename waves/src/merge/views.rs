//! The files that open a merged waveform in GTKWave and in Surfer.

use std::path::Path;

use super::{DIFFERENCE, DifferenceSignal, Open};
use crate::WaveError;
use crate::files::{OutputSink, write_text};
use crate::reader::Kind;

/// GTKWave's formats: right-aligned binary, signed decimal, signed decimal as a step curve, and an additional row for
/// the curve above.
const GTKWAVE_BIT: &str = "@28";
const GTKWAVE_SIGNED: &str = "@420";
const GTKWAVE_CURVE: &str = "@8420";
const GTKWAVE_ROOM: &str = "@20000\n-\n@20000\n-\n";
/// Vectors with at least this width are numbers that are shown as a curve.
const CURVE_BITS: u32 = 16;
/// Width of GTKWave's waves, in units of the 200 pixels in which its zoom counts, so that the whole time is visible.
const GTKWAVE_WIDTH: f64 = 4.6;

/// Writes the views. They show the signals that change: one that never changes is found in the viewer's tree. They
/// open at a time and its surroundings, or show everything.
pub(super) fn write_views(
    sink: &dyn OutputSink,
    path: &Path,
    parts: &[Open],
    differences: &[DifferenceSignal<'_>],
    end: u64,
    spot: Option<[u64; 2]>,
) -> Result<(), WaveError> {
    let file = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let shown = spot.map_or(end, |[_, span]| span);
    let zoom = (GTKWAVE_WIDTH / shown.max(1) as f64).log2();
    let mut gtkwave = format!("[dumpfile] \"{file}\"\n[size] 1400 900\n");
    match spot {
        Some([time, span]) => {
            let start = time.saturating_sub(span / 2);
            gtkwave.push_str(&format!("[timestart] {start}\n*{zoom:.6} {time}\n"));
        }
        None => gtkwave.push_str(&format!("*{zoom:.6} -1\n")),
    }
    let mut surfer = format!("load_file {file}\n");
    let mut heading = |gtkwave: &mut String, scope: &str| {
        gtkwave.push_str(&format!("@200\n-{scope}\n"));
        surfer.push_str(&format!("divider_add {scope}\nscope_add {scope}\n"));
    };
    for part in parts {
        heading(&mut gtkwave, &part.scope);
        let moves = |slot: &u32| spot.is_some() || part.values[*slot as usize] > 1;
        for (name, slot) in part.signals.iter().filter(|(_, slot)| moves(slot)) {
            let line = match part.read.values.kind(*slot) {
                Kind::Bits(1) => format!("{GTKWAVE_BIT}\n{}.{name}\n", part.scope),
                Kind::Bits(width) if width >= CURVE_BITS => {
                    format!(
                        "{GTKWAVE_CURVE}\n{}.{name}[{}:0]\n{GTKWAVE_ROOM}",
                        part.scope,
                        width - 1
                    )
                }
                Kind::Bits(width) => format!("{GTKWAVE_SIGNED}\n{}.{name}[{}:0]\n", part.scope, width - 1),
                Kind::Text | Kind::Event | Kind::Any(_) => format!("{GTKWAVE_BIT}\n{}.{name}\n", part.scope),
                Kind::Real => {
                    format!("{GTKWAVE_CURVE}\n{}.{name}\n{GTKWAVE_ROOM}", part.scope)
                }
            };
            gtkwave.push_str(&line);
        }
    }
    if !differences.is_empty() {
        heading(&mut gtkwave, DIFFERENCE);
    }
    for difference in differences {
        gtkwave.push_str(&format!(
            "{GTKWAVE_CURVE}\n{DIFFERENCE}.{}\n{GTKWAVE_ROOM}",
            difference.name
        ));
    }
    surfer.push_str("zoom_fit\n");
    if let Some([time, span]) = spot {
        // Each halves the visible time; the cursor's position in it comes last.
        let halvings = (end.max(1) as f64 / span.max(1) as f64).log2().floor().max(0.0) as usize;
        surfer.push_str(&format!(
            "cursor_set {time}\n{}goto_cursor\n",
            "zoom_in\n".repeat(halvings)
        ));
    }
    write_text(sink, &path.with_extension("gtkw"), &gtkwave)?;
    write_text(sink, &path.with_extension("sucl"), &surfer)
}
