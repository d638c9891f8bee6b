# Reads a VTKHDF file with VTK's own reader, all its steps, and prints what it finds: the number of points and cells over the
# steps and the number of steps (VTK before 9.3 knows none: it shows everything as one), then for each array of the points its
# name, components and the sum, over the steps, of what is finite in double precision.
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

reader = vtkHDFReader()
if not reader.CanReadFile(sys.argv[1]):
    sys.exit("VTK cannot read it")
reader.SetFileName(sys.argv[1])
reader.UpdateInformation()
times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or [None]
points, cells, sums = 0, 0, {}


def add(name, array):
    values = vtk_to_numpy(array).astype(float)
    components, total = sums.get(name, (1 if values.ndim == 1 else values.shape[1], 0.0))
    sums[name] = (components, total + float(np.nansum(values)))


for time in times:
    if time is None:
        reader.Update()
    else:
        reader.UpdateTimeStep(time)
    grid = reader.GetOutput()
    points += grid.GetNumberOfPoints()
    cells += grid.GetNumberOfCells()
    add("Points", grid.GetPoints().GetData())
    data = grid.GetPointData()
    for k in range(data.GetNumberOfArrays()):
        add(data.GetArrayName(k), data.GetArray(k))
print(points, cells, len(times))
for name, (components, total) in sums.items():
    print(name, components, repr(total))
