#!/usr/bin/python3
"""Seeds for the fuzzers, a folder for each reader: small meshes in every format and encoding, the project's own scenarios,
motions, studies and sweeps, and what is small or can be cut off among public files.

Usage: fuzz_seeds.py FOLDER [PUBLIC_FILES]
"""
import base64
import json
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


def packed_vtu(is_packed):
    """Numbers in base64, or packed by zlib and appended raw."""
    arrays = {"p": struct.pack("<15d", *(c for p in POINTS for c in p)), "connectivity": struct.pack("<8i", *TETS[0], *TETS[1]),
              "offsets": struct.pack("<2i", 4, 8), "types": bytes([10, 10]), "E": struct.pack("<2f", 1, 2)}
    types = {"p": "Float64", "types": "UInt8", "E": "Float32"}
    texts, appended = {}, b""
    for name, numbers in arrays.items():
        tag = f'<DataArray type="{types.get(name, "Int32")}" Name="{name}" NumberOfComponents="{3 if name == "p" else 1}" '
        if is_packed:
            small = zlib.compress(numbers)
            texts[name] = tag + f'format="appended" offset="{len(appended)}"/>'
            appended += struct.pack("<4I", 1, len(numbers), 0, len(small)) + small
        else:
            block = base64.b64encode(struct.pack("<I", len(numbers)) + numbers).decode()
            texts[name] = tag + f'format="binary">{block}</DataArray>'
    compressor = ' compressor="vtkZLibDataCompressor"' if is_packed else ""
    text = f'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian"{compressor}><UnstructuredGrid><Piece NumberOfPoints="5" ' \
        f'NumberOfCells="2"><Points>{texts["p"]}</Points><Cells>{texts["connectivity"]}{texts["offsets"]}{texts["types"]}</Cells>' \
        f'<CellData>{texts["E"]}</CellData></Piece></UnstructuredGrid>'
    tail = b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>" if is_packed else b""
    return text.encode() + tail + b"</VTKFile>"


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
    yield 2, "5 3 0 0\n" + lines(numbered) + "\x1e2 4 1\n" + lines((i + 1, *t, 0.5) for i, t in enumerate(one))
    head = "# vtk DataFile Version 3.0\nx\n{}\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
    yield 3, head.format("ASCII") + lines(POINTS) + "CELLS 2 10\n" + lines((4, *t) for t in TETS) + \
        "CELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS a double 1\nLOOKUP_TABLE default\n0.5\n1\n"
    yield 3, head.format("BINARY").encode() + b"".join(struct.pack(">3d", *p) for p in POINTS) + b"\nCELLS 2 10\n" + \
        b"".join(struct.pack(">5i", 4, *t) for t in TETS) + b"\nCELL_TYPES 2\n" + struct.pack(">2i", 10, 10)
    yield 3, head.format("ASCII").replace("3.0", "5.1") + lines(POINTS) + "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\n" \
        "CONNECTIVITY vtktypeint64\n" + lines(TETS) + "CELL_TYPES 2\n10\n10\nCELL_DATA 2\nFIELD f 1\nE 1 2 float\n1 2\n"
    yield 0, b"$MeshFormat\n2.2 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n5\n" + b"".join(
        struct.pack("<i3d", i + 1, *p) for i, p in enumerate(POINTS)) + b"\n$EndNodes\n$Elements\n2\n" + \
        struct.pack("<3i", 4, 2, 0) + b"".join(struct.pack("<5i", i + 1, *t) for i, t in enumerate(one)) + b"\n$EndElements\n"
    for packed in (True, False):
        yield 4, packed_vtu(packed)
    yield 4, '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>' \
        '<Piece NumberOfPoints="5" NumberOfCells="2"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">' + \
        lines(POINTS) + '</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity" format="ascii">' + lines(TETS) + \
        '</DataArray><DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>' \
        '<DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>'
    yield 5, "*VERTICES\n5 3 0 0\n" + lines(numbered) + "*ELEMENTS\nTET\n2 4 0\n" + lines((i + 1, *t) for i, t in enumerate(one))


def surface_files():
    """.obj .stl .ply .off"""
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
    yield 3, "OFF\n4 4 6\n" + lines(POINTS[:4]) + lines((3, *f) for f in FACES)


def json_files(pattern):
    return [file.read_bytes() for file in sorted(ROOT.glob(pattern))]


def head(file, size=4000):
    """Whole lines from the beginning of a file."""
    text = file.read_bytes()[:size]
    return text[:text.rfind(b"\n") + 1]


def shared_files(shared):
    """Small public files and beginnings of larger ones, by reader."""
    endings = {"tets": [".msh", ".mesh", ".node", ".vtk", ".vtu", ".veg"], "surfaces": [".obj", ".stl", ".ply", ".off"]}
    for name, folder in (("tets", "tets"), ("surfaces", "surface")):
        for file in sorted((shared / folder).glob("*")):
            if file.suffix in endings[name] and file.stat().st_size < 8000:
                yield name, bytes([endings[name].index(file.suffix)]) + file.read_bytes()
    for file in sorted((shared / "traces").glob("*.csv")):
        yield "traces", head(file)
    for file in sorted((shared / "ccd").glob("*/*/*.csv")):
        yield "queries", b"".join(file.read_bytes().splitlines(True)[:16])


def hdf5_traces():
    """Records of tests/fuzz/hdf5_input.h: a trace with everything in it, the motion of a result, and sizes past all bounds."""
    def record(place, kind, layout, lengths, data):
        return bytes([place, kind, layout, len(lengths), *lengths, len(data)]) + data

    times = struct.pack("<3d", 0, 0.001, 0.002)
    points = struct.pack("<9d", *(0.01 * i for i in range(9)))
    turns = struct.pack("<4d", 0, 0, 0, 1)
    yield record(0, 1, 0, [3], times) + record(1, 1, 1, [3, 3], points) + record(2, 1, 2, [3, 4], turns) + \
        record(3, 4, 0, [3], bytes([0, 16, 32])) + record(8, 5, 0, [], b"mm") + record(10, 6, 0, [], b"hand") + \
        record(11, 1, 0, [], struct.pack("<d", 2)) + record(12, 1, 0, [4], turns) + record(13, 1, 0, [3], times)
    yield record(4, 1, 1, [3], times) + record(5, 1, 1, [3, 3], points) + record(6, 1, 0, [3, 4], turns)
    yield record(0, 1, 1, [240], b"") + record(1, 1, 1, [240, 3], b"") + record(14, 1, 3, [], b"/")


def own_files():
    for name, files in (("tets", tet_files()), ("surfaces", surface_files())):
        for ending, text in files:
            yield name, bytes([ending]) + (text if isinstance(text, bytes) else text.encode())
    for text in json_files("scenarios/*.json") + json_files("scenarios/failures/*.json") + json_files("tests/golden/ball.json"):
        yield "scenarios", text
    for file in sorted(ROOT.glob("traces/*.csv")):
        yield "traces", head(file)
    yield "traces", b"Time [ms];X_mm;Y_mm;Z_mm;rx;ry;rz;button\n" + b"".join(b"%d;1,5;-2;%d;90;0;4,5;%d\n" % (i, i // 4, i % 2) for i in range(40))
    yield "traces", b"# t x y z q0 q1 q2 q3\n" + b"".join(b"%d.%03d 0.1 0 0.2 1 0 0 0\n" % (1700000000, i * (1 + i // 20)) for i in range(30))
    for order in ("False", "True"):
        header = ("{'descr': '<f8', 'fortran_order': %s, 'shape': (4, 8), }" % order).encode().ljust(117) + b"\n"
        yield "traces", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + struct.pack("<32d", *(0.01 * i for i in range(32)))
    yield "traces", b"time,x,y,z\nms,mm,mm,mm\n0,1,2,3\n1,1,2,3\n"
    yield "traces", b"time\tx\ty\tz\n2024-02-29T23:59:59.5+01:00\t0\t0\t1\n2024/03/01 00:00:00.25\t0\t0\t1\n"
    for records in hdf5_traces():
        yield "hdf5", records
    yield "queries", b"0,1,1,2,-3,4\n" * 8
    yield "queries", b"1,3,1,2,5,7,1\n" * 16
    device = {"device_id": "049D", "config": {"type": "inverse3"}, "state": {"cursor_position": {"x": 0.1, "y": -2e-3, "z": 0}}}
    turn = {"x": 0, "y": 0, "z": 0.6, "w": 0.8}
    for grip in ({"verse_grip": [{"device_id": "1", "state": {"button": True, "orientation": turn}}]},
                 {"wireless_verse_grip": [{"device_id": "2", "state": {"buttons": {"a": True, "b": False}, "orientation": turn}}]}):
        yield "messages", json.dumps({"session_id": 7, "inverse3": [device], **grip}).encode()
    yield "points", b"".join(b'{"index":%d,"id":"a1","scenario":"s.json","settings":{"/a/b":%s}}\n' % (i, value)
                             for i, value in enumerate((b"1", b'"x"', b"[1,2.5e-3,null]", b'{"k":true}')))
    for text in json_files("scenarios/sweeps/*.sweep.json"):
        yield "sweeps", text
    yield "sweeps", json.dumps({"scenario": "s.json", "zip": {"/a": [1, 2], "/b": ["x", True]}, "list": [{}, {"/c": 1}],
                                "sample": {"method": "halton", "count": 3, "seed": 1, "axes": {"/d": [0, 1], "/e": [1, 2]}}}).encode()
    for kind, pattern in enumerate(("scenarios/studies/chart*.json", "scenarios/studies/map*.json", "tests/golden/[en]*.json")):
        for text in json_files(pattern):
            yield "studies", bytes([kind]) + text


def main():
    folder = Path(sys.argv[1])
    shared = Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT.parent / "shared" / "data"
    for name, content in [*own_files(), *shared_files(shared)]:
        (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / name / f"{zlib.crc32(content):08x}").write_bytes(content)


if __name__ == "__main__":
    main()
