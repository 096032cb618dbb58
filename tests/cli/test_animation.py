#!/usr/bin/env python3
"""Animations in one file: point caches as frames, read and written."""

import json
import math
import os
import random

import cli
from caches import TIMES, as_float, cached_frames, read_pc2, write_gltf, write_mdd, write_morphs, write_pc2
from cli import fails, innermap
from frames import FIGURES, moved, read_energies

EXPORTS = cli.ROOT.parent / "shared" / "hosts" / "exports"
SMALL = ["--charges", "400", "--resolution", "24", "--quiet"]


def test_caches_are_frames():
    cached_frames()
    innermap("sequence", "rest.obj", "frames", "-o", "files", *SMALL)
    innermap("sequence", "rest.obj", "walk.mdd", "-o", "mdd", *SMALL)
    innermap("sequence", "rest.obj", "walk.pc2", "-o", "pc2", "--frames", "102-103", *SMALL)
    files, mdd, pc2 = (read_energies(f) for f in ("files", "mdd", "pc2"))
    assert [r["frame"] for r in mdd] == [1, 2, 3, 4] and mdd[0]["file"] == "walk.mdd"
    assert [r["frame"] for r in pc2] == [102, 103]
    for rows, others in [(files, mdd), (files[1:3], pc2)]:
        for a, b in zip(rows, others):
            assert [a[k] for k in FIGURES[:-1]] == [b[k] for k in FIGURES[:-1]]
    innermap("sequence", "rest.obj", "walk.mdd", "-o", "on", "--first-frame", "-1", "--frames", "-1,2",
             *SMALL)
    assert [r["frame"] for r in read_energies("on")] == [-1, 2]
    innermap("report", "on")


def test_finished_frames_of_a_cache_are_known():
    frames = cached_frames(moved)
    innermap("voxelize", "rest.obj", "-o", "rest.vdb", "--fog", "--resolution", "16", "--quiet")
    deform = ["deform", "rest.obj", "rest.vdb", "walk.mdd", "-o", "out/d.vdb", "--charges", "400"]
    innermap(*deform)
    before = {name: os.stat("out/" + name).st_mtime_ns for name in os.listdir("out")}
    assert sorted(before) == [f"d.{n:04d}.vdb" for n in TIMES]
    frames[1] = [(x, y, z + 0.1) for x, y, z in frames[1]]
    write_mdd("walk.mdd", frames)
    assert "3 of 4" in innermap(*deform).stderr
    assert [n for n in before if os.stat("out/" + n).st_mtime_ns != before[n]] == ["d.0002.vdb"]


def test_geometry_is_written_to_caches():
    cached_frames()
    cli.icosphere("inside.obj", 1, 0.5)
    deform = ["deform", "rest.obj", "inside.obj"]
    innermap(*deform, "frames", "-o", "files/i.obj", *SMALL[:2], "--quiet")
    innermap(*deform, "walk.pc2", "-o", "out/i.pc2", *SMALL[:2], "--quiet")
    assert os.listdir("out") == ["i.pc2"]
    start, step, frames = read_pc2("out/i.pc2")
    assert (start, step, len(frames)) == (101, 1, 4)
    for number, frame in zip(TIMES, frames):
        places = cli.read_obj(f"files/i.{number:04d}.obj")[0]
        assert len(places) == len(frame)
        for p, q in zip(places, frame):
            assert max(abs(as_float(a) - b) for a, b in zip(p, q)) < 1e-6
    innermap(*deform, "walk.mdd", "-o", "i.mdd", "--frames", "1-4x3", "--fps", "10", *SMALL[:2])
    info = json.loads(innermap("info", "i.mdd", "--json").stdout)
    assert info["frames"] == 2 and abs(info["seconds"][1] - 0.3) < 1e-6
    fails(1, *deform, "walk.mdd", "-o", "x.pc2", "--frames", "1,2,4", *SMALL[:2], says=["x.pc2"])
    fails(1, *deform, "walk.mdd", "-o", "x.pc2", "--max-time", "1e-3", *SMALL[:2], says=["x.pc2"])
    fails(2, "deform", "rest.obj", "rest.vdb", "walk.mdd", "-o", "x.pc2", says=["--output"])
    cli.icosphere("far.obj", 1, 9)
    fails(1, "deform", "rest.obj", "far.obj", "walk.mdd", "-o", "x.pc2", *SMALL[:2],
          says=["far.obj", "--outside"])


def test_a_cache_is_written_whole_or_not_at_all():
    frames = cached_frames()
    frames[2] = [(float("nan"), 0, 0)] * len(frames[0])
    write_mdd("walk.mdd", frames)
    cli.icosphere("inside.obj", 1, 0.5)
    deform = ["deform", "rest.obj", "inside.obj", "walk.mdd", *SMALL[:2]]
    fails(1, *deform, "-o", "x.pc2", says=["x.pc2"])
    innermap(*deform, "-o", "x.pc2", "--frames", "1-2")
    os.remove("x.pc2")
    fails(1, *deform, "-o", "x.pc2", "--frames", "1-2", says=["x.pc2"],
          preexec_fn=cli.file_size_limit(300))


def test_what_cannot_be_read_is_said():
    frames = cached_frames()
    write_mdd("other.mdd", [f[:-2] for f in frames])
    count = len(frames[0])
    fails(1, "sequence", "rest.obj", "other.mdd", "-o", "x", *SMALL,
          says=["other.mdd", f"{count - 2} points", f"{count} vertices"])
    content = cli.read_file("walk.pc2")
    cli.write_file("short.pc2", content[:-5])
    fails(1, "sequence", "rest.obj", "short.pc2", "-o", "x", *SMALL, says=["short.pc2", "cut short"])
    fails(1, "sequence", "rest.obj", "walk.pc2", "walk.mdd", "-o", "x", *SMALL, says=["alone"])
    fails(1, "sequence", "rest.obj", "walk.abc", "-o", "x", *SMALL, says=["Alembic", ".mdd"])
    fails(1, "info", "walk.usdc", says=["USD", ".mdd"])
    mdd = json.loads(innermap("info", "walk.mdd", "--json").stdout)
    assert mdd["kind"] == "point_cache" and mdd["frames"] == 4 and mdd["points"] == count
    pc2 = json.loads(innermap("info", "walk.pc2", "--json").stdout)
    assert pc2["start"] == 101 and "101" in innermap("info", "walk.pc2").stdout


def test_caches_of_blender():
    if not EXPORTS.exists():
        raise cli.Skip(f"no files at {EXPORTS}")
    for name, numbers in [("cylinder.mdd", range(1, 11)), ("cylinder.pc2", range(1, 11)),
                          ("cylinder_rest_first.mdd", range(1, 12))]:
        innermap("sequence", EXPORTS / "cylinder_rest.obj", EXPORTS / name, "-o", name, *SMALL)
        rows = read_energies(name)
        assert [r["frame"] for r in rows] == list(numbers)
        assert rows[0]["deformation"] < 1e-6 < rows[-1]["deformation"]


def test_the_gallop_is_one_animation_in_all_files():
    """The horse's frames as OBJ, MDD, PC2 and glTF: by bits where the numbers are, else as the fit is."""
    gallop = cli.MODELS / "horse-gallop"
    if not gallop.exists():
        raise cli.Skip(f"no models at {gallop}")
    _, faces = cli.read_obj(gallop / "reference.obj")
    rest, *frames = ([tuple(map(as_float, v)) for v in cli.read_obj(gallop / name)[0]] for name in
                     ("reference.obj", "frame.0001.obj", "frame.0013.obj", "frame.0025.obj"))
    cli.write_obj("rest.obj", rest, faces)
    os.makedirs("files")
    for number, frame in enumerate(frames, 1):
        cli.write_obj(f"files/f.{number:04}.obj", frame, faces)
    write_mdd("walk.mdd", frames)
    write_pc2("walk.pc2", frames)
    order = list(range(len(faces)))
    random.Random(7).shuffle(order)
    write_morphs("walk.gltf", rest, faces, frames, order)
    middle = [sum(p[a] for p in rest) / len(rest) for a in range(3)]
    # The middles of the trunk: points that are safely inside.
    inside = [tuple(0.05 * x + 0.95 * m for x, m in zip(p, middle)) for p in rest[::40]]
    cli.write_obj("inside.obj", inside, [(i, i + 1, i + 2) for i in range(len(inside) - 2)])
    made = {}
    for source in ("files", "walk.mdd", "walk.pc2", "walk.gltf"):
        innermap("deform", "rest.obj", "inside.obj", source, "-o", "out.pc2", "--charges", "800", "--quiet",
                 "--outside", "0.05")
        made[source] = read_pc2("out.pc2")[2]
    assert made["files"] == made["walk.mdd"] == made["walk.pc2"] and len(made["files"]) == 3
    diagonal = math.dist(*(tuple(limit(p[a] for p in rest) for a in range(3)) for limit in (min, max)))
    worst = max(math.dist(p, q) for a, b in zip(made["files"], made["walk.gltf"]) for p, q in zip(a, b))
    assert worst < 1e-6 * diagonal, worst / diagonal
    moves = max(math.dist(p, q) for p, q in zip(made["files"][0], made["files"][1]))
    assert moves > 1e-3 * diagonal, moves


def test_gltf_is_rest_pose_and_frames():
    vertices, faces = write_gltf("ball.gltf")
    innermap("sequence", "ball.gltf", "-o", "out", "--frames", "12,24,36", *SMALL)
    rows = read_energies("out")
    assert [r["frame"] for r in rows] == [12, 24, 36] and rows[0]["file"] == "ball.gltf"
    for row, growth in zip(rows, (1, 1.25, 1.5)):
        assert abs(row["jacobian_min"] - growth ** 3) < 1e-4, row
    innermap("sequence", "ball.gltf", "-o", "back", "--rest", "36", "--frames", "12", *SMALL)
    assert abs(read_energies("back")[0]["jacobian_min"] - 1.5 ** -3) < 1e-4
    cli.write_obj("rest.obj", vertices, faces)
    innermap("sequence", "rest.obj", "ball.gltf", "-o", "beside", "--fps", "2", *SMALL)
    rows = read_energies("beside")
    assert [r["frame"] for r in rows] == [1, 2, 3] and abs(rows[1]["jacobian_min"] - 1.25 ** 3) < 1e-4
    innermap("report", "beside")
    cli.icosphere("inside.obj", 1, 0.5)
    innermap("deform", "ball.gltf", "inside.obj", "-o", "inside.pc2", "--frames", "24", "--up", "z",
             *SMALL[:2])
    place = read_pc2("inside.pc2")[2][0]
    inside = cli.icosphere_arrays(1, 0.5)[0]
    for p, q in zip(place, inside):
        assert max(abs(a - 1.25 * b - c) for a, b, c in zip(p, q, (0.5, -0.25, -1))) < 1e-5
    info = json.loads(innermap("info", "ball.gltf", "--json").stdout)
    assert info["meshes"][0]["vertices"] == len(vertices) and info["animations"][0]["end"] == 1.5
    assert "move" in innermap("info", "ball.gltf").stdout
    cli.icosphere("other.obj", 3, 1.1)
    fails(1, "sequence", "other.obj", "ball.gltf", "-o", "x", *SMALL, says=["ball.gltf", "--up z"])
    fails(1, "sequence", "ball.gltf", "-o", "x", "--mesh", "bal", *SMALL, says=["ball"])
    fails(2, "sequence", "rest.obj", "-o", "x", says=["FRAMES"])


cli.run(globals())
