# Reads a .pvd collection with VTK's own reader of its .vtu files and prints, for each time: the time, the numbers of points and of
# vertices, then the sums of what is finite of each array of the points.
import os
import sys
import xml.etree.ElementTree

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

folder = os.path.dirname(sys.argv[1])
for entry in xml.etree.ElementTree.parse(sys.argv[1]).getroot().iter("DataSet"):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(os.path.join(folder, entry.get("file")))
    reader.Update()
    grid = reader.GetOutput()
    vertices = sum(grid.GetCellType(k) == 1 for k in range(grid.GetNumberOfCells()))
    data = grid.GetPointData()
    sums = [("Points", vtk_to_numpy(grid.GetPoints().GetData()))] + [(data.GetArrayName(k), vtk_to_numpy(data.GetArray(k))) for k in range(data.GetNumberOfArrays())]
    print(entry.get("timestep"), grid.GetNumberOfPoints(), vertices, len(sums), *(f"{name} {float(np.nansum(values.astype(float)))!r}" for name, values in sums))
