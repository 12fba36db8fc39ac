"""Reads the run of records.h with h5py and the XDMF beside it with an XML parser, as a user's script would.

Usage: check_result.py RESULT.h5 RESULT.xdmf TICKS. Exit code 0 when all is as the format's description says.
Nothing here is shared with the writer: names, shapes and values are spelled out again.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

HAPTIC = {
    "tick": ((), "<i8", "1"), "time": ((), "<f8", "s"), "tool_position": ((3,), "<f8", "m"),
    "tool_orientation": ((4,), "<f8", "1"), "force": ((3,), "<f8", "N"), "torque": ((3,), "<f8", "N m"),
    "device_force": ((3,), "<f8", "N"), "mode": ((), "|u1", "1"), "force_age": ((), "<i4", "1"),
    "num_contacts": ((), "<i4", "1"), "gate_events": ((), "|u1", "1"),
    "port_energy": ((), "<f8", "J"), "passivity_energy": ((), "<f8", "J"),
    "force_error": ((), "<f8", "N"), "force_error_parts": ((5,), "<f8", "N"),
}
PHYSICS = {
    "tick": ("<i8", "1"), "time": ("<f8", "s"), "kinetic_energy": ("<f8", "J"), "elastic_energy": ("<f8", "J"),
    "plastic_dissipation": ("<f8", "J"), "contact_work": ("<f8", "J"), "water_mass": ("<f8", "kg"),
    "water_added": ("<f8", "kg"), "water_removed": ("<f8", "kg"), "newton_iterations": ("<i4", "1"),
    "iterations": ("<i4", "1"),
    "factorisations": ("<i4", "1"), "residual": ("<f8", "1"), "active_nodes": ("<i4", "1"),
    "min_volume_ratio": ("<f8", "1"), "max_plastic_strain": ("<f8", "1"), "limited_tets": ("<i4", "1"), "limited_tet": ("<i4", "1"), "epoch": ("<i4", "1"),
}
FRAME_UNITS = {
    "position": "m", "saturation": "1", "plastic_strain": "1", "plastic_strain_norm": "1", "skin_position": "m",
    "skin_saturation": "1", "skin_influence": "1",
}


def text(value):
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def check(condition, words):
    if not condition:
        raise SystemExit("check_result.py: " + words)


def same(values, wanted, words):
    values = np.asarray(values)
    wanted = np.asarray(wanted)
    check(values.shape == wanted.shape and np.array_equal(values, wanted), f"{words}: {values} is not {wanted}")


def check_root(file):
    check(text(file.attrs["format"]) == "argil-result", "format")
    check(file.attrs["format_version"] == 1 and file.attrs["complete"] == 1, "version or complete")
    check(text(file.attrs["outcome"]) == "done" and file.attrs["haptic_period_s"] == 0.001, "outcome or period")
    check(set(file) == {"haptic", "physics", "mesh", "frames", "provenance", "timing"}, f"groups {set(file)}")

    def labelled(name, item):
        if isinstance(item, h5py.Dataset):
            check(text(item.attrs["units"]) != "" and len(text(item.attrs["about"])) > 5, f"{name} has no label")
        # A time in a file makes two equal runs differ.
        check(h5py.h5g.get_objinfo(file.id, name.encode()).mtime == 0, f"{name} has a modification time")

    file.visititems(labelled)


def check_series(file, ticks):
    t = np.arange(ticks, dtype=float)
    haptic = file["haptic"]
    check(set(haptic) == set(HAPTIC), f"/haptic holds {set(haptic)}")
    for name, (row, kind, units) in HAPTIC.items():
        data = haptic[name]
        check(data.shape == (ticks, *row) and data.dtype.str == kind, f"{name}: {data.shape} {data.dtype}")
        check(text(data.attrs["units"]) == units, f"units of {name}")
    same(haptic["tick"], np.arange(ticks), "tick")
    same(haptic["time"], t * 0.001, "time")
    same(haptic["tool_position"], np.stack([t, t + 0.25, -t], axis=1), "tool_position")
    same(haptic["tool_orientation"], np.tile([0.5, -0.5, 0.5, 0.5], (ticks, 1)), "tool_orientation x y z w")
    same(haptic["force"], np.stack([1 / (t + 3), 0 * t + 2, 3 * t], axis=1), "force")
    same(haptic["device_force"], np.stack([0 * t, 0 * t, 0.5 * t], axis=1), "device_force")
    same(haptic["mode"], np.arange(ticks) % 4, "mode")
    same(haptic["force_age"], np.arange(ticks) % 14, "force_age")
    same(haptic["num_contacts"], np.arange(ticks) % 7, "num_contacts")
    same(haptic["gate_events"], np.arange(ticks) % 16, "gate_events")
    same(haptic["port_energy"], 7.0 - t, "port_energy")
    same(haptic["passivity_energy"], 8.0 + t, "passivity_energy")
    parts = np.stack([0.5 * t, 0 * t + 0.25, -0.125 * t, 0 * t + 2, 0 * t + 0.0625], axis=1)
    same(haptic["force_error_parts"], parts, "force_error_parts")
    same(haptic["force_error"], 0.375 * t + 2.3125, "force_error")  # exact in binary

    physics = file["physics"]
    check(set(physics) == set(PHYSICS), f"/physics holds {set(physics)}")
    steps = np.arange(0, ticks, 2)
    for name, (kind, units) in PHYSICS.items():
        data = physics[name]
        check(data.shape == steps.shape and data.dtype.str == kind, f"{name}: {data.shape} {data.dtype}")
        check(text(data.attrs["units"]) == units, f"units of {name}")
    same(physics["tick"], steps, "physics tick")
    names = ["kinetic_energy", "elastic_energy", "plastic_dissipation", "contact_work", "water_mass", "water_added",
             "water_removed"]
    for offset, name in enumerate(names, start=1):
        same(physics[name], steps + float(offset), name)


def check_mesh_and_frames(file, ticks):
    mesh = file["mesh"]
    check(set(mesh) == {"rest_position", "tets", "surface_triangles", "skin_triangles", "tool_vertices",
                        "tool_triangles"}, f"/mesh holds {set(mesh)}")
    rest = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
    same(mesh["rest_position"], rest, "rest_position")
    same(mesh["tets"], [[0, 1, 2, 3], [1, 2, 3, 4]], "tets")
    same(mesh["surface_triangles"], [[0, 2, 1], [1, 2, 4]], "surface_triangles")
    same(mesh["skin_triangles"], [[0, 1, 2]], "skin_triangles")
    same(mesh["tool_vertices"], 0.01 * np.eye(3), "tool_vertices")
    frames = file["frames"]
    check(list(frames) == [f"{i:06d}" for i in range(len(range(0, ticks, 10)))], f"/frames holds {list(frames)}")
    for number, frame in enumerate(frames.values()):
        tick = 10 * number
        check(frame.attrs["tick"] == tick and frame.attrs["time"] == tick * 0.001, f"time of frame {number}")
        check(text(frame.attrs["state_hash"]) == "a" * 60 + str(1000 + tick), f"hash of frame {number}")
        check({name: text(data.attrs["units"]) for name, data in frame.items()} == FRAME_UNITS, "frame datasets")
        same(frame["position"], rest + 0.001 * tick, "position")
        same(frame["saturation"], [0.25, 0.75], "saturation")
        same(frame["plastic_strain"], [[1, 2, 2, 4, 4, 8], [0, 0, 0, 0, 3, 4]], "plastic_strain")
        same(frame["plastic_strain_norm"], [np.sqrt(105.0), 5.0], "plastic_strain_norm")
        same(frame["skin_position"], tick * np.eye(3), "skin_position")
        check(frame["skin_influence"].shape == (3,), "skin_influence")
    check(text(file["provenance/scenario"][()]) == '{"about": "ε"}', "provenance/scenario")


def check_item(item, folder, file):
    name, path = item.text.split(":")
    check(os.path.samefile(os.path.join(folder, name), file.filename), f"XDMF names {name}")
    data = file[path]
    check(tuple(int(n) for n in item.get("Dimensions").split()) == data.shape, f"XDMF dimensions of {path}")
    kind = {"Float": "f", "Int": "i"}[item.get("NumberType")] + item.get("Precision")
    check(data.dtype.str == "<" + kind, f"XDMF type of {path}")
    check(item.get("Format") == "HDF" and item.get("ItemType") in (None, "Uniform"), f"XDMF item {path}")
    return data


def check_xdmf(name, file):
    domain = ElementTree.parse(name).getroot().find("Domain")
    folder = os.path.dirname(os.path.abspath(name))
    wanted = {"cage": ("Tetrahedron", 4, {"saturation": "Cell", "plastic_strain_norm": "Cell"}),
              "skin": ("Triangle", 3, {"saturation": "Node", "influence": "Node"})}
    check([grid.get("Name") for grid in domain] == list(wanted), "XDMF collections")
    for collection in domain:
        check(collection.get("CollectionType") == "Temporal", "XDMF collection type")
        shape, corners, attributes = wanted[collection.get("Name")]
        times = [float(grid.find("Time").get("Value")) for grid in collection]
        same(times, [frame.attrs["time"] for frame in file["frames"].values()], "XDMF times")
        for grid in collection:
            topology = grid.find("Topology")
            elements = check_item(topology.find("DataItem"), folder, file)
            check(topology.get("TopologyType") == shape and elements.shape[1] == corners, "XDMF topology")
            check(int(topology.get("NumberOfElements")) == elements.shape[0], "XDMF number of elements")
            points = check_item(grid.find("Geometry/DataItem"), folder, file)
            check(elements[()].max() < points.shape[0], "XDMF vertex numbers")
            found = {}
            for attribute in grid.findall("Attribute"):
                data = check_item(attribute.find("DataItem"), folder, file)
                found[attribute.get("Name")] = attribute.get("Center")
                places = elements.shape[0] if attribute.get("Center") == "Cell" else points.shape[0]
                check(data.shape[0] == places, f"XDMF length of {attribute.get('Name')}")
            check(found == attributes, f"XDMF attributes {found}")


def main():
    result, xdmf, ticks = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with h5py.File(result, "r") as file:
        check_root(file)
        check_series(file, ticks)
        check_mesh_and_frames(file, ticks)
        check_xdmf(xdmf, file)


if __name__ == "__main__":
    main()
