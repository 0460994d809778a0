#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what VTK itself reads from a .vtp or .pvd file: one line 'name value value ...' per array.

A .pvd file is a list of .vtp files with times: each is printed after a line 'file PATH TIME'.
"""
import os
import sys
import xml.etree.ElementTree

from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader


def values(array):
    return [
        repr(array.GetComponent(row, column))
        for row in range(array.GetNumberOfTuples())
        for column in range(array.GetNumberOfComponents())
    ]


def show(name, entries):
    print(" ".join([name, *map(str, entries)]))


def show_cells(name, cells):
    connectivity, offsets = cells.GetConnectivityArray(), cells.GetOffsetsArray()
    show(name + "/connectivity", [connectivity.GetValue(k) for k in range(connectivity.GetNumberOfValues())])
    show(name + "/offsets", [offsets.GetValue(k) for k in range(offsets.GetNumberOfValues())])


def show_polydata(path):
    errors = []
    reader = vtkXMLPolyDataReader()
    reader.AddObserver(vtkCommand.ErrorEvent, lambda *_: errors.append(path))
    reader.SetFileName(path)
    if not reader.CanReadFile(path):
        sys.exit(f"{path}: VTK cannot read it")
    reader.Update()
    if errors or reader.GetErrorCode() != 0:
        sys.exit(f"{path}: VTK met an error")
    data = reader.GetOutput()
    show("counts", [data.GetNumberOfPoints(), data.GetNumberOfVerts(), data.GetNumberOfLines(), data.GetNumberOfCells()])
    show("types", [data.GetCellType(k) for k in range(data.GetNumberOfCells())])
    if data.GetPoints() is not None:
        show("points", values(data.GetPoints().GetData()))
    show_cells("verts", data.GetVerts())
    show_cells("lines", data.GetLines())
    for kind, arrays in (("field", data.GetFieldData()), ("point", data.GetPointData()), ("cell", data.GetCellData())):
        for k in range(arrays.GetNumberOfArrays()):
            array = arrays.GetArray(k)
            show(f"{kind}/{array.GetName()}", values(array))


def main(path):
    if not path.endswith(".pvd"):
        show_polydata(path)
        return
    for entry in xml.etree.ElementTree.parse(path).getroot().iter("DataSet"):
        show("file", [entry.get("file"), float(entry.get("timestep"))])
        show_polydata(os.path.join(os.path.dirname(path), entry.get("file")))


main(sys.argv[1])
