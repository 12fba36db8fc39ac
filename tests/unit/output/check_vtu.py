"""Reads a series of .vtu files with VTK, and compares it with the result through h5py.

Usage: check_vtu.py RESULT.h5 SERIES.pvd. Exit code 0 when every array has the result's bits.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

# Name in the .vtu → dataset of the frame, for the data of points and of cells.
FIELDS = {"cage": ({}, {"saturation": "saturation", "plastic_strain": "plastic_strain"}),
          "skin": ({"saturation": "skin_saturation", "influence": "skin_influence"}, {})}


def read_grid(file):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(file)
    reader.Update()
    return reader.GetOutput()


def check(condition, words):
    if not condition:
        raise SystemExit("check_vtu.py: " + words)


def check_grid(grid, kind, mesh, frame, first):
    name = "position" if kind == "cage" else "skin_position"
    cells = mesh["tets" if kind == "cage" else "skin_triangles"][:]
    points = vtk_to_numpy(grid.GetPoints().GetData())
    check(np.array_equal(points, frame[name][:]), f"{kind}: other points")
    check(grid.GetNumberOfCells() == len(cells), f"{kind}: other number of cells")
    for number, cell in enumerate(cells):
        ids = grid.GetCell(number).GetPointIds()
        check([ids.GetId(i) for i in range(ids.GetNumberOfIds())] == list(cell), f"{kind}: other cell {number}")
        check(grid.GetCellType(number) == (10 if kind == "cage" else 5), f"{kind}: other type of cell")
    moved = vtk_to_numpy(grid.GetPointData().GetArray("displacement"))
    check(np.array_equal(moved, frame[name][:] - first[name][:]), f"{kind}: other displacement")
    for data, fields in zip((grid.GetPointData(), grid.GetCellData()), FIELDS[kind]):
        for field, dataset in fields.items():
            check(np.array_equal(vtk_to_numpy(data.GetArray(field)), frame[dataset][:]), f"{kind}: other {field}")


def main(result_file, series):
    with h5py.File(result_file) as result:
        frames = [result["frames"][name] for name in sorted(result["frames"])]
        has_skin = len(result["mesh/skin_triangles"]) > 0
        listed = ElementTree.parse(series).getroot().findall("Collection/DataSet")
        check(len(listed) == len(frames) * (2 if has_skin else 1), "other number of files")
        for entry in listed:
            kind = "skin" if entry.get("part") == "1" else "cage"
            frame = next(f for f in frames if f.attrs["time"] == float(entry.get("timestep")))
            grid = read_grid(os.path.join(os.path.dirname(series), entry.get("file")))
            check_grid(grid, kind, result["mesh"], frame, frames[0])


if __name__ == "__main__":
    main(*sys.argv[1:])
