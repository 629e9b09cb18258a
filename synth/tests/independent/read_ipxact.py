"""Reads an IP-XACT component with ipyxact, and prints its interfaces, its files, its ports, and a line per field as read_rdl.py does."""

import sys

import ipyxact.ipyxact as ipxact
from lxml import etree

component = ipxact.Component()
component.load(sys.argv[1])
print("component", component.vendor, component.library, component.name, component.version)
for interface in component.busInterfaces.busInterface:
    ports = [f"{one.logicalPort.name}={one.physicalPort.name}" for one in interface.portMaps.portMap]
    print("interface", interface.name, interface.busType.name, interface.abstractionType.name, *ports)
for files in component.fileSets.fileSet:
    print("files", files.name, *(one.name for one in files.file))
# ipyxact reads the vectors of a later version only.
space = {"spirit": "http://www.spiritconsortium.org/XMLSchema/SPIRIT/1685-2009"}
tree = etree.parse(sys.argv[1])
for port in component.model.ports.port:
    left = tree.xpath(f"//spirit:port[spirit:name='{port.name}']//spirit:left/text()", namespaces=space)
    print("port", port.name, port.wire.direction, int(left[0]) + 1 if left else 1)
[memory] = component.memoryMaps.memoryMap
[block] = memory.addressBlock
print("block", block.baseAddress, block.range, block.width)
for register in block.register:
    for word in range(max(register.dim, 1)):
        name = f"{register.name}_{word}" if register.dim > 1 else register.name
        for field in sorted(register.field, key=lambda field: field.bitOffset):
            access = {"read-only": "r", "read-write": "rw", "write-only": "w"}[field.access]
            clears = field.modifiedWriteValue == "oneToClear"
            print("field", register.addressOffset + 4 * word, name, field.name, field.bitOffset, field.bitWidth, "rw1c" if clears else access)
