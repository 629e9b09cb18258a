"""Validates CMSIS-SVD with the published schema, reads it with cmsis-svd, and prints it as read_rdl.py does."""

import sys
from pathlib import Path

import cmsis_svd
from cmsis_svd.parser import SVDParser
from lxml import etree

path = sys.argv[1]
schemas = Path(cmsis_svd.__file__).parent / "schemas"
schema = etree.XMLSchema(etree.parse(str(schemas / "CMSIS-SVD_1_3_9.xsd")))
schema.assertValid(etree.parse(path))

[peripheral] = SVDParser.for_xml_file(path).get_device().peripherals
registers = [one for found in peripheral.registers for one in getattr(found, "registers", [found])]
for register in registers:
    for field in sorted(register.fields, key=lambda field: field.bit_offset):
        access = {"READ_ONLY": "r", "READ_WRITE": "rw", "WRITE_ONLY": "w"}[register.access.name]
        clears = register.modified_write_values is not None and register.modified_write_values.name == "ONE_TO_CLEAR"
        reset = (register.reset_value >> field.bit_offset) & ((1 << field.bit_width) - 1)
        print(
            register.address_offset,
            register.name,
            field.name,
            field.bit_offset,
            field.bit_width,
            "rw1c" if clears else access,
            reset if register.reset_mask else "-",
        )
