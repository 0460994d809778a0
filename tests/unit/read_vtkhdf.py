#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints every step of a temporal PolyData file of VTKHDF 2.0 as read_vtk.py prints the files of a .pvd collection.

It is read with h5py by what the specification says, and whatever that asks for is checked on the way.
"""
import sys

import h5py
import numpy as np

KINDS = ["Vertices", "Lines", "Polygons", "Strips"]
CELL_TYPES = {"Vertices": 1, "Lines": 3}


def show(name, entries):
    print(" ".join([name, *map(repr, np.asarray(entries, dtype=float).ravel().tolist())]))


def show_counts(name, entries):
    print(" ".join([name, *map(str, entries)]))


def check_form(root):
    kind = root.attrs.get_id("Type").get_type()
    assert not kind.is_variable_str() and kind.get_cset() == h5py.h5t.CSET_ASCII
    assert root.attrs["Type"] == b"PolyData"
    assert root.attrs["Version"].tolist() == [2, 0]
    assert root["Points"].shape[1] == 3
    for data in (root["PointData"], root["CellData"]):
        assert all(data.attrs[kind].decode() in data for kind in data.attrs)
        for name, array in data.items():
            assert "/" not in name and "." not in name
            assert array.compression == "gzip" and array.dtype in (np.float64, np.int64)


def offsets_start(root, kind, step):
    """Where the offsets of a step begin: by VTK 9.3, and by the rule of later versions. Both must agree."""
    cells = root["Steps/CellOffsets"][step, KINDS.index(kind)]
    part = root["Steps/PartOffsets"][step]
    passed, met = 0, 0
    for number in root[kind]["NumberOfCells"][:part]:
        if met >= cells:
            break
        passed, met = passed + 1, met + number
    assert passed == part, f"{kind}, step {step}: readers differ"
    return cells + part


def cells_of(root, kind, step):
    part = root["Steps/PartOffsets"][step]
    cells, ids = root[kind]["NumberOfCells"][part], root[kind]["NumberOfConnectivityIds"][part]
    first, start = offsets_start(root, kind, step), root["Steps/ConnectivityIdOffsets"][step, KINDS.index(kind)]
    offsets = root[kind]["Offsets"][first : first + cells + 1]
    assert len(offsets) == cells + 1 and offsets[0] == 0 and offsets[-1] == ids
    return offsets, root[kind]["Connectivity"][start : start + ids]


def show_arrays(root, group, label, step, size):
    assert set(root[f"Steps/{group}Offsets"]) == set(root[group])
    for name, array in root[group].items():
        start = root[f"Steps/{group}Offsets/{name}"][step]
        values = array[start : start + size]
        assert len(values) == size
        show(f"{label}/{name}", values)


def show_step(root, step):
    steps = root["Steps"]
    assert steps["NumberOfParts"][step] == 1
    points = root["NumberOfPoints"][steps["PartOffsets"][step]]
    cells = {kind: cells_of(root, kind, step) for kind in KINDS}
    sizes = {kind: len(offsets) - 1 for kind, (offsets, _) in cells.items()}
    assert sizes["Polygons"] == sizes["Strips"] == 0
    total = sum(sizes.values())
    show("file", [steps["Values"][step]])
    show_counts("counts", [points, sizes["Vertices"], sizes["Lines"], total])
    show_counts("types", [CELL_TYPES[kind] for kind in KINDS for _ in range(sizes[kind])])
    start = steps["PointOffsets"][step]
    show("points", root["Points"][start : start + points])
    for kind, label in (("Vertices", "verts"), ("Lines", "lines")):
        offsets, connectivity = cells[kind]
        show_counts(label + "/connectivity", connectivity)
        show_counts(label + "/offsets", offsets)
    show_arrays(root, "FieldData", "field", step, 1)
    show_arrays(root, "PointData", "point", step, points)
    show_arrays(root, "CellData", "cell", step, total)


def main(path):
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        check_form(root)
        steps = root["Steps"].attrs["NSteps"]
        assert len(root["Steps/Values"]) == len(root["NumberOfPoints"]) == steps
        for step in range(steps):
            show_step(root, step)


main(sys.argv[1])
