#!/usr/bin/env python3
"""Geometry carried through maps: meshes, points, curves and cells, read back by other programs."""

import json
import math
import os
import struct
import subprocess

from cli import (MODELS, ROOT, Skip, fails, icosphere_arrays, independent, innermap, nightly, read_file,
                 read_json, run, write_file, write_obj)
from scenes import fitted_ball, swirl, write_splats


def obj_rows(path, keyword):
    with open(path, encoding="utf-8") as file:
        return [[float(w) for w in line.split()[1:4]] for line in file
                if line.split()[:1] == [keyword]]


def largest(a, b):
    assert len(a) == len(b), (len(a), len(b))
    return max(math.dist(p, q) for p, q in zip(a, b))


def test_mesh_there_and_back():
    fitted_ball(swirl, "--interpolation", "smooth")
    vertices, faces = icosphere_arrays(2)
    with open("core.obj", "w", encoding="utf-8") as file:
        file.write("# a core\nmtllib core.mtl\n")
        for p in vertices:
            file.write("v %r %r %r 0.5 0.25 0.125\n" % tuple(0.6 * x for x in p))
        file.write("vt 0.5 0.25\n")
        for p in vertices:
            file.write("vn %r %r %r\n" % p)
        file.write("g shell\nusemtl steel\n")
        for face in faces:
            file.write("f " + " ".join(f"{v + 1}/1/{v + 1}" for v in face) + "\n")
        file.write("l 1 2 3\n")
    innermap("push", "map.ply", "core.obj", "-o", "posed.obj", "--report", "r.json")
    report = read_json("r.json")["geometry"]
    assert report["points"] == report["directions"] == len(vertices), report
    assert report["points_outside"] == report["points_folded"] == 0, report
    assert largest(obj_rows("posed.obj", "v"), [swirl([0.6 * x for x in p]) for p in vertices]) < 0.05  # it is not harmonic
    innermap("pull", "map.ply", "posed.obj", "-o", "back.obj")
    assert largest(obj_rows("back.obj", "v"), obj_rows("core.obj", "v")) < 1e-5
    assert largest(obj_rows("back.obj", "vn"), obj_rows("core.obj", "vn")) < 1e-4
    moves = ("v ", "vn")
    for name in ("posed.obj", "back.obj"):
        with open(name, encoding="utf-8") as a, open("core.obj", encoding="utf-8") as b:
            for x, y in zip(a, b):
                assert x == y or x[:2] == y[:2] and x[:2] in moves, (x, y)
                assert not x.startswith("v ") or x.endswith(" 0.5 0.25 0.125\n"), x


def test_what_is_outside():
    fitted_ball(swirl, "--interpolation", "smooth")
    write_file("cloud.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
                            "property double z\nproperty int id\nend_header\n0 0 0 7\n1.2 0 0 8\n0.5 0 0 9\n")
    innermap("push", "map.ply", "cloud.ply", "-o", "in.ply", "--report", "r.json")
    assert read_json("r.json")["geometry"]["points_cut"] == 1
    text = read_file("in.ply").decode()
    assert "element vertex 2\n" in text and " 8\n" not in text and text.endswith(" 9\n"), text
    innermap("push", "map.ply", "cloud.ply", "-o", "near.ply", "--outside", 0.1, "--report", "r.json")
    report = read_json("r.json")["geometry"]
    assert report["points_cut"] == 0 and report["points_outside"] == 1, report
    assert abs(report["farthest_outside"] - 0.2 / math.sqrt(12)) < 1e-3, report
    innermap("push", "map.ply", "cloud.ply", "-o", "far.ply", "--outside", 0.01, "--fade-to",
             "identity", "--quiet")
    rows = [line.split() for line in read_file("far.ply").decode().split("end_header\n")[1].splitlines()]
    assert max(abs(float(x) - y) for x, y in zip(rows[1], (1.2, 0, 0, 8))) < 1e-9, rows


def test_long_edges_are_split():
    fitted_ball(swirl, "--interpolation", "smooth")
    write_file("rod.obj", "v 0.3 0 -0.9\nv 0.3 0 0.9\nv -0.3 0 0.9\nf 1 2 3\nl 1 2\n")
    innermap("push", "map.ply", "rod.obj", "-o", "a.obj", "--report", "r.json", "--subdivide", 0.001)
    added = read_json("r.json")["geometry"]["points_added"]
    innermap("push", "map.ply", "rod.obj", "-o", "b.obj", "--report", "r.json", "--subdivide", 0.0001)
    assert 5 < added < read_json("r.json")["geometry"]["points_added"]
    with open("b.obj", encoding="utf-8") as file:
        lines = [line.split() for line in file]
    curve = [int(w) - 1 for words in lines if words[0] == "l" for w in words[1:]]
    places = [[float(w) for w in words[1:4]] for words in lines if words[0] == "v"]
    # The middles of its parts, brought back, lie on the rod.
    middles = [[(a + b) / 2 for a, b in zip(places[i], places[j])] for i, j in zip(curve, curve[1:])]
    with open("middles.obj", "w", encoding="utf-8") as file:
        for p in middles:
            file.write("v %r %r %r\n" % tuple(p))
    innermap("pull", "map.ply", "middles.obj", "-o", "on.obj")
    diagonal = 1.2 * math.sqrt(12)
    assert max(math.hypot(p[0] - 0.3, p[1]) for p in obj_rows("on.obj", "v")) < 1.2e-4 * diagonal


MAKE_CELLS = """
import meshio, numpy as np, sys
n = 6
axis = np.linspace(-0.5, 0.5, n + 1)
points = np.array([(x, y, z) for x in axis for y in axis for z in axis])
at = lambda i, j, k: (i * (n + 1) + j) * (n + 1) + k
hexes, tets = [], []
for i in range(n):
    for j in range(n):
        for k in range(n):
            c = [at(i + a, j + b, k + d) for a, b, d in ((0,0,0),(1,0,0),(1,1,0),(0,1,0),(0,0,1),(1,0,1),(1,1,1),(0,1,1))]
            if (i + j + k) % 2:
                hexes.append(c)
            else:
                for t in ((0,1,3,4),(1,2,3,6),(1,6,4,5),(3,4,6,7),(1,3,4,6)):
                    tets.append([c[v] for v in t])
tets = np.array(tets)
fields = {"fibre": np.tile([1.0, 0, 0], (len(points), 1)), "heat": points[:, 0]}
mesh = meshio.Mesh(points, [("tetra", tets), ("hexahedron", np.array(hexes))], point_data=fields,
                   cell_data={"part": [np.arange(len(tets)), np.arange(len(hexes)) + len(tets)]})
mesh.write("cells.vtu")
"""

# Counts, volume of the tetrahedra, inverted ones, by VTK or by meshio.
BY_MESHIO = """
import meshio, numpy as np, sys, json
m = meshio.read(sys.argv[1])
tets = np.concatenate([c.data for c in m.cells if c.type == "tetra"])
p = m.points[tets]
v = np.einsum("ij,ij->i", p[:,1]-p[:,0], np.cross(p[:,2]-p[:,0], p[:,3]-p[:,0])) / 6
print(json.dumps([len(m.points), len(tets), sum(len(c.data) for c in m.cells if c.type == "hexahedron"),
                  v.sum(), int((v <= 0).sum()), sorted(k for k in m.point_data if ":" not in k)]))
"""
BY_VTK = """
import vtk, sys, json
r = vtk.vtkXMLUnstructuredGridReader(); r.SetFileName(sys.argv[1]); r.Update(); g = r.GetOutput()
tets = [g.GetCell(i) for i in range(g.GetNumberOfCells()) if g.GetCellType(i) == 10]
volume, inverted = 0, 0
for i in range(g.GetNumberOfCells()):
    if g.GetCellType(i) != 10: continue
    v = vtk.vtkTetra.ComputeVolume(*[g.GetPoint(g.GetCell(i).GetPointId(k)) for k in range(4)])
    volume += v; inverted += v <= 0
d = g.GetPointData()
print(json.dumps([g.GetNumberOfPoints(), len(tets), sum(g.GetCellType(i) == 12 for i in range(g.GetNumberOfCells())),
                  volume, inverted, sorted(d.GetArrayName(i) for i in range(d.GetNumberOfArrays()))]))
"""


def agree(a, b):
    assert a[:3] == b[:3] and a[4:] == b[4:], (a, b)
    assert abs(a[3] - b[3]) < 1e-12 * abs(a[3]), (a, b)


def test_cells_by_two_other_readers():
    fitted_ball(swirl, "--interpolation", "smooth")
    independent(MAKE_CELLS)
    innermap("push", "map.ply", "cells.vtu", "-o", "posed.vtu", "--vectors", "fibre", "--report",
             "r.json")
    report = read_json("r.json")["geometry"]
    assert report["cells_inverted_before"] == 0 and report["points_outside"] == 0, report
    vtu = json.loads(independent(BY_MESHIO, "posed.vtu"))
    agree(vtu, json.loads(independent(BY_VTK, "posed.vtu")))
    assert vtu[4] == report["cells_inverted_after"] == 0 and vtu[0] == report["points"]
    assert vtu[1] + vtu[2] == report["cells"]
    innermap("push", "map.ply", "cells.vtu", "-o", "posed.msh", "--vectors", "fibre", "--quiet")
    agree(vtu, json.loads(independent(BY_MESHIO, "posed.msh")))
    done = innermap("push", "map.ply", "cells.vtu", "-o", "posed.mesh", "--vectors", "fibre")
    assert "'fibre'" in done.stderr, done.stderr
    agree(vtu[:5], json.loads(independent(BY_MESHIO, "posed.mesh"))[:5])
    # And Gmsh, of both.
    try:
        for name in ("posed.msh", "posed.mesh"):
            subprocess.run(["gmsh", name, "-save", "-format", "msh22", "-o", "again.msh"],
                           check=True, capture_output=True)
            innermap("pull", "map.ply", "again.msh", "-o", "back.vtu", "--report", "r.json")
            assert read_json("r.json")["geometry"]["cells"] == vtu[1] + vtu[2], name
    except FileNotFoundError as missing:
        raise Skip("no gmsh") from missing
    # There and back: the places and the vectors.
    innermap("pull", "map.ply", "posed.msh", "-o", "back.vtu", "--quiet")
    off = independent("import meshio, numpy as np\na, b = meshio.read('cells.vtu'), meshio.read('back.vtu')\n"
                 "print(abs(a.points - b.points).max(), abs(a.point_data['fibre'] - "
                 "b.point_data['fibre']).max(), abs(a.point_data['heat'] - b.point_data['heat']).max(),"
                 "sum(abs(x - y).sum() for x, y in zip(a.cell_data['part'], b.cell_data['part'])))")
    place, vector, heat, part = map(float, off.split())
    assert place < 1e-5 and vector < 1e-4 and heat <= 1e-15 and part <= 0, off


def test_frames():
    vertices, faces = icosphere_arrays(4)
    write_obj("ball.obj", vertices, faces)
    for frame in (1, 2):
        write_obj(f"walk.{frame}.obj", [(x + frame, y * (1 + 0.1 * frame), z) for x, y, z in vertices],
                  faces)
    write_obj("core.obj", [[0.5 * x for x in p] for p in vertices], faces)
    innermap("deform", "ball.obj", "core.obj", "walk.1.obj", "walk.2.obj", "-o", "core.####.obj",
             "--charges", 500, "--report", "r.json")
    for frame in (1, 2):
        expected = [(0.5 * x + frame, 0.5 * y * (1 + 0.1 * frame), 0.5 * z) for x, y, z in vertices]
        assert largest(obj_rows(f"core.000{frame}.obj", "v"), expected) < 2e-3
    fails(2, "deform", "ball.obj", "core.obj", "walk.1.obj", "-o", "c.obj", "--velocity",
          says=["--velocity"])


def test_captures_of_splats():
    """What becomes of them: unit tests, and tests/python/test_splats.py."""
    fitted_ball(swirl, subdivisions=3)
    splat = {"x": 0.25, "scale_0": -4, "scale_1": -5, "scale_2": -6, "rot_0": 1}
    write_splats("cap.ply", [splat, {**splat, "x": 3}])
    for command, source in (("push", "cap.ply"), ("pull", "posed.ply")):
        innermap(command, "map.ply", source, "-o", "posed.ply" if command == "push" else "back.ply",
                 "--splats", "mass", "--report", "r.json")
        report = read_json("r.json")["geometry"]
        assert report["splats"] and report["opacities_capped"] == 0, report
        assert report["points_cut"] == (command == "push"), report
    write_splats("bad.ply", [{**splat, "rot_0": 0}])
    fails(1, "push", "map.ply", "bad.ply", "-o", "a.ply", says=["bad.ply", "splat 0", "length 0"])
    fails(2, "push", "map.ply", "a.vdb", "-o", "b.vdb", "--splats", "mass", says=["--splats"])
    fails(1, "push", "map.ply", "ball.obj", "-o", "a.obj", "--splats", "mass", says=["splats"])


def test_what_is_refused():
    fitted_ball(swirl, "--interpolation", "smooth")
    fails(2, "push", "map.ply", "ball.obj", "-o", "a.obj", "--density", says=["--density"])
    fails(2, "push", "map.ply", "a.vdb", "-o", "b.vdb", "--subdivide", 0.1, says=["--subdivide"])
    fails(1, "push", "map.ply", "ball.obj", "-o", "a.ply", says=["a.ply", ".obj"])
    fails(1, "push", "map.ply", "nowhere.obj", "-o", "a.obj", says=["nowhere.obj"])
    fails(1, "push", "map.ply", "ball.obj", "-o", "a.obj", "--max-memory", "100M", says=["100 MB"])
    fails(1, "push", "map.ply", "map.ply", "-o", "a.ply", "--vectors", "w", says=["'w'", "w_x"])
    write_file("cut.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty double x\n"
                          b"property double y\nproperty double z\nend_header\n" + struct.pack("<3d", 0, 0, 0))
    fails(1, "push", "map.ply", "cut.ply", "-o", "a.ply", says=["cut.ply"])
    write_file("wedge.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nPrisms 0\nEnd\n")
    fails(1, "push", "map.ply", "wedge.mesh", "-o", "a.vtu", says=["wedge.mesh"])
    done = innermap("push", "map.ply", "ball.obj", "-o", "a.obj", "--dry-run")
    assert "ball.obj" in done.stdout, done.stdout
    assert not os.path.exists("a.obj")


@nightly
def test_bones_of_a_horse():
    poses = MODELS / "horse-poses"
    if not poses.is_dir():
        raise Skip("no models")
    made = subprocess.run(["/usr/bin/python3", str(ROOT / "samples/skeleton.py"),
                           str(poses / "reference.obj"), "bones.obj"], capture_output=True, text=True,
                          check=False)
    if "No module" in made.stderr:
        raise Skip("no numpy")
    assert made.returncode == 0, made.stderr
    vertices = obj_rows("bones.obj", "v")
    innermap("fit", poses / "reference.obj", poses / "pose-03.obj", "-o", "map.ply", "--charges", 6000,
             "--quiet")
    innermap("push", "map.ply", "bones.obj", "-o", "posed.obj", "--outside", 0.02, "--report", "r.json")
    report = read_json("r.json")["geometry"]
    assert report["points"] == len(vertices) > 10000 and report["points_cut"] == 0, report
    # Thin tubes come out of it somewhere, by little.
    assert report["points_outside"] < 0.02 * len(vertices), report
    innermap("pull", "map.ply", "posed.obj", "-o", "back.obj", "--outside", 0.03, "--quiet")
    assert largest(obj_rows("back.obj", "v"), obj_rows("bones.obj", "v")) < 1e-5


if __name__ == "__main__":
    run(globals())
