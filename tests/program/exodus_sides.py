"""Writes two cubes, blocks 10 and 20, with three side sets as an Exodus file (NetCDF, classic format).

Arguments: the file, and the numbers of the side sets between, below and above the cubes.
"""

import struct
import sys


def padded(data):
    return data + b"\0" * (-len(data) % 4)


def name(text):
    return struct.pack(">i", len(text)) + padded(text.encode())


def value(data):
    """Type and bytes: text, whole numbers or numbers."""
    if isinstance(data, str):
        return 2, len(data), data.encode()
    data = data if isinstance(data, list) else [data]
    if all(isinstance(number, int) for number in data):
        return 4, len(data), struct.pack(f">{len(data)}i", *data)
    return 6, len(data), struct.pack(f">{len(data)}d", *data)


def attributes(own):
    if not own:
        return struct.pack(">ii", 0, 0)
    head = struct.pack(">ii", 12, len(own))
    for key, data in own.items():
        kind, count, raw = value(data)
        head += name(key) + struct.pack(">ii", kind, count) + padded(raw)
    return head


def netcdf(dimensions, own, variables):
    places = {key: place for place, key in enumerate(dimensions)}
    head = b"CDF\x01" + struct.pack(">iii", 0, 10, len(dimensions))
    head += b"".join(name(key) + struct.pack(">i", size) for key, size in dimensions.items())
    head += attributes(own)
    raw = [padded(value(data)[2]) for _, _, data, _ in variables]

    def listed(begin):
        out = struct.pack(">ii", 11, len(variables))
        for (key, along, data, notes), data_bytes in zip(variables, raw):
            out += name(key) + struct.pack(">i", len(along))
            out += b"".join(struct.pack(">i", places[one]) for one in along) + attributes(notes)
            out += struct.pack(">iii", value(data)[0], len(data_bytes), begin)
            begin += len(data_bytes)
        return out

    return head + listed(len(head) + len(listed(0))) + b"".join(raw)


def cubes(sets):
    corners = [(x, y, z) for z in range(3) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    dimensions = {"num_dim": 3, "num_nodes": 12, "num_elem": 2, "num_el_blk": 2, "num_side_sets": 3}
    for block in (1, 2):
        dimensions |= {f"num_el_in_blk{block}": 1, f"num_nod_per_el{block}": 8}
    variables = [
        ("eb_prop1", ["num_el_blk"], [10, 20], {"name": "ID"}),
        ("ss_prop1", ["num_side_sets"], sets, {"name": "ID"}),
    ]
    for axis, key in enumerate("xyz"):
        along = [float(corner[axis]) for corner in corners]
        variables.append((f"coord{key}", ["num_nodes"], along, {}))
    for block, first in ((1, 1), (2, 5)):
        along = [f"num_el_in_blk{block}", f"num_nod_per_el{block}"]
        nodes = list(range(first, first + 8))
        variables.append((f"connect{block}", along, nodes, {"elem_type": "HEX8"}))
    for number, (element, side) in enumerate(((1, 6), (1, 5), (2, 6)), 1):
        dimensions[f"num_side_ss{number}"] = 1
        variables.append((f"elem_ss{number}", [f"num_side_ss{number}"], [element], {}))
        variables.append((f"side_ss{number}", [f"num_side_ss{number}"], [side], {}))
    about = {"api_version": 5.0, "version": 5.0, "floating_point_word_size": 8, "file_size": 1}
    return netcdf(dimensions, about, variables)


if __name__ == "__main__":
    with open(sys.argv[1], "wb") as out:
        out.write(cubes([int(number) for number in sys.argv[2].split(",")]))
