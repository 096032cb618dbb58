#!/usr/bin/env python3
"""innermap deform: a volume carried through an animation."""

import json
import os

import cli
from cli import fails, innermap
from frames import ball_frames, break_frame, moved, rigid, twisted

SMALL = ["--charges", "400", "--quiet"]


def volume(resolution=20):
    """rest.vdb: level set and fog of rest.obj."""
    innermap("voxelize", "rest.obj", "-o", "rest.vdb", "--fog", "--resolution", resolution,
             "--quiet")


def deform(*arguments, output="out/d.####.vdb", **options):
    return innermap("deform", "rest.obj", "rest.vdb", "frames/*.obj", "-o", output, *SMALL,
                    *arguments, **options)


def read_with_openvdb(code):
    """What a program prints that reads with OpenVDB's own Python module."""
    return cli.independent("import pyopenvdb as vdb\n" + code).split()


def stamps(folder="out"):
    return {name: os.stat(os.path.join(folder, name)).st_mtime_ns
            for name in sorted(os.listdir(folder))}


def test_frame_numbers_are_kept():
    ball_frames(rigid, {1: 0.1, 12: 0.5, 1234567: 1.0})
    volume()
    innermap("deform", "rest.obj", "rest.vdb", "frames", "-o", "out/d.####.vdb", "--charges", "400",
             "--report", "r.json")
    assert sorted(os.listdir("out")) == ["d.0001.vdb", "d.0012.vdb", "d.1234567.vdb"]
    report = cli.read_json("r.json")
    assert report["frames"]["number"] == [1, 12, 1234567]
    assert min(report["frames"]["inverted_fraction"]) > 0.99
    assert max(report["frames"]["boundary_max"]) < 1e-9
    text = innermap("info", "out/d.0012.vdb", "--metadata").stdout
    for line in ["density: float, fog volume", "surface: float, level set", "innermap_frame: 12",
                 "innermap_inputs: rest "]:
        assert line in text, text
    for output, name in [("p%02d.vdb", "p12.vdb"), ("q.vdb", "q.0012.vdb"), ("#.vdb", "12.vdb")]:
        deform("--frames", "12", output=output)
        assert os.path.exists(name), name


def test_usd_refers_to_the_frames():
    ball_frames(rigid, {1: 0.1, 2: 0.3, 5: 0.5})
    volume()
    deform("--usd", "out/d.usda", "--frames", "2,5", "--fps", "30", "--up", "z")
    info = json.loads(innermap("info", "out/d.usda", "--json").stdout)
    assert info["upAxis"] == '"Z"' and info["startTimeCode"] == "2" and info["endTimeCode"] == "5", info
    assert info["timeCodesPerSecond"] == "30" and info["metersPerUnit"] == "1", info
    grids = {g["name"]: g["files"] for g in info["grids"]}
    assert grids == {name: ["./d.0002.vdb", "./d.0005.vdb"] for name in ("surface", "density")}, grids
    # Also where all frames are finished already.
    os.remove("out/d.usda")
    deform("--usd", "out/d.usda", "--frames", "2,5", "--fps", "30", "--up", "z")
    assert os.path.exists("out/d.usda")
    innermap("sequence", "rest.obj", "frames", "-o", "e", "--usd", "e.usda", "--grids", "--resolution", "16", *SMALL)
    files = {g["name"]: g["files"] for g in json.loads(innermap("info", "e.usda", "--json").stdout)["grids"]}
    assert files["harmonic_energy"] == [f"./e/energy.{n:04}.vdb" for n in (1, 2, 5)], files
    fails(2, "sequence", "rest.obj", "frames", "-o", "x", "--usd", "x.usda", says=["--grids"])
    fails(2, "deform", "rest.obj", "rest.obj", "frames", "-o", "x.obj", "--usd", "x.usda", says=["--usd"])


def test_a_rigid_motion_keeps_the_volume():
    ball_frames(rigid, {1: 0.0, 2: 0.8, 3: 2.0})
    volume(32)
    deform("--density")
    sums = read_with_openvdb("""
for path in ["rest.vdb", "out/d.0001.vdb", "out/d.0002.vdb", "out/d.0003.vdb"]:
    grid = vdb.read(path, "density")
    h = grid.transform.voxelSize()[0]
    print(sum(v.value * v.count for v in grid.iterOnValues()) * h ** 3, h)
    m = grid.transform.indexToWorld((0, 0, 0))
    print(*m)
""")
    masses, sizes = [float(x) for x in sums[0::5]], {float(x) for x in sums[1::5]}
    for mass in masses[1:]:
        assert abs(mass / masses[0] - 1) < 1e-3, masses
    assert len(sizes) == 1, sizes
    # One lattice for all frames.
    assert sums[7:10] == sums[12:15] == sums[17:20], sums


def test_velocity_of_a_translation():
    ball_frames(moved, {1: 0.1, 2: 0.2, 4: 0.4, 9: 0.9})
    volume()
    deform("--velocity", "--fps", "30", "--grids", "density")
    # 0.1 (1, -2, 0.5) a frame.
    values = read_with_openvdb("""
for n in [1, 2, 4, 9]:
    grid = vdb.read(f"out/d.{n:04d}.vdb", "velocity")
    values = [v.value for v in grid.iterOnValues()]
    assert len(values) > 1000
    for a in range(3):
        print(min(v[a] for v in values), max(v[a] for v in values))
""")
    for i in range(0, len(values), 6):
        for a, expected in enumerate([3, -6, 1.5]):
            for value in values[i + 2 * a:i + 2 * a + 2]:
                assert abs(float(value) - expected) < 1e-4, values
    deform("--velocity", "--names", "houdini", output="h.vdb")
    text = innermap("info", "h.0001.vdb").stdout
    assert "  v: vec3s" in text and "velocity" not in text, text
    assert "innermap_frames_per_second: 24" in innermap("info", "h.0001.vdb", "--metadata").stdout


def test_grids_of_another_map_are_carried():
    """Their metadata say what that map was, in types of their own."""
    ball_frames(moved, {1: 0.1})
    innermap("fit", "rest.obj", "frames/f.0001.obj", "-o", "map.ply")
    innermap("evaluate", "map.ply", "-o", "rest.vdb", "--resolution", 20)
    deform("--grids", "density")
    text = innermap("info", "out/d.0001.vdb", "--metadata").stdout
    assert "innermap_boundary_error_p99" in text and "innermap_one_to_one" not in text, text
    innermap("push", "map.ply", "out/d.0001.vdb", "-o", "again.vdb")
    assert "innermap_one_to_one" in innermap("info", "again.vdb", "--metadata").stdout


def test_velocity_steps_over_broken_frames():
    ball_frames(moved, {1: 0.1, 2: 0.2, 3: 0.3})
    volume()
    break_frame("frames/f.0002.obj")
    deform("--velocity", "--grids", "density", exit_code=1)
    assert sorted(os.listdir("out")) == ["d.0001.vdb", "d.0003.vdb"]
    values = read_with_openvdb("""
grid = vdb.read("out/d.0003.vdb", "velocity")
print(min(v.value[0] for v in grid.iterOnValues()))
""")
    assert abs(float(values[0]) - 2.4) < 1e-4
    fails(2, "deform", "rest.obj", "rest.vdb", "frames/f.0001.obj", "-o", "x.vdb", "--velocity",
          says=["--velocity"])


def test_finished_frames_are_skipped_until_something_changes():
    times = {1: 0.1, 2: 0.2, 3: 0.3, 4: 0.4}
    ball_frames(twisted, times)
    volume()
    deform("--frames", "1-3")
    first = stamps()
    innermap("deform", "rest.obj", "rest.vdb", "frames/*.obj", "-o", "out/d.####.vdb", "--charges",
             "400", "--report", "r.json")
    assert cli.read_json("r.json")["frames"]["number"] == [4]
    second = stamps()
    assert {name: second[name] for name in first} == first and len(second) == 4
    deform()
    assert stamps() == second
    # Another frame's file, a damaged output, other settings, another volume.
    ball_frames(twisted, {2: 0.25})
    with open("out/d.0003.vdb", "r+b") as file:
        file.truncate(2000)
    deform()
    third = stamps()
    assert [n for n in third if third[n] != second[n]] == ["d.0002.vdb", "d.0003.vdb"], third
    deform("--sampling", "nearest")
    fourth = stamps()
    assert all(fourth[n] != third[n] for n in third)
    innermap("voxelize", "rest.obj", "-o", "rest.vdb", "--fog", "--resolution", "21", "--quiet")
    deform("--sampling", "nearest")
    fifth = stamps()
    assert all(fifth[n] != fourth[n] for n in third)
    deform("--sampling", "nearest", "--force", "--frames", "1")
    sixth = stamps()
    assert [n for n in sixth if sixth[n] != fifth[n]] == ["d.0001.vdb"]


def test_a_changed_neighbour_makes_velocities_again():
    ball_frames(moved, {n: 0.1 * n for n in range(1, 6)})
    volume(12)
    deform("--velocity")
    before = stamps()
    ball_frames(moved, {3: 0.35})
    deform("--velocity")
    after = stamps()
    assert [n for n in after if after[n] != before[n]] == [f"d.000{n}.vdb" for n in (2, 3, 4)]


def test_a_frame_does_not_depend_on_the_others():
    ball_frames(twisted, {n: 0.1 * n for n in range(1, 5)})
    volume()
    deform("--velocity")
    deform("--velocity", "--frames", "3", "--threads", "1", output="alone/d.####.vdb")
    # Files hold a random identifier: the values are compared.
    same = read_with_openvdb("""
for name in ["density", "surface", "velocity"]:
    a, b = (vdb.read(f + "/d.0003.vdb", name) for f in ["out", "alone"])
    assert a.activeVoxelCount() == b.activeVoxelCount()
    for x, y in zip(a.iterOnValues(), b.iterOnValues()):
        assert x.min == y.min and x.value == y.value, (name, x.min, x.value, y.value)
print("same")
""")
    assert same == ["same"]


def test_a_broken_frame_is_reported_and_the_others_go_on():
    ball_frames(twisted, {n: 0.1 * n for n in range(1, 5)})
    volume(12)
    break_frame("frames/f.0002.obj")
    os.remove("frames/f.0004.obj")
    os.symlink("nowhere", "frames/f.0004.obj")
    done = innermap("deform", "rest.obj", "rest.vdb", "frames/*.obj", "-o", "out/d.vdb",
                    "--charges", "400", exit_code=1)
    assert "1 of 3 frames" in cli.error_line(done) and "f.0002.obj" in cli.error_line(done)
    assert sorted(os.listdir("out")) == ["d.0001.vdb", "d.0003.vdb"]


def test_bad_input():
    ball_frames(moved, {1: 0.1, 2: 0.2})
    volume(12)
    names = ["deform", "rest.obj", "rest.vdb", "frames"]
    fails(2, *names, "-o", "out", says=["--output", ".vdb"])
    fails(1, *names, "-o", "a.##.##.vdb", says=["--output"])
    fails(1, "deform", "rest.obj", "no.vdb", "frames", "-o", "x.vdb", says=["no.vdb"])
    fails(1, "deform", "no.obj", "rest.vdb", "frames", "-o", "x.vdb", says=["no.obj"])
    fails(1, "deform", "rest.obj", "rest.obj", "frames", "-o", "x.vdb", *SMALL, says=["rest.obj"])
    fails(1, *names, "-o", "new/x.vdb", "--grids", "smoke", *SMALL, says=["smoke", "density"])
    fails(2, *names, "-o", "x.vdb", "--fade-to", "identity", says=["--fade-to", "--outside"])
    fails(1, *names, "-o", "x.vdb", "--fps", "0", says=["--fps"])
    innermap("voxelize", cli.cube("far.obj", 1, (50, 50, 50)), "-o", "far.vdb", "--resolution", "8",
             "--quiet")
    fails(1, "deform", "rest.obj", "far.vdb", "frames", "-o", "new/x.vdb", *SMALL, says=["rest.obj"])
    fails(2, "deform", "rest.obj", "rest.vdb", "-o", "x.vdb", says=["FRAMES"])
    ball_frames(moved, {1: 0.1, 2: 0.2})
    deform("--velocity", "--grids", "density", "--frames", "1")
    for dry in [], ["--dry-run"]:
        fails(1, "deform", "rest.obj", "out/d.0001.vdb", "frames", "-o", "y.vdb", "--velocity", *SMALL, *dry,
              says=["velocity", "--grids"])
    text = cli.dry_run(*names, "-o", "x.vdb").text
    assert "x.0001.vdb" in text and "x.0002.vdb" in text, text


def test_a_full_disk_ends_the_run():
    ball_frames(twisted, {1: 0.1, 2: 0.2, 3: 0.3})
    volume()
    fails(1, "deform", "rest.obj", "rest.vdb", "frames", "-o", "out/d.vdb", *SMALL,
          says=["d.0001.vdb", "frame 1"], preexec_fn=cli.file_size_limit(3000))
    deform("--frames", "1", output="out/d.vdb")
    whole = cli.read_file("out/d.0001.vdb")
    fails(1, "deform", "rest.obj", "rest.vdb", "frames", "-o", "out/d.vdb", *SMALL,
          says=["frame 2"], preexec_fn=cli.file_size_limit(3000))
    assert os.listdir("out") == ["d.0001.vdb"] and cli.read_file("out/d.0001.vdb") == whole


cli.run(globals())
