#!/usr/bin/python3
"""Seeds for the fuzzers from real files: scenarios, traces, small meshes in every format. Usage: fuzz_seeds.py FOLDER"""
import struct
import sys
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TETS = [(0, 1, 2, 3), (1, 4, 2, 3)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def lines(rows):
    return "".join(" ".join(map(str, row)) + "\n" for row in rows)


def tet_files():
    """By the order of the fuzzer's endings: .msh .mesh .node .vtk .vtu .veg"""
    numbered = [(i + 1, *p) for i, p in enumerate(POINTS)]
    one = [tuple(v + 1 for v in tet) for tet in TETS]
    yield 0, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n" + lines(numbered) + "$EndNodes\n$Elements\n2\n" + \
        lines((i + 1, 4, 2, 1, 1, *t) for i, t in enumerate(one)) + "$EndElements\n"
    yield 0, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n" + lines(POINTS) + \
        "$EndNodes\n$Elements\n1 2 1 2\n3 1 4 2\n" + lines((i + 1, *t) for i, t in enumerate(one)) + "$EndElements\n"
    yield 1, "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n" + lines((*p, 0) for p in POINTS) + "Tetrahedra\n2\n" + \
        lines((*t, 1) for t in one) + "End\n"
    yield 2, "5 3 0 0\n" + lines(numbered)
    head = "# vtk DataFile Version 3.0\nx\n{}\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
    yield 3, head.format("ASCII") + lines(POINTS) + "CELLS 2 10\n" + lines((4, *t) for t in TETS) + \
        "CELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS a double 1\nLOOKUP_TABLE default\n0.5\n1\n"
    yield 3, head.format("BINARY").encode() + b"".join(struct.pack(">3d", *p) for p in POINTS) + b"\nCELLS 2 10\n" + \
        b"".join(struct.pack(">5i", 4, *t) for t in TETS) + b"\nCELL_TYPES 2\n" + struct.pack(">2i", 10, 10)
    yield 4, '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>' \
        '<Piece NumberOfPoints="5" NumberOfCells="2"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">' + \
        lines(POINTS) + '</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity" format="ascii">' + lines(TETS) + \
        '</DataArray><DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>' \
        '<DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>'
    yield 5, "*VERTICES\n5 3 0 0\n" + lines(numbered) + "*ELEMENTS\nTET\n2 4 0\n" + lines((i + 1, *t) for i, t in enumerate(one))


def surface_files():
    """.obj .stl .ply"""
    yield 0, lines(("v", *p) for p in POINTS[:4]) + lines(("f", *(v + 1 for v in f)) for f in FACES)
    yield 1, "solid x\n" + "".join("facet normal 0 0 0\nouter loop\n" + lines(("vertex", *POINTS[v]) for v in f) +
                                    "endloop\nendfacet\n" for f in FACES) + "endsolid x\n"
    yield 1, bytes(80) + struct.pack("<I", 4) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(c for v in f for c in POINTS[v]), 0) for f in FACES)
    head = "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n" \
           "property list uchar int vertex_indices\nend_header\n"
    yield 2, head.format("ascii") + lines(POINTS[:4]) + lines((3, *f) for f in FACES)
    for name, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        yield 2, head.format(name).encode() + b"".join(struct.pack(order + "3f", *p) for p in POINTS[:4]) + \
            b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)


def main():
    folder = Path(sys.argv[1])
    seeds = {"tets": [], "surface": [], "scenario": [], "trace": [], "queries": [], "points": []}
    for name, files in (("tets", tet_files()), ("surface", surface_files())):
        seeds[name] = [bytes([ending]) + (text if isinstance(text, bytes) else text.encode()) for ending, text in files]
    seeds["scenario"] = [file.read_bytes() for file in sorted(ROOT.glob("scenarios/*.json")) + [ROOT / "tests/golden/ball.json"]]
    seeds["trace"] = [b"".join(file.read_bytes().splitlines(True)[:20]) for file in sorted(ROOT.glob("traces/*.csv"))]
    seeds["queries"] = [b"0,1,1,2,-3,4\n" * 8, b"1,3,1,2,5,7,1\n" * 16]
    seeds["points"] = [b'{"index":0,"id":"a","scenario":"s.json","settings":{"/a/b":1}}\n'
                       b'{"index":1,"id":"b","scenario":"s.json","settings":{"/a/b":"x"}}\n']
    for name, contents in seeds.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        for content in contents:
            (folder / name / f"{zlib.crc32(content):08x}").write_bytes(content)


if __name__ == "__main__":
    main()
