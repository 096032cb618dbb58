#!/usr/bin/env python3
"""tetrahedralize and compare-fem."""

import csv
import math
import os

from cli import (MODELS, ROOT, Skip, cube, dry_run, fails, icosphere, icosphere_arrays, innermap, nightly,
                 no_leftovers, read_file, read_json, run, torus, write_obj)


def read_medit(path):
    """Vertices and tetrahedra of an ASCII .mesh file."""
    words = read_file(path).decode().split()
    at = words.index("Vertices")
    count = int(words[at + 1])
    numbers = words[at + 2:at + 2 + 4 * count]
    vertices = [tuple(map(float, numbers[4 * i:4 * i + 3])) for i in range(count)]
    at = words.index("Tetrahedra")
    count = int(words[at + 1])
    numbers = list(map(int, words[at + 2:at + 2 + 5 * count]))
    return vertices, [tuple(v - 1 for v in numbers[5 * i:5 * i + 4]) for i in range(count)]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))


def measured(vertices, tetrahedra):
    """Volume, inverted cells, least and greatest dihedral angle, Euler characteristic of the
    boundary, its edges that do not have two faces; by plain arithmetic."""
    volume, inverted, angles, faces = 0.0, 0, [], {}
    for t in tetrahedra:
        p = [vertices[v] for v in t]
        size = dot(minus(p[1], p[0]), cross(minus(p[2], p[0]), minus(p[3], p[0]))) / 6
        volume += size
        inverted += size <= 0
        normals = []
        for f in FACES:
            n = cross(minus(p[f[1]], p[f[0]]), minus(p[f[2]], p[f[0]]))
            length = math.sqrt(dot(n, n))
            normals.append(tuple(x / length for x in n))
            key = tuple(sorted(t[k] for k in f))
            faces[key] = faces.get(key, 0) + 1
        for i in range(4):
            for j in range(i):
                angles.append(math.degrees(math.acos(
                    max(-1.0, min(1.0, -dot(normals[i], normals[j]))))))
    assert max(faces.values()) <= 2
    boundary = [f for f, n in faces.items() if n == 1]
    edges = {}
    for f in boundary:
        for e in ((f[0], f[1]), (f[1], f[2]), (f[0], f[2])):
            edges[e] = edges.get(e, 0) + 1
    used = {v for f in boundary for v in f}
    return (volume, inverted, min(angles), max(angles), len(used) - len(edges) + len(boundary),
            sum(n != 2 for n in edges.values()))


def test_writes_what_it_says():
    icosphere("ball.obj", 3)
    done = innermap("tetrahedralize", "ball.obj", "-o", "ball.mesh", "--resolution", 16, "--report",
                    "r.json", "--picture", "cut.png")
    volume, inverted, least, greatest, euler, unpaired = measured(*read_medit("ball.mesh"))
    report = read_json("r.json")
    cells = report["cells"]
    assert cells["tetrahedra"] == len(read_medit("ball.mesh")[1])
    assert str(cells["tetrahedra"]) in done.stdout
    assert inverted == cells["inverted"] == 0
    assert abs(least - cells["least_dihedral"]["least"]) < 1e-3 and least >= 10 - 1e-3
    assert abs(greatest - cells["greatest_dihedral"]) < 1e-3 and greatest <= 165 + 1e-3
    assert sum(cells["least_dihedral"]["histogram"]["cells"]) == cells["tetrahedra"]
    assert abs(volume - report["source"]["volume"]) < 0.02 * volume
    assert (euler, unpaired) == (2, 0)
    assert report["topology"] == {"components": 1, "cavities": 0, "handles": 0, "compared": True,
                                  "kept": True}
    assert 0 < report["boundary"]["from_surface"]["rms"] < 5e-3
    assert report["boundary"]["inward_faces"] == 0
    assert os.path.getsize("cut.png") > 5000
    no_leftovers("ball.obj", "ball.mesh", "r.json", "cut.png")


def test_all_formats_and_an_edge():
    torus("ring.obj")
    counts = set()
    for name in ("a.vtu", "b.msh", "c.mesh"):
        innermap("tetrahedralize", "ring.obj", "-o", name, "--edge", 0.15, "--report", "r.json")
        report = read_json("r.json")
        counts.add(report["cells"]["tetrahedra"])
        assert abs(report["lattice"]["edge"] - 0.15) < 1e-9
        assert report["topology"]["handles"] == 1
    assert len(counts) == 1
    with open("a.vtu", encoding="latin-1") as file:
        assert "least_dihedral" in file.read()


def test_units_of_a_nanometre():
    icosphere("ball.obj", 2)
    icosphere("tiny.obj", 2, radius=1e-9)
    for name in ("ball", "tiny"):
        innermap("tetrahedralize", name + ".obj", "-o", name + ".mesh", "--resolution", 12)
    one, tiny = measured(*read_medit("ball.mesh")), measured(*read_medit("tiny.mesh"))
    assert abs(tiny[0] / one[0] / 1e-27 - 1) < 0.01
    assert tiny[1] == 0 and tiny[2] >= 10 - 1e-3 and tiny[4] == 2


def test_sharp_edges_are_kept():
    cube("cube.obj")
    innermap("tetrahedralize", "cube.obj", "-o", "sharp.mesh", "--resolution", 12, "--features", 30,
             "--report", "r.json")
    features = read_json("r.json")["features"]
    assert features["curves"] == features["kept"] == 12
    assert features["max"] < 0.01
    volume, inverted, least, greatest, euler, _ = measured(*read_medit("sharp.mesh"))
    assert inverted == 0 and least >= 5 - 1e-3 and greatest <= 170 + 1e-3 and euler == 2
    innermap("tetrahedralize", "cube.obj", "-o", "blunt.mesh", "--resolution", 12)
    assert abs(volume - 1) < 0.3 * abs(measured(*read_medit("blunt.mesh"))[0] - 1)
    done = innermap("tetrahedralize", "cube.obj", "-o", "x.mesh", "--features", 100, "--report", "r.json")
    assert read_json("r.json")["notes"], done.stderr


def test_open_and_several_solids():
    vertices, faces = icosphere_arrays(2)
    write_obj("open.obj", vertices, faces[:-3])
    innermap("tetrahedralize", "open.obj", "-o", "open.vtu", "--resolution", 16, "--report", "r.json")
    topology = read_json("r.json")["topology"]
    assert not topology["compared"] and topology["components"] == 1
    count = len(vertices)
    write_obj("two.obj", vertices + [(x + 5, y, z) for x, y, z in vertices],
              faces + [tuple(v + count for v in f) for f in faces])
    innermap("tetrahedralize", "two.obj", "-o", "two.vtu", "--resolution", 32, "--report", "r.json")
    assert read_json("r.json")["topology"]["components"] == 2


def test_topology_is_kept_or_refused():
    # A row of small balls, several to a cell of the lattice.
    vertices, faces = icosphere_arrays(2)
    small, small_faces = icosphere_arrays(1)
    for i in range(30):
        first = len(vertices)
        vertices = vertices + [(0.01 * x + 0.021 * i, 0.01 * y + 1.1, 0.01 * z) for x, y, z in small]
        faces = faces + [tuple(v + first for v in f) for f in small_faces]
    write_obj("many.obj", vertices, faces)
    fails(1, "tetrahedralize", "many.obj", "-o", "x.vtu", "--resolution", 16,
          says=("31 components", "resolution"))
    done = innermap("tetrahedralize", "many.obj", "-o", "x.vtu", "--resolution", 16,
                    "--any-topology")
    assert "31 components" in done.stderr


def test_refuses_nonsense():
    icosphere("ball.obj", 2)
    fails(2, "tetrahedralize", "ball.obj", "-o", "x.obj", says=(".vtu",))
    fails(1, "tetrahedralize", "ball.obj", "-o", "x.vtu", "--resolution", 2, says=("resolution",))
    fails(1, "tetrahedralize", "ball.obj", "-o", "x.vtu", "--resolution", 100000,
          says=("resolution",))
    fails(1, "tetrahedralize", "ball.obj", "-o", "x.vtu", "--edge", 1e-9, says=["edge"])
    fails(1, "tetrahedralize", "ball.obj", "-o", "x.vtu", "--edge", 10, says=["edge"])
    fails(1, "tetrahedralize", "missing.obj", "-o", "x.vtu", says=("missing.obj",))
    fails(1, "tetrahedralize", "ball.obj", "-o", "no/x.vtu", says=["no"])
    write_obj("flat.obj", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    fails(1, "tetrahedralize", "flat.obj", "-o", "x.vtu", says=["flat.obj"])
    fails(2, "compare-fem", "ball.obj", "-o", "out", says=("TARGET",))
    fails(2, "compare-fem", "ball.obj", "ball.obj", "--functions", "-o", "out", says=("TARGET",))
    fails(1, "compare-fem", "ball.obj", "--functions", "-o", "out", "--resolutions", "32,16",
          says=("resolutions",))
    fails(2, "compare-fem", "ball.obj", "--functions", "-o", "out", "--resolutions", "a",
          says=("--resolutions",))


def test_memory_is_said_before():
    icosphere("ball.obj", 3)
    dry_run("tetrahedralize", "ball.obj", "-o", "x.vtu", "--resolution", 200)
    fails(1, "tetrahedralize", "ball.obj", "-o", "x.vtu", "--resolution", 400, "--max-memory", "300M",
          says=("300 MB", "--resolution"))
    dry_run("compare-fem", "ball.obj", "--functions", "-o", "x")
    fails(1, "compare-fem", "ball.obj", "--functions", "-o", "x", "--resolutions", "16,200",
          "--max-memory", "300M", says=("300 MB", "--resolutions"))
    no_leftovers("ball.obj")


def test_compare_fem_on_functions():
    icosphere("ball.obj", 3)
    innermap("compare-fem", "ball.obj", "--functions", "-o", "out", "--resolutions", "8,16,32",
             "--charges", "100,400", "--samples", 3000)
    with open("out/comparison.csv", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    assert [r["method"] for r in rows] == ["elements"] * 3 + ["charges"] * 2
    assert float(rows[2]["gradient_error"]) < float(rows[0]["gradient_error"])
    assert float(rows[0]["jump"]) > 0 and float(rows[3]["jump"]) == 0
    comparison = read_json("out/report.json")["comparison"]
    assert abs(comparison["gradient_order"] - 1) < 0.3
    for name in ("curves.svg", "section.png"):
        assert os.path.getsize("out/" + name) > 3000


def test_compare_fem_on_a_map():
    rest, pose = ROOT / "samples" / "gecko.obj", ROOT / "samples" / "gecko_step.obj"
    innermap("compare-fem", rest, pose, "-o", "out", "--resolutions", "24,48", "--tolerances",
             "4e-3,1e-4", "--reference", "1e-4", "--samples", 2000)
    comparison = read_json("out/report.json")["comparison"]
    assert len(comparison["size"]) == 4
    assert comparison["harmonic_energy"][0] > 2
    assert all(0 < e < 0.1 for e in comparison["value_error"][:3])
    assert comparison["value_error"][3] is None  # the reference itself
    assert comparison["reference"]["boundary_rms"] > 0


CLOSED = ("spot", "homer", "cheburashka", "fandisk", "rocker-arm")


@nightly
def test_closed_models():
    """Dihedral angles, topology and distances on every closed model."""
    if not MODELS.exists():
        raise Skip(f"{MODELS} is not there")
    for model in CLOSED:
        for resolution in (32, 64, 128):
            innermap("tetrahedralize", MODELS / f"{model}.obj", "-o", "x.vtu", "--resolution",
                     resolution, "--report", "r.json")
            report = read_json("r.json")
            cells, where = report["cells"], (model, resolution)
            assert cells["inverted"] == 0, where
            assert cells["least_dihedral"]["least"] >= 10 - 1e-3, where
            assert cells["greatest_dihedral"] <= 165 + 1e-3, where
            assert report["topology"]["kept"], where
            if resolution == 128:
                assert report["boundary"]["from_surface"]["rms"] < 2.5e-4, where
                assert report["boundary"]["to_surface"]["rms"] < 2.5e-4, where


@nightly
def test_orders_on_spot():
    if not MODELS.exists():
        raise Skip(f"{MODELS} is not there")
    innermap("compare-fem", MODELS / "spot.obj", "--functions", "-o", "out")
    comparison = read_json("out/report.json")["comparison"]
    assert abs(comparison["value_order"] - 2) < 0.2
    assert abs(comparison["gradient_order"] - 1) < 0.2


if __name__ == "__main__":
    run(globals())
