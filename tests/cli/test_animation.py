#!/usr/bin/env python3
"""Animations in one file: point caches as frames, read and written."""

import json
import os
import struct

import cli
from cli import fails, innermap
from frames import FIGURES, ball_frames, moved, read_energies, twisted

EXPORTS = cli.ROOT.parent / "shared" / "hosts" / "exports"
SMALL = ["--charges", "400", "--resolution", "24", "--quiet"]
TIMES = {1: 0.1, 2: 0.2, 3: 0.3, 4: 0.4}


def as_float(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def write_mdd(path, frames, fps=24):
    points = len(frames[0])
    with open(path, "wb") as file:
        file.write(struct.pack(">2i", len(frames), points))
        file.write(struct.pack(f">{len(frames)}f", *(i / fps for i in range(len(frames)))))
        for frame in frames:
            file.write(struct.pack(f">{3 * points}f", *(c for p in frame for c in p)))


def write_pc2(path, frames, start=1.0, step=1.0):
    points = len(frames[0])
    with open(path, "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, points, start, step, len(frames)))
        for frame in frames:
            file.write(struct.pack(f"<{3 * points}f", *(c for p in frame for c in p)))


def read_pc2(path):
    with open(path, "rb") as file:
        content = file.read()
    _, _, points, start, step, frames = struct.unpack("<12siiffi", content[:32])
    assert len(content) == 32 + 12 * points * frames
    flat = struct.unpack(f"<{3 * points * frames}f", content[32:])
    places = [flat[i:i + 3] for i in range(0, len(flat), 3)]
    return start, step, [places[i:i + points] for i in range(0, len(places), points)]


def cached_frames(motion=twisted):
    """Files frames/f.0001.obj..., and the same numbers in walk.mdd and walk.pc2."""
    vertices, faces = cli.icosphere_arrays(3)
    frames = [[tuple(map(as_float, motion(v, t))) for v in vertices] for t in TIMES.values()]
    ball_frames(motion, {})
    os.makedirs("frames")
    for number, frame in zip(TIMES, frames):
        cli.write_obj(f"frames/f.{number:04d}.obj", frame, faces)
    write_mdd("walk.mdd", frames)
    write_pc2("walk.pc2", frames, start=101)
    return frames


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
        with open(f"files/i.{number:04d}.obj", encoding="ascii") as file:
            places = [tuple(map(float, line.split()[1:])) for line in file if line.startswith("v ")]
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
    with open("walk.pc2", "rb") as file:
        content = file.read()
    with open("short.pc2", "wb") as file:
        file.write(content[:-5])
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


def write_gltf(path):
    """A ball of split vertices that is moved and grows, from frame 12 to 36 of 24 a second."""
    vertices, faces = cli.icosphere_arrays(3)
    corners = [vertices[i] for f in faces for i in f]
    data = struct.pack(f"<{3 * len(corners)}f", *(c for p in corners for c in p))
    keys = struct.pack("<2f", 0.5, 1.5), struct.pack("<6f", 0, 0, 0, 1, -2, 0.5), \
        struct.pack("<6f", 1, 1, 1, 1.5, 1.5, 1.5)
    parts, views, at = [data, *keys], [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    kinds = [("VEC3", len(corners)), ("SCALAR", 2), ("VEC3", 2), ("VEC3", 2)]
    with open(path.replace(".gltf", ".bin"), "wb") as file:
        file.write(b"".join(parts))
    scene = {
        "asset": {"version": "2.0"}, "bufferViews": views,
        "buffers": [{"byteLength": at, "uri": path.replace(".gltf", ".bin")}],
        "accessors": [{"bufferView": i, "componentType": 5126, "count": n, "type": kind}
                      for i, (kind, n) in enumerate(kinds)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"name": "ball", "mesh": 0}],
        "animations": [{"name": "move", "samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 3}],
                        "channels": [{"sampler": i, "target": {"node": 0, "path": path}}
                                     for i, path in enumerate(("translation", "scale"))]}]}
    with open(path, "w", encoding="ascii") as file:
        json.dump(scene, file)
    return vertices, faces


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
