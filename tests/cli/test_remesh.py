#!/usr/bin/env python3
"""remesh: cells carried onto another solid; push and pull --through them."""

import math
import os

from cli import (MODELS, Skip, dry_run, fails, icosphere_arrays, independent, innermap, nightly,
                 read_json, run, write_obj)
from scenes import cells_and_map


def test_no_cell_stays_inverted():
    cells_and_map()
    innermap("remesh", "map.ply", "ball.vtu", "-o", "dented.vtu", "--report", "r.json",
             "--picture", "cut.png", "--quiet")
    report = read_json("r.json")
    assert report["remesh"]["inverted_carried"] > 0, report["remesh"]
    assert report["remesh"]["inverted"] == 0, report["remesh"]
    assert report["remesh"]["boundary_vertices_max"] < 2e-3, report["remesh"]
    assert report["cells"]["inverted"] == 0
    assert report["cells"]["least_dihedral"]["least"] > 1, report["cells"]
    assert report["cells"]["least_dihedral"]["one_percent"] > 8, report["cells"]
    assert report["boundary"]["to_surface"]["rms"] < 5e-3, report["boundary"]
    assert os.path.getsize("cut.png") > 1000
    # VTK counts the same, here and at the places that the vertices came from.
    out = independent("""
import sys, vtk
from vtk.util.numpy_support import vtk_to_numpy as n
r = vtk.vtkXMLUnstructuredGridReader(); r.SetFileName(sys.argv[1]); r.Update()
g = r.GetOutput()
import numpy as np
c = n(g.GetCells().GetConnectivityArray()).reshape(-1, 4)
for p in (n(g.GetPoints().GetData()), n(g.GetPointData().GetArray("source"))):
    e = p[c[:, 1:]] - p[c[:, :1]]
    d = np.linalg.det(e)
    print(int((d <= 0).sum()), d.sum() / 6)
""", "dented.vtu")
    (here, _), (there, volume) = [line.split() for line in out.splitlines()]
    assert here == there == "0", out
    assert abs(float(volume) - 4.0 / 3 * math.pi) < 0.1, out


def test_keeps_connectivity_and_brings_back():
    cells_and_map(resolution=16)
    innermap("remesh", "map.ply", "ball.vtu", "-o", "kept.vtu", "--keep-connectivity", "--report",
             "kept.json", "--quiet")
    kept = read_json("kept.json")["remesh"]
    assert kept["inverted"] == kept["swaps"] == kept["collapses"] == 0, kept
    innermap("tetrahedralize", "target.obj", "-o", "target.msh", "--resolution", 20, "--quiet")
    innermap("remesh", "map.ply", "target.msh", "ball.obj", "-o", "back.msh", "--back", "--report",
             "back.json", "--quiet")
    back = read_json("back.json")
    assert back["remesh"]["inverted"] == 0 and back["cells"]["inverted"] == 0, back["remesh"]
    assert back["remesh"]["boundary_vertices_max"] < 2e-3, back["remesh"]


def test_through_agrees_with_the_mesh():
    """Vertices of the mesh, carried as points through it, meet it, and come back."""
    cells_and_map(resolution=16)
    innermap("remesh", "map.ply", "ball.vtu", "-o", "dented.vtu", "--keep-connectivity", "--quiet")
    innermap("push", "map.ply", "ball.vtu", "-o", "pushed.vtu", "--through", "dented.vtu", "--report",
             "push.json", "--quiet")
    geometry = read_json("push.json")["geometry"]
    assert geometry["cells_inverted_after"] == 0, geometry
    innermap("pull", "map.ply", "pushed.vtu", "-o", "back.vtu", "--through", "dented.vtu", "--quiet")
    out = independent("""
import sys, vtk, numpy as np
from vtk.util.numpy_support import vtk_to_numpy as n
def points(f):
    r = vtk.vtkXMLUnstructuredGridReader(); r.SetFileName(f); r.Update()
    return n(r.GetOutput().GetPoints().GetData())
a, b, c, d = map(points, sys.argv[1:])
print(abs(a - b).max(), abs(c - d).max())
""", "dented.vtu", "pushed.vtu", "ball.vtu", "back.vtu")
    assert max(map(float, out.split())) < 1e-6, out
    innermap("voxelize", "ball.obj", "-o", "rest.vdb", "--resolution", 32, "--fog", "--quiet")
    innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--through", "dented.vtu", "--quiet")
    innermap("pull", "map.ply", "posed.vdb", "-o", "again.vdb", "--through", "dented.vtu", "--quiet")
    innermap("push", "map.ply", "rest.vdb", "-o", "x.vdb", "--through", "dented.vtu", "--density",
             "--report", "mass.json", "--quiet")
    mass = read_json("mass.json")["mass"]
    assert abs(mass["density_after"] / mass["density_before"] - 1) < 1e-6, mass
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--through", "ball.vtu", says=["ball.vtu"])


def test_what_does_not_fit_is_said():
    cells_and_map(lambda p: (p[0] * 2, p[1], p[2]), resolution=8)
    vertices, faces = icosphere_arrays(3)
    write_obj("far.obj", [(x + 3, y, z) for x, y, z in vertices], faces)
    innermap("tetrahedralize", "far.obj", "-o", "far.vtu", "--resolution", 8, "--quiet")
    fails(1, "remesh", "map.ply", "far.vtu", "-o", "x.vtu", says=["far.vtu"])
    fails(2, "remesh", "map.ply", "ball.obj", "-o", "x.vtu", says=["ball.obj"])
    fails(2, "remesh", "map.ply", "ball.vtu", "-o", "x.obj", says=["--output"])
    fails(1, "remesh", "map.ply", "ball.vtu", "-o", "x.vtu", "--coarse", 3, says=["--coarse"])
    fails(1, "remesh", "map.ply", "ball.vtu", "-o", "x.vtu", "--max-memory", "50MB",
          says=["50 MB"])
    dry_run("remesh", "map.ply", "ball.vtu", "-o", "x.vtu")


@nightly
def test_homer_onto_spot():
    if not MODELS.is_dir():
        raise Skip("no models")
    innermap("map", MODELS / "homer.obj", MODELS / "spot.obj", "-o", "m", "--quiet", timeout=900)
    innermap("tetrahedralize", MODELS / "homer.obj", "-o", "homer.vtu", "--resolution", 96, "--quiet")
    innermap("remesh", "m/map.ply", "homer.vtu", MODELS / "spot.obj", "-o", "spot.vtu", "--report",
             "r.json", "--quiet", timeout=900)
    report = read_json("r.json")
    assert report["remesh"]["inverted_carried"] > 0 and report["remesh"]["inverted"] == 0
    assert report["remesh"]["boundary_vertices_max"] < 2e-3, report["remesh"]
    assert report["cells"]["least_dihedral"]["least"] > 1, report["cells"]
    assert report["cells"]["least_dihedral"]["one_percent"] > 8, report["cells"]


run(globals())
