#!/usr/bin/env python3
"""The main job: map, fit, evaluate on meshes made here, and on the real ones where they are."""

import math
import os
import random

from cli import (MODELS, Skip, cube, fails, file_size_limit, icosphere, icosphere_arrays, independent,
                 innermap, nightly, read_json, run, write_file, write_obj)

FILES = ["map.ply", "map.vdb", "report.json", "section.png", "slices.exr"]


def harmonic(p):
    x, y, z = p
    return (x * x - y * y, x * y, x + 2 * y * z)


def pair(function, subdivisions=4, scale=1.0, shift=0.0):
    """ball.obj and target.obj, both scaled and moved after `function`."""
    vertices, faces = icosphere_arrays(subdivisions)
    place = lambda p: tuple(scale * x + shift for x in p)
    write_obj("ball.obj", [place(p) for p in vertices], faces)
    write_obj("target.obj", [place(function(p)) for p in vertices], faces)


def mapped(*options):
    innermap("map", "ball.obj", "target.obj", "-o", "out", "--charges", "400", "--resolution", "32",
             "--quiet", *options)
    assert sorted(os.listdir("out")) == FILES, os.listdir("out")
    return read_json("out/report.json")


INTERIOR = """
import sys, numpy as np, pyopenvdb as vdb
scale, shift = float(sys.argv[2]), float(sys.argv[3])
m, s = vdb.read(sys.argv[1], "map"), vdb.read(sys.argv[1], "surface").getConstAccessor()
e = []
for v in m.citerOnValues():
    if s.getValue(v.min) >= 0: continue
    x, y, z = [(a - shift) / scale for a in m.transform.indexToWorld(v.min)]
    q = [(a - shift) / scale for a in v.value]
    e.append(sum((a - b) ** 2 for a, b in zip(q, (x * x - y * y, x * y, x + 2 * y * z))))
print(np.sqrt(np.mean(e)))
"""


def interior_rms(scale=1.0, shift=0.0):
    """Error of the file's map against harmonic() inside, read with OpenVDB's own module."""
    return float(independent(INTERIOR, "out/map.vdb", scale, shift))


def test_harmonic_deformation_is_exact_inside():
    # Floats of size 1 hold 6e-8; the diagonal is 3.5.
    pair(harmonic)
    report = mapped()
    assert report["solve"]["interpolation"] == "smooth", report["solve"]
    assert report["boundary_error"]["vertices_rms"] < 1e-9, report["boundary_error"]
    assert interior_rms() < 1e-7 * 3.5


def test_scale_and_place_do_not_matter():
    pair(harmonic)
    reference = mapped()
    # Coordinates of 3500 keep 1e-12 of the diagonal in double, and 1e-4 as floats in the grid.
    for scale, shift, grid in [(1e-3, 0, 1e-6), (1e3, 0, 1e-6), (1, 3500, 4e-4)]:
        pair(harmonic, scale=scale, shift=shift)
        report = mapped()
        for section, key in [("boundary_error", "rms"), ("boundary_error", "max"),
                             ("energy", "harmonic"), ("energy", "deformation_mean"),
                             ("jacobian", "min"), ("jacobian", "max")]:
            a, b = reference[section][key], report[section][key]
            assert abs(a - b) <= 1e-6 * abs(a), (scale, shift, key, a, b)
        assert interior_rms(scale, shift) < grid


def test_rigid_motions_cost_nothing():
    c, s = math.cos(1), math.sin(1)
    pair(lambda p: (c * p[0] - s * p[1] + 5, s * p[0] + c * p[1], p[2] - 3))
    report = mapped()
    assert report["energy"]["deformation"] < 1e-25, report["energy"]
    assert abs(report["energy"]["harmonic"] - 3) < 1e-9, report["energy"]
    assert report["boundary_error"]["max"] < 1e-14, report["boundary_error"]
    assert report["jacobian"]["folded_fraction"] == 0
    assert report["solve"]["rank"] == 0


def test_uniform_scaling_has_the_closed_form():
    pair(lambda p: tuple(1.5 * x for x in p))
    energy = mapped("--lame-lambda", "0.2", "--lame-mu", "0.3")["energy"]
    expected = (1.5 ** 2 - 1) ** 2 * (4.5 * 0.2 + 3 * 0.3)
    assert abs(energy["deformation_mean"] - expected) < 1e-9, energy


def test_report_has_all_keys():
    pair(harmonic)
    report = mapped()
    keys = {"source": "path vertices triangles boundary_loops caps genus volume diagonal",
            "target": "path vertices triangles volume diagonal",
            "solve": "method sources collocation rank regularization iterations",
            "boundary_error": "rms p99 max samples c_error",
            "energy": "harmonic deformation", "jacobian": "min max folded_fraction",
            "grid": "voxel_size active_voxels interior_voxels"}
    for section, names in keys.items():
        for name in names.split():
            assert report[section][name] is not None, (section, name)
    assert report["boundary_error"]["samples"] == 20000
    assert sum(report["seconds"].values()) > 0 and report["peak_memory_bytes"] > 1e6


def test_parts_give_what_map_gives():
    pair(harmonic)
    whole = mapped()
    innermap("fit", "ball.obj", "target.obj", "-o", "m.ply", "--charges", "400", "--quiet")
    with open("m.ply", "rb") as one, open("out/map.ply", "rb") as two:
        assert one.read() == two.read()
    innermap("evaluate", "m.ply", "-o", "m.vdb", "--resolution", "32", "--quiet", "--report",
             "e.json")
    parts = read_json("e.json")
    for section in ["energy", "jacobian", "grid"]:
        assert parts[section] == whole[section], section
    innermap("slice", "m.vdb", "--axis", "z", "--slices", "4", "-o", "s.exr", "--quiet")
    told = innermap("info", "m.ply", "--metadata").stdout
    assert "400 charges" in told and "interpolation: smooth" in told, told


def test_settings_are_those_used():
    pair(harmonic)
    vertices = 2562
    few = ("--charges", "400")
    for options, used in [
            (("--charge-ratio", "0.1"), {"sources": round(0.1 * vertices)}),
            ((*few, "--distance", "0.2", "--method", "tsvd"), {"sources": 400}),
            ((*few, "--radius-ratio", "2", "--regularization", "1e-12"), {"sources": 400}),
            ((*few, "--solver", "dense"), {"method": "tikhonov", "iterations": 0}),
            (("--charges", "800", "--solver", "iterative", "--interpolation", "linear"),
             {"method": "iterative", "interpolation": "linear"}),
            ((*few, "--interpolation", "smooth"), {"interpolation": "smooth"})]:
        innermap("fit", "ball.obj", "target.obj", "-o", "m.ply", "--quiet", "--report", "r.json", *options)
        report = read_json("r.json")
        assert used.items() <= report["solve"].items(), (options, report["solve"])
        assert report["boundary_error"]["rms"] < 2e-3, (options, report["boundary_error"])


def test_open_mesh_is_capped_on_both_sides():
    vertices, faces = icosphere_arrays(4)
    faces = [f for f in faces if any(vertices[i][2] < 0.8 for i in f)]
    write_obj("ball.obj", vertices, faces)
    write_obj("target.obj", [(x, y, z + 0.3 * x * x) for x, y, z in vertices], faces)
    report = mapped()
    assert report["source"]["boundary_loops"] == 1 and report["source"]["caps"] == 1
    for side in ("source", "target"):  # the rim is a level circle: its cap's middle is on the axis
        caps = report[side]["cap_places"]
        assert len(caps["x"]) == 1 and abs(caps["x"][0]) < 0.02 and abs(caps["y"][0]) < 0.02, caps
        assert 0.6 < caps["z"][0] < 1 and 0.8 < caps["size"][0] < 2.2, caps
    assert report["boundary_error"]["p99"] < 5e-3, report["boundary_error"]
    assert any("capped" in note for note in report["notes"]), report["notes"]


def test_bad_input():
    icosphere()
    icosphere("other.obj", subdivisions=1)
    cube()
    write_obj("plane.obj", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])
    write_file("text.obj", "no mesh at all\n")
    write_file("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    cases = [(("no.obj", "ball.obj"), ["no.obj"]),
             (("ball.obj", "no.obj"), ["no.obj"]),
             (("plane.obj", "plane.obj"), ["plane.obj", "no inside"]),
             (("text.obj", "text.obj"), ["text.obj"]),
             (("nan.obj", "nan.obj"), ["nan.obj"])]
    for meshes, says in cases:
        fails(1, "map", *meshes, "-o", "out", says=says)
    fails(1, "map", "ball.obj", "ball.obj", "-o", "out", "--charges", "0", says=["--charges"])
    fails(1, "map", "ball.obj", "ball.obj", "-o", "out", "--voxel-size", "-1",
          says=["--voxel-size"])
    fails(1, "map", "ball.obj", "ball.obj", "-o", "out", "--max-memory", "300M", "--charges",
          "20000", says=["--charges"])
    fails(1, "map", "ball.obj", "ball.obj", "-o", "ball.obj", says=["ball.obj"])
    fails(1, "evaluate", "ball.obj", "-o", "a.vdb", says=["ball.obj", "map.ply"])
    fails(1, "fit", "ball.obj", "other.obj", "-o", "map.ply",
          says=["other.obj", "correspond"])
    fails(2, "map", "ball.obj", "-o", "out", says=["TARGET"])
    fails(2, "map", "ball.obj", "ball.obj", "-o", "out", "--chrages", "4", says=["--charges"])


def test_all_points_in_one_place_as_target():
    icosphere()
    vertices, faces = icosphere_arrays()
    write_obj("point.obj", [(0, 0, 0)] * len(vertices), faces)
    write_obj("flat.obj", [(x, y, 0) for x, y, z in vertices], faces)
    fails(1, "map", "ball.obj", "point.obj", "-o", "out", says=["point.obj"])
    fails(1, "map", "ball.obj", "flat.obj", "-o", "out", says=["flat.obj"])


def test_thinner_than_a_voxel():
    vertices, faces = icosphere_arrays(3)
    write_obj("plate.obj", [(x, y, 0.002 * z) for x, y, z in vertices], faces)
    fails(1, "map", "plate.obj", "plate.obj", "-o", "out", "--resolution", "32",
          says=["plate.obj", "a resolution of 1"])
    done = innermap("map", "plate.obj", "plate.obj", "-o", "out", "--resolution", "32", exit_code=1)
    assert "fitting" not in done.stderr, "before anything long is done"


def test_nothing_but_crossings():
    """A ball of paper is refused at once, as either side and whatever the other is."""
    chosen = random.Random(5)
    vertices, faces = icosphere_arrays(3)
    write_obj("paper.obj", [tuple(x + chosen.gauss(0, 0.5) for x in v) for v in vertices], faces)
    icosphere("like.obj", subdivisions=3)
    icosphere("ball.obj", subdivisions=2)
    for other in ["like.obj", "ball.obj"]:
        for meshes in [("paper.obj", other), (other, "paper.obj")]:
            fails(1, "map", *meshes, "-o", "out", says=["paper.obj"])


def test_needle():
    """A resolution that nobody gave is fine enough for a solid a thousand times as long as thick."""
    vertices, faces = icosphere_arrays(3)
    write_obj("needle.obj", [(x, 0.001 * y, 0.001 * z) for x, y, z in vertices], faces)
    write_obj("bent.obj", [(x, 0.001 * y + 0.1 * x * x, 0.001 * z) for x, y, z in vertices], faces)
    innermap("map", "needle.obj", "bent.obj", "-o", "out", "--quiet")
    assert read_json("out/report.json")["grid"]["interior_voxels"] > 1000


def test_full_disk_leaves_nothing():
    pair(harmonic, subdivisions=3)
    for size in [1000, 50000]:
        fails(1, "map", "ball.obj", "target.obj", "-o", "out", "--charges", "200", "--resolution",
              "64", says=["out/map."], preexec_fn=file_size_limit(size))


def test_a_mesh_that_runs_through_itself_is_mapped_by_its_outer_surface():
    # A rod bent by more than a full turn: its ends run into one another, a ring as a union.
    vertices, faces = icosphere_arrays(3)
    angle = 1.1 * math.pi
    coil = [((2 + 0.5 * y) * math.sin(angle * x), -(2 + 0.5 * y) * math.cos(angle * x), 0.5 * z)
            for x, y, z in vertices]
    write_obj("coil.obj", coil, [f[1:] + f[:1] for f in faces])
    write_obj("rod.obj", [(3 * x, 0.5 * y, 0.5 * z) for x, y, z in vertices], faces[1:] + faces[:1])
    innermap("map", "coil.obj", "rod.obj", "-o", "out", "--surface-resolution", "24", "--candidates",
             "1", "--resolution", "32", "--quiet")
    report = read_json("out/report.json")
    outer = report["correspondence"]["source_outer_surface"]
    assert outer["taken"] and outer["handles"] == 0, outer
    assert outer["cuts"]["y"] and min(outer["cuts"]["y"]) > 0, outer  # where the ends meet
    # The map is that of the outer surface, which stands in the folder.
    assert report["laid"]["vertices"] >= outer["vertices"] > len(vertices), (report["laid"], outer)
    # Both meshes as their files have them.
    assert report["source"]["vertices"] == report["target"]["vertices"] == len(vertices), report
    assert report["laid"]["path"] == "out/correspondence.ply", report["laid"]
    assert os.path.exists("out/correspondence.source.ply")
    assert report["boundary_error"]["p99"] < 5e-3, report["boundary_error"]
    assert report["inside"]["folded"] < 2e-3, report["inside"]


def test_horse():
    if not MODELS.exists():
        raise Skip("no ../shared/models")
    poses = MODELS / "horse-poses"
    innermap("map", poses / "reference.obj", poses / "pose-03.obj", "-o", "out", "--charges",
             "2000", "--quiet")
    report = read_json("out/report.json")
    assert report["boundary_error"]["rms"] <= 1e-3, report["boundary_error"]
    assert report["boundary_error"]["p99"] <= 4e-3, report["boundary_error"]
    assert report["source"]["caps"] == 2 and report["target"]["self_intersections"] > 0
    # Known from measurement: 0.01 to 0.2% of the volume.
    assert report["jacobian"]["folded_fraction"] < 2e-3, report["jacobian"]


@nightly
def test_every_model_gets_a_sound_map():
    if not MODELS.exists():
        raise Skip("no ../shared/models")
    names = ["spot", "homer", "cheburashka", "fandisk", "rocker-arm", "suzanne", "teapot",
             "stanford-bunny"]
    for name in names:
        with open(MODELS / f"{name}.obj", encoding="utf-8") as file:
            lines = [line for line in file if line.startswith(("v ", "f "))]
        points = [tuple(map(float, l.split()[1:4])) for l in lines if l[0] == "v"]
        low = [min(p[a] for p in points) for a in range(3)]
        size = max(max(p[a] for p in points) - low[a] for a in range(3))

        def twist(p):
            x, y, z = [(p[a] - low[a]) / size for a in range(3)]
            c, s = math.cos(y), math.sin(y)
            return (c * x - s * z, y + 0.2 * x * x, s * x + c * z)

        moved = iter([twist(p) for p in points])
        with open("target.obj", "w", encoding="ascii") as file:
            for line in lines:
                face = " ".join(corner.split("/")[0] for corner in line.split())
                file.write("v %r %r %r\n" % next(moved) if line[0] == "v" else face + "\n")
        innermap("map", MODELS / f"{name}.obj", "target.obj", "-o", "out", "--charges", "800",
                 "--resolution", "64", "--quiet")
        report = read_json("out/report.json")
        error = report["boundary_error"]
        assert error["rms"] < 2e-3 and error["p99"] < 6e-3, (name, error)
        # Never a weight field that explodes between the points.
        assert error["max"] < 30 * error["rms"], (name, error)
        assert report["jacobian"]["folded_fraction"] < 0.01, (name, report["jacobian"])


def test_what_an_earlier_run_left_goes():
    """A page or pictures of another map do not stand beside the new one; other files stay."""
    pair(harmonic, subdivisions=2)
    small = ["--charges", "200", "--resolution", "16", "--quiet"]
    innermap("map", "ball.obj", "target.obj", "-o", "out", "--html", *small)
    for name in ("steps.png", "mine.txt"):
        write_file(f"out/{name}", "old")
    assert "report.html" in os.listdir("out")
    innermap("map", "ball.obj", "target.obj", "-o", "out", *small)
    assert sorted(os.listdir("out")) == sorted([*FILES, "mine.txt"]), os.listdir("out")
    # Nothing says that an earlier run wrote these.
    os.remove("out/report.json")
    write_file("out/report.html", "a page of the user's")
    innermap("map", "ball.obj", "target.obj", "-o", "out", *small)
    assert "report.html" in os.listdir("out")


run(globals())
