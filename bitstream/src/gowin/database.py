"""Prints as JSON what is wired to what in a Gowin device, and which bits of its tiles mean what: facts of apycula's chip database alone.

    database.py DEVICE PART      such as GW1N-9C GW1NR-LV9QN88PC6/I5

Bits of a tile are numbers: row * width + column. The forms of slices, pads and memories are computed by gowin_pack's own functions from
attributes that are listed here.
"""

import importlib.metadata
import itertools
import json
import os
import sys

import apycula
from apycula import attrids, chipdb, gowin_pack


def numbers(tile, bits):
    return sorted(row * tile.width + column for row, column in bits)


def attributes(db, table, names, values, of):
    found = set()
    for name, value in of.items():
        value = values[value] if isinstance(value, str) else value
        chipdb.add_attr_val(db, table, found, names[name], value)
    return found


def switches(tile):
    """Source wires of each wire, with the bits of the switch: those that say "not from here" are among them."""
    found = {}
    for sink, sources in itertools.chain(tile.pips.items(), tile.clock_pips.items()):
        for source, bits in sources.items():
            bits = set(bits)
            if sink in tile.pips:
                for others, alone in tile.alonenode.get(sink, []):
                    if source not in others:
                        bits |= alone
            found.setdefault(sink, {})[source] = numbers(tile, bits)
    return found


def slice_forms(db, tile, number):
    """The bits of every use of a slice: its two flip-flops, their reset and clock, and whether it is part of a carry chain.

    A slice without flip-flops has the bits of one whose flip-flops have no reset.
    """
    forms = []
    on_off = (False, True)
    resets = [None, "synchronous", "asynchronous"]
    for is_carry, set0, set1, reset, is_inverted in itertools.product(on_off, on_off, on_off, resets, on_off):
        slices = {}
        for index, is_set in enumerate((set0, set1)):
            letter = {None: "SR", "synchronous": "SR", "asynchronous": "PC"}[reset][0 if is_set else 1]
            mode = "DFF" + ("N" if is_inverted else "") + letter
            gowin_pack.place_dff(db, None, None, None, 2 * number + index, mode, 1, 1, slices)
        values = slices[1, 1, number]
        if reset is None:
            del values["LSRONMUX"]
        if is_carry:
            values.update({"MODE": "ALU", "ALU_CIN_MUX": "ALU_5A_CIN_COUT"})
        elif number == 0:
            values["ALU_CIN_MUX"] = "ALU_5A_CIN_COUT"
        found = attributes(db, "SLICE", attrids.cls_attrids, attrids.cls_attrvals, values)
        bits = chipdb.get_shortval_fuses(db, tile.ttyp, found, f"CLS{number}")
        forms.append({"carry": is_carry, "set": [set0, set1], "reset": reset, "inverted": is_inverted, "bits": numbers(tile, bits)})
    every = set().union(*db.shortval[tile.ttyp][f"CLS{number}"].values())
    return {"every": numbers(tile, every), "forms": forms}


def pad_forms(db, tile, letter):
    """The bits of the uses of a pad: input, output, or none."""
    pack = gowin_pack
    forms = []
    types = ["LVCMOS12", "LVCMOS15", "LVCMOS18", "LVCMOS25", "LVCMOS33"]
    pulls = ["NONE", "UP", "DOWN"]
    for kind, own, bank, pull in itertools.product(["IBUF", "OBUF", None], types, types, pulls):
        if kind is None:
            values = {"IO_TYPE": own}
            if own != bank or pull != "UP":
                continue
        else:
            values = dict(pack._init_io_attrs[kind], IO_TYPE=own, PULLMODE=pull)
            if kind == "OBUF" and own != bank:
                continue
        values["BANK_VCCIO"] = pack._vcc_ios[bank]
        found = attributes(db, "IOB", attrids.iob_attrids, attrids.iob_attrvals, values)
        bits = chipdb.get_longval_fuses(db, tile.ttyp, found, f"IOB{letter}")
        use = {"IBUF": "input", "OBUF": "output", None: "none"}[kind]
        forms.append({"use": use, "type": own, "bank": bank, "pull": pull, "bits": numbers(tile, bits)})
    every = set().union(*db.longval[tile.ttyp][f"IOB{letter}"].values())
    return {"every": numbers(tile, every), "forms": forms}


def memory_forms(db, tile):
    """The bits of the uses of a block RAM in one of its three tiles: with one port that writes and one that reads, or with two of both."""
    forms = []
    cell = {"connections": {f"ADA{bit}": [""] for bit in range(4)}}
    numbered = ((1, 2, 4, 9, 18, 36), (False, True), ["SYNC", "ASYNC"])
    for width, has_register, reset in itertools.product(*numbered):
        read = str(int(has_register))
        parameters = {
            "BIT_WIDTH_0": f"{width:b}", "BIT_WIDTH_1": f"{width:b}", "RESET_MODE": reset, "BLK_SEL_0": "000", "BLK_SEL_1": "000",
        }
        uses = [("SDP", [0, 0], {"READ_MODE": read})]
        if width <= 18:
            for modes in itertools.product(range(3), range(3)):
                names = {f"WRITE_MODE{port}": f"{mode:b}" for port, mode in enumerate(modes)}
                uses.append(("DP", list(modes), {"READ_MODE0": read, "READ_MODE1": read} | names))
        for kind, modes, more in uses:
            found = gowin_pack.set_bsram_attrs(db, cell, kind, parameters | more)
            bits = chipdb.get_shortval_fuses(db, tile.ttyp, found, f"BSRAM_{kind}")
            form = {"kind": kind, "modes": modes, "width": width, "registered": has_register, "asynchronous": reset == "ASYNC"}
            forms.append(form | {"bits": numbers(tile, bits)})
    tables = [bits for name, bits in db.shortval[tile.ttyp].items() if name.startswith("BSRAM_")]
    every = set().union(*(set().union(*table.values()) for table in tables))
    return {"every": numbers(tile, every), "forms": forms}


def configuration(db, tile):
    """The bits with settings of the whole device and of the banks of pads."""
    short, long = db.shortval.get(tile.ttyp, {}), db.longval.get(tile.ttyp, {})
    tables = [short[name] for name in ("CFG", "GSR") if name in short]
    if any(name.startswith("BANK") for name in tile.bels):
        tables += [long[name] for name in ("BANK", "IOBA", "IOBB") if name in long]
    return numbers(tile, set().union(*(bits for table in tables for bits in table.values())))


def kind(db, number):
    tile = db.tiles[number]
    short = db.shortval.get(number, {})
    found = {
        "width": tile.width,
        "height": tile.height,
        "switches": switches(tile),
        "isolated": {wire: numbers(tile, set().union(*(bits for _, bits in of))) for wire, of in tile.alonenode_6.items()},
        "fixed": numbers(tile, db.const.get(number, [])),
        "configuration": configuration(db, tile),
        "tables": [[numbers(tile, tile.bels[f"LUT{index}"].flags[bit])[0] for bit in range(16)] for index in range(8)
                   if f"LUT{index}" in tile.bels],
        "slices": [slice_forms(db, tile, index) for index in range(4) if f"CLS{index}" in short],
        "pads": {},
        "ports": {},
    }
    for letter in "AB":
        name = f"IOB{letter}"
        if name in tile.bels and name in db.longval.get(number, {}):
            found["pads"][letter] = pad_forms(db, tile, letter)
            found["ports"].update({f"{letter}.{port}": wire for port, wire in tile.bels[name].portmap.items()})
    if "BSRAM_SDP" in short:
        found["memory"] = memory_forms(db, tile)
    if "BSRAM" in tile.bels:
        found["ports"].update(tile.bels["BSRAM"].portmap)
    return found


def carry_tables(db):
    """The table of each kind of a carry, by the name that nextpnr gives it."""
    found = {}
    for number in {kind for row in db.grid for kind in row}:
        tile = db.tiles[number]
        for index in range(6):
            if f"ALU{index}" not in tile.bels:
                continue
            flags = tile.bels[f"LUT{index}"].flags
            for mode, bits in tile.bels[f"ALU{index}"].modes.items():
                table = sum(1 << entry for entry in range(16) if not flags[entry] <= bits)
                assert found.setdefault(mode, table) == table
    return found


def place(db, name):
    """Row, column and letter of a pad such as IOR17A."""
    side, number, letter = name[2], int(name[3:-1]) - 1, name[-1]
    row, column = {"T": (0, number), "B": (db.rows - 1, number), "L": (number, 0), "R": (number, db.cols - 1)}[side]
    return [row, column, letter]


def main():
    device, part = sys.argv[1:]
    db = chipdb.load_chipdb(os.path.join(os.path.dirname(apycula.__file__), f"{device}.msgpack.xz"))
    gowin_pack.device = device
    package, variant, _ = db.packages[part]
    used = {kind for row in db.grid for kind in row}
    segments = [
        {key: segment[key] for key in ("min_x", "min_y", "max_x", "max_y", "top_row", "bottom_row", "top_wire", "bottom_wire")}
        | {"column": column, "index": index}
        for (_, column, index), segment in db.segments.items()
    ]
    init = [[db.rev_logicinfo("BSRAM_INIT")[bit * 4 + high][0] - 1 for high in range(4)] for bit in range(18)]
    print(json.dumps({
        "version": importlib.metadata.version("Apycula"),
        "grid": db.grid,
        "kinds": {number: kind(db, number) for number in used},
        "nodes": [sorted([row, column, wire] for row, column, wire in wires) for _, wires in db.nodes.values() if len(wires) > 1],
        "spines": {
            name: sorted([row, column] for row, column, _ in wires)
            for name, (_, wires) in db.nodes.items()
            if name.startswith("SPINE")
        },
        "segments": segments,
        "carry_tables": carry_tables(db),
        "bottom_wires": list(db.bottom_io[:2]),
        "memory_rows": sorted(db.simplio_rows),
        "memory_columns": init,
        "pins": {pin: place(db, name) for pin, (name, _) in db.pinout[variant][package].items() if name.startswith("IO")},
    }))


main()
