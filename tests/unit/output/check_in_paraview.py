"""Opens the XDMF of the run of records.h in ParaView's three readers, as a user would. Run by scripts/pvbatch.

Usage: scripts/pvbatch check_in_paraview.py RESULT.xdmf FRAMES. Exit code 0 when every reader finds all time steps, the five
points of the cage and the three of the skin, and saturations from 0.25 to 0.75.
"""
import sys

from paraview import servermanager, simple


def leaves(data):
    """The data sets in a tree of blocks or pieces."""
    if data is None:
        return []
    for kind, part in (("Block", "vtkMultiBlockDataSet"), ("Piece", "vtkMultiPieceDataSet")):
        if data.IsA(part):
            count, get = getattr(data, f"GetNumberOf{kind}s"), getattr(data, f"Get{kind}")
            return [leaf for i in range(count()) for leaf in leaves(get(i))]
    return [data]


def check(condition, words):
    if not condition:
        sys.exit("check_in_paraview.py: " + words)


def check_reader(reader, name, frames):
    times = list(reader.TimestepValues)
    check(len(times) == frames, f"{name}: {len(times)} time steps, not {frames}")
    check(all(abs(time - 0.01 * i) < 1e-12 for i, time in enumerate(times)), f"{name}: times {times[:3]} …")
    reader.UpdatePipeline(times[-1])
    grids = sorted(leaves(servermanager.Fetch(reader)), key=lambda grid: grid.GetNumberOfPoints())
    check([grid.GetNumberOfPoints() for grid in grids] == [3, 5], f"{name}: points of the grids")
    # Vertex 0 of the cage lies at the origin at rest and moves by 1 mm a tick along each axis; a frame is 10 ticks.
    moved = 0.001 * 10 * (frames - 1)
    check(all(abs(x - moved) < 1e-12 for x in grids[1].GetPoint(0)), f"{name}: place {grids[1].GetPoint(0)}")
    saturation = grids[1].GetCellData().GetArray("saturation").GetRange()
    check(saturation == (0.25, 0.75), f"{name}: saturation {saturation}")


def main():
    file, frames = sys.argv[1], int(sys.argv[2])
    check_reader(simple.XDMFReader(FileNames=[file]), "XDMFReader", frames)
    check_reader(simple.Xdmf3ReaderS(FileName=[file]), "Xdmf3ReaderS", frames)
    check_reader(simple.Xdmf3ReaderT(FileName=[file]), "Xdmf3ReaderT", frames)


if __name__ == "__main__":
    main()
