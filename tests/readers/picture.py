# SPDX-License-Identifier: MIT
"""Draws a recording as VTK sees it, off-screen: picture.py RUN.h5 OUT.png [STEP]. Surfaces of /VTKHDF in their colours, contacts
as red arrows along their forces. VTK 9.5 or later."""
import os
import sys

# without a display VTK 9.5 and later draw through EGL
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkGlyph3D
from vtkmodules.vtkFiltersSources import vtkArrowSource, vtkSphereSource
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the back end)


def parts(data):
    """Name and PolyData of each part."""
    if data.GetClassName() == "vtkPolyData":
        return {"bodies": data}
    found = {}
    for k in range(data.GetNumberOfPartitionedDataSets()):
        name = data.GetMetaData(k).Get(data.NAME()) if data.HasMetaData(k) else str(k)
        found[name] = data.GetPartition(k, 0)
    return found


def actor_of(algorithm_or_data, colour=None):
    mapper, actor = vtkPolyDataMapper(), vtkActor()
    if hasattr(algorithm_or_data, "GetOutputPort"):
        mapper.SetInputConnection(algorithm_or_data.GetOutputPort())
    else:
        mapper.SetInputData(algorithm_or_data)
    if colour:
        mapper.ScalarVisibilityOff()
        actor.GetProperty().SetColor(*colour)
    else:
        mapper.SetScalarModeToUseCellFieldData()
        mapper.SelectColorArray("color")
        mapper.SetColorModeToDirectScalars()
    actor.SetMapper(mapper)
    return actor


def arrows(contacts, length):
    """Arrows from the points of contacts along their forces, the largest of this length."""
    forces = contacts.GetPointData().GetArray("force")
    most = max(sum(c * c for c in forces.GetTuple(k))**0.5 for k in range(forces.GetNumberOfTuples()))
    contacts.GetPointData().SetActiveVectors("force")
    arrow, glyph = vtkArrowSource(), vtkGlyph3D()
    glyph.SetSourceConnection(arrow.GetOutputPort())
    glyph.SetInputData(contacts)
    glyph.SetVectorModeToUseVector()
    glyph.SetScaleModeToScaleByVector()
    glyph.SetScaleFactor(length / most if most > 0 else 0)
    return glyph


def main():
    reader = vtkHDFReader()
    reader.SetFileName(sys.argv[1])
    reader.UpdateInformation()
    reader.SetStep(int(sys.argv[3]) if len(sys.argv) > 3 else reader.GetNumberOfSteps() // 2)
    reader.Update()
    found = parts(reader.GetOutputDataObject(0))
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.SetBackground(1, 1, 1)
    for name in ("surfaces", "statics"):
        if name in found:
            renderer.AddActor(actor_of(found[name]))
    contacts = found.get("contacts")
    if contacts and contacts.GetNumberOfPoints():
        low_high = found["bodies"].GetBounds()
        renderer.AddActor(actor_of(arrows(contacts, 0.25 * max(low_high[k + 1] - low_high[k] for k in (0, 2, 4))), (1, 0, 0)))
    if "surfaces" not in found:
        ball = vtkSphereSource()
        glyph = vtkGlyph3D()
        found["bodies"].GetPointData().SetActiveScalars("radius")
        glyph.SetSourceConnection(ball.GetOutputPort())
        glyph.SetInputData(found["bodies"])
        glyph.SetScaleFactor(2)
        renderer.AddActor(actor_of(glyph, (0.4, 0.5, 0.8)))
    window.SetOffScreenRendering(1)
    window.SetSize(960, 600)
    window.AddRenderer(renderer)
    bounds = found["bodies"].GetBounds()
    middle = [(bounds[k] + bounds[k + 1]) / 2 for k in (0, 2, 4)]
    far = max(bounds[k + 1] - bounds[k] for k in (0, 2, 4)) + 1e-3
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*middle)
    camera.SetPosition(middle[0] + 0.5 * far, middle[1] - 1.6 * far, middle[2] + 1.0 * far)
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCameraClippingRange()
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.Update()
    pixels = image.GetOutput().GetPointData().GetScalars()
    seen = {pixels.GetTuple(k) for k in range(0, pixels.GetNumberOfTuples(), 97)}
    assert len(seen) > 20, f"a picture of {len(seen)} colours: nothing is seen"
    writer = vtkPNGWriter()
    writer.SetFileName(sys.argv[2])
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    print(f"VTK {vtkVersion.GetVTKVersion()}, {window.GetClassName()}: {', '.join(found)}; {os.path.getsize(sys.argv[2])} bytes")
    for name, data in found.items():
        print(f"  {name}: {data.GetNumberOfPoints()} points, {data.GetNumberOfCells()} cells")


if __name__ == "__main__":
    main()
