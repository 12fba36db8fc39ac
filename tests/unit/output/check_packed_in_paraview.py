"""Reads a result and its packed copy in ParaView's three readers: the same points, the same fields.

Usage: scripts/pvbatch check_packed_in_paraview.py PLAIN.xdmf PACKED.xdmf TIME. Exit code 0 when nothing differs.
"""
import sys

from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

from check_in_paraview import check, leaves


def read(make, file, time):
    """Of each grid, the smaller first: places, then its fields."""
    reader = make(file)
    reader.UpdatePipeline(time)
    grids = sorted(leaves(servermanager.Fetch(reader)), key=lambda grid: grid.GetNumberOfPoints())
    arrays = []
    for grid in grids:
        arrays.append(vtk_to_numpy(grid.GetPoints().GetData()))
        for data in (grid.GetPointData(), grid.GetCellData()):
            arrays += [vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())]
    return arrays


def main():
    plain, packed, time = sys.argv[1], sys.argv[2], float(sys.argv[3])
    for name, make in (("XDMFReader", lambda file: simple.XDMFReader(FileNames=[file])),
                       ("Xdmf3ReaderS", lambda file: simple.Xdmf3ReaderS(FileName=[file])),
                       ("Xdmf3ReaderT", lambda file: simple.Xdmf3ReaderT(FileName=[file]))):
        a, b = read(make, plain, time), read(make, packed, time)
        check(len(a) == len(b) and len(a) > 4, f"{name}: {len(a)} and {len(b)} arrays")
        check(all((x == y).all() for x, y in zip(a, b)), f"{name}: other values")
        check(sum(x.size for x in a) > 10000 and len(set(a[0].ravel()[:100])) > 10, f"{name}: too few values")


if __name__ == "__main__":
    main()
