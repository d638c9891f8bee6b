# Reads a VTKHDF file with VTK's own reader and prints what it finds: the number of points of the grid, then for each
# array of the points its name, components and the sum of what is finite in double precision.
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

reader = vtkHDFReader()
if not reader.CanReadFile(sys.argv[1]):
    sys.exit("VTK cannot read it")
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
print(grid.GetNumberOfPoints(), grid.GetNumberOfCells())
points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
print("Points", points.shape[1], repr(float(np.nansum(points))))
data = grid.GetPointData()
for k in range(data.GetNumberOfArrays()):
    values = vtk_to_numpy(data.GetArray(k)).astype(float)
    print(data.GetArrayName(k), 1 if values.ndim == 1 else values.shape[1], repr(float(np.nansum(values))))
