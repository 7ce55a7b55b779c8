"""Writes an Exodus mesh as a grid of VTK: element blocks and side sets by their numbers.

Prints a line for each block and side set. Exit code 3 without VTK.
"""

import sys

try:
    from vtkmodules.vtkIOExodus import vtkExodusIIReader
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(3)


def read(path):
    """The reader with all blocks and side sets taken in, and what is added to numbers of the latter.

    Blocks and side sets count apart; where they share numbers, side sets come behind.
    """
    reader = vtkExodusIIReader()
    if not reader.CanReadFile(path):
        sys.exit("it is no Exodus file")
    reader.SetFileName(path)
    reader.UpdateInformation()
    reader.SetGenerateGlobalNodeIdArray(1)
    reader.SetGenerateObjectIdCellArray(1)
    reader.ApplyDisplacementsOff()
    blocks, sides = objects(reader, reader.ELEM_BLOCK), objects(reader, reader.SIDE_SET)
    shift = max(blocks, default=0) if blocks.keys() & sides.keys() else 0
    for word, own, added in (("block", blocks, 0), ("side set", sides, shift)):
        for number, name in own.items():
            print(f"{word} {number} ({name}) has the number {number + added}")
    reader.Update()
    return reader, shift


def objects(reader, kind):
    """Names of all objects of a kind by their numbers; they will be read."""
    for index in range(reader.GetNumberOfObjects(kind)):
        reader.SetObjectStatus(kind, index, 1)
    every = range(reader.GetNumberOfObjects(kind))
    return {reader.GetObjectId(kind, i): reader.GetObjectName(kind, i) for i in every}


def parts(data, shift, added=0):
    """The grids in a tree of blocks, and what is added to their numbers."""
    if data is None:
        return
    if data.IsA("vtkUnstructuredGrid"):
        yield data, added
        return
    for index in range(data.GetNumberOfBlocks()):
        own = data.GetMetaData(index)
        is_sides = own is not None and own.Get(data.NAME()) == "Side Sets"
        yield from parts(data.GetBlock(index), shift, shift if is_sides else added)


def grid(reader, shift):
    """Nodes by their numbers, and cells as type, nodes and number of the block."""
    nodes, cells = {}, []
    for part, added in parts(reader.GetOutput(), shift):
        numbers = part.GetPointData().GetArray("GlobalNodeId")
        blocks = part.GetCellData().GetArray("ObjectId")
        for point in range(part.GetNumberOfPoints()):
            nodes[int(numbers.GetValue(point))] = part.GetPoint(point)
        for index in range(part.GetNumberOfCells()):
            ids = part.GetCell(index).GetPointIds()
            own = [int(numbers.GetValue(ids.GetId(k))) for k in range(ids.GetNumberOfIds())]
            cells.append((part.GetCellType(index), own, int(blocks.GetValue(index)) + added))
    return nodes, cells


def array(kind, name, values):
    text = "\n".join(values)
    return f'<DataArray type="{kind}" {name} format="ascii">\n{text}\n</DataArray>\n'


def write(path, nodes, cells):
    place = {number: index for index, number in enumerate(sorted(nodes))}
    points = [" ".join(repr(x) for x in nodes[number]) for number in sorted(nodes)]
    ends, end = [], 0
    for _, own, _ in cells:
        end += len(own)
        ends.append(str(end))
    corners = [" ".join(str(place[number]) for number in own) for _, own, _ in cells]
    with open(path, "w") as out:
        out.write('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" ')
        out.write('byte_order="LittleEndian">\n<UnstructuredGrid>\n')
        out.write(f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n<Points>\n')
        out.write(array("Float64", 'NumberOfComponents="3"', points))
        out.write("</Points>\n<Cells>\n")
        out.write(array("Int64", 'Name="connectivity"', corners))
        out.write(array("Int64", 'Name="offsets"', ends))
        out.write(array("UInt8", 'Name="types"', [str(kind) for kind, _, _ in cells]))
        out.write("</Cells>\n<CellData>\n")
        out.write(array("Int32", 'Name="MaterialIDs"', [str(block) for _, _, block in cells]))
        out.write("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


if __name__ == "__main__":
    write(sys.argv[2], *grid(*read(sys.argv[1])))
