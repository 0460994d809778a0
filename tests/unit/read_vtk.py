#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what VTK itself reads from a .vtp, .pvd or .vtkhdf file: one line 'name value value ...' per array.

A .pvd file is a list of .vtp files with times: each is printed after a line 'file PATH TIME'. So is each step of a
.vtkhdf file, without a path. Where VTK is older than 9.3 it knows no such file, and the exit code is 77.
"""
import os
import sys
import xml.etree.ElementTree

from vtkmodules.vtkCommonCore import vtkCommand, vtkVersion
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
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
    for kind, array in (("connectivity", cells.GetConnectivityArray()), ("offsets", cells.GetOffsetsArray())):
        show(f"{name}/{kind}", [int(array.GetComponent(k, 0)) for k in range(array.GetNumberOfTuples())])


def opened(reader, path, errors):
    reader.AddObserver(vtkCommand.ErrorEvent, lambda *_: errors.append(path))
    reader.SetFileName(path)
    if not reader.CanReadFile(path):
        sys.exit(f"{path}: VTK cannot read it")
    return reader


def require_no_error(reader, path, errors):
    if errors or reader.GetErrorCode() != 0:
        sys.exit(f"{path}: VTK met an error")


def show_file(path):
    errors = []
    reader = opened(vtkXMLPolyDataReader(), path, errors)
    reader.Update()
    require_no_error(reader, path, errors)
    show_polydata(reader.GetOutput())


def show_steps(path):
    if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) < (9, 3):
        sys.exit(77)
    errors = []
    reader = opened(vtkHDFReader(), path, errors)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    for time in times:
        reader.UpdateTimeStep(time)
        require_no_error(reader, path, errors)
        show("file", [time])
        data = reader.GetOutputDataObject(0)
        data.GetFieldData().RemoveArray("Time")  # VTK 9.3 adds what TimeValue says already
        show_polydata(data)


def show_polydata(data):
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
    if path.endswith(".vtkhdf"):
        show_steps(path)
        return
    if not path.endswith(".pvd"):
        show_file(path)
        return
    for entry in xml.etree.ElementTree.parse(path).getroot().iter("DataSet"):
        show("file", [entry.get("file"), float(entry.get("timestep"))])
        show_file(os.path.join(os.path.dirname(path), entry.get("file")))


main(sys.argv[1])
