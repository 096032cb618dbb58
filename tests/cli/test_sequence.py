#!/usr/bin/env python3
"""innermap sequence: the energies of an animation."""

import math
import os

import cli
from cli import alone, fails, innermap, nightly, no_leftovers
from frames import FIGURES, ball_frames, break_frame, moved, read_energies, rigid, twisted

SMALL = ["--charges", "400", "--resolution", "24", "--quiet"]


def test_rigid_frames_have_no_energy():
    ball_frames(rigid, {1: 0.0, 2: 0.7, 3: 2.0, 10: math.pi})
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "out", *SMALL)
    rows = read_energies("out")
    assert [r["frame"] for r in rows] == [1, 2, 3, 10]
    for r in rows:
        assert abs(r["harmonic"] - 3) < 0.02, r  # of the grid's volume
        assert 0 <= r["deformation"] < 1e-12, r
        assert r["boundary_max"] < 1e-9 and r["folded_fraction"] == 0, r
        assert abs(r["jacobian_min"] - 1) < 1e-6 and abs(r["jacobian_max"] - 1) < 1e-6, r
        assert abs(r["volume"] / rows[0]["volume"] - 1) < 1e-9, r


def test_energies_are_those_of_map():
    ball_frames(twisted, {4: 0.3, 5: 0.6, 6: 0.9})
    innermap("sequence", "rest.obj", "frames", "-o", "out", "--charges", "1500",
             "--resolution", "48", "--quiet")
    rows = read_energies("out")
    assert rows[0]["deformation"] < rows[1]["deformation"] < rows[2]["deformation"]
    innermap("map", "rest.obj", "frames/f.0005.obj", "-o", "map", "--resolution", "48", "--quiet")
    report = cli.read_json("map/report.json")
    assert abs(rows[1]["harmonic"] / report["energy"]["harmonic"] - 1) < 2e-3
    assert abs(rows[1]["deformation"] / report["energy"]["deformation"] - 1) < 2e-2
    # A twist about z keeps the volume and every plane of constant z.
    assert abs(rows[1]["jacobian_min"] - 1) < 0.1 and abs(rows[1]["jacobian_max"] - 1) < 0.1


def test_what_is_written():
    ball_frames(twisted, {1: 0.0, 2: 0.2, 3: 0.4})
    innermap("sequence", "rest.obj", "frames/f.####.obj", "-o", "a/out", "--charges", "400",
             "--resolution", "24")
    assert sorted(os.listdir("a/out")) == ["energies.csv", "energies.svg", "report.json"]
    chart = cli.read_file("a/out/energies.svg").decode()
    assert chart.startswith("<svg") and chart.endswith("</svg>\n") and chart.count("<polyline") == 2
    report, rows = cli.read_json("a/out/report.json"), read_energies("a/out")
    assert report["frames"]["number"] == [1, 2, 3] and report["frames"]["broken"] == []
    assert report["frames"]["file"] == [r["file"] for r in rows]
    for key in FIGURES:
        for got, row in zip(report["energies"][key], rows):
            assert abs(got - row[key]) <= 1e-8 * abs(got), key
    assert report["solve"]["sources"] == 400 and report["source"]["path"] == "rest.obj"
    assert report["frames"]["seconds_least"] <= report["frames"]["seconds_mean"]
    assert report["worst_boundary_error"]["max"] == max(report["energies"]["boundary_max"])
    for stage in ["read", "solid", "sample", "factor", "solve", "certificate", "evaluate"]:
        assert report["seconds"][stage] >= 0


def test_each_frame_says_what_is_proven():
    ball_frames(twisted, {1: 0.2, 2: 0.4})
    innermap("sequence", "rest.obj", "frames", "-o", "out", "--prove", "full", *SMALL)
    rows, energies = read_energies("out"), cli.read_json("out/report.json")["energies"]
    for i, row in enumerate(rows):
        assert int(row["proof_cells"]) > 0 and float(row["proof_one_to_one"]) == 1, row
        assert float(row["proof_undecided"]) == float(row["proof_negative"]) == 0, row
        assert float(row["proof_proven_share"]) == 1 and float(row["proof_least"]) > 0, row
        assert row["boundary_max"] <= float(row["proof_boundary_error"]) < 1.1 * row["boundary_max"], row
        assert row["statement"] == energies["statement"][i] != "", row
    assert rows[0]["statement"] != rows[1]["statement"]
    innermap("sequence", "rest.obj", "frames", "-o", "off", "--prove", "off", *SMALL)
    for row in read_energies("off"):
        assert row["proof_cells"] == row["proof_boundary_error"] == row["statement"] == "", row


def test_grids_of_each_frame():
    ball_frames(twisted, {1: 0.1, 120: 0.2, 12345: 0.3})
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "out", "--grids", *SMALL)
    names = ["energy.0001.vdb", "energy.0120.vdb", "energy.12345.vdb"]
    assert sorted(os.listdir("out")) == ["energies.csv", "energies.svg", *names, "report.json"]
    text = innermap("info", "out/energy.0120.vdb", "--metadata").stdout
    assert "harmonic_energy: float" in text and "deformation_energy: float" in text
    assert "surface" not in text and "jacobian:" not in text
    done = innermap("sequence", "rest.obj", "frames/f.0001.obj", "-o", "all", "--grids", "--grid-list",
                    "surface,density,map,jacobian", *SMALL[:-1])
    assert "--grids=LIST" in done.stderr
    text = innermap("info", "all/energy.0001.vdb", "--metadata").stdout
    for line in ["surface: float, level set", "density: float, fog volume", "map: vec3s",
                 "jacobian: float"]:
        assert line in text, text
    assert "harmonic_energy: float" not in text
    innermap("sequence", "rest.obj", "frames/f.0001.obj", "-o", "again",
             "--grids=surface,density,map,jacobian", *SMALL)
    with open("all/energy.0001.vdb", "rb") as a, open("again/energy.0001.vdb", "rb") as b:
        assert a.read() == b.read()
    fails(2, "sequence", "rest.obj", "frames", "-o", "b", "--grids=jacobain",
          says=["--grids", "jacobain", "jacobian"])


def test_a_broken_frame_is_reported_and_the_others_go_on():
    ball_frames(twisted, {n: 0.1 * n for n in range(1, 8)})
    break_frame("frames/f.0002.obj")
    cli.write_file("frames/f.0004.obj", "v 1 nan 2\n")
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("frames/f.0006.obj", [(1, 2, 3)] * len(vertices), faces)
    cli.write_obj("frames/f.0007.obj", [(v[0], v[1], 0) for v in vertices], faces)
    done = innermap("sequence", "rest.obj", "frames/*.obj", "-o", "out", "--charges", "400",
                    "--resolution", "24", exit_code=1)
    assert "4 of 7 frames" in cli.error_line(done) and "2, 4, 6, 7" in cli.error_line(done)
    assert done.stderr.count("is left out") == 4
    rows = read_energies("out")
    assert [r["frame"] for r in rows] == [1, 2, 3, 4, 5, 6, 7]
    assert [r["frame"] for r in rows if r["error"]] == [2, 4, 6, 7]
    assert [r["frame"] for r in rows if r["harmonic"] is not None] == [1, 3, 5]
    assert len(cli.read_json("out/report.json")["frames"]["broken"]) == 4
    for n in [1, 3, 5]:
        break_frame(f"frames/f.{n:04d}.obj")
    fails(1, "sequence", "rest.obj", "frames/*.obj", "-o", "none", *SMALL,
          says=["none of the 7 frames", "f.0001.obj"])


def test_a_frame_does_not_depend_on_the_others():
    ball_frames(twisted, {n: 0.1 * n for n in range(1, 7)})
    options = ["--charges", "3500", "--resolution", "24", "--quiet"]  # iterative
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "all", *options)
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "some", "--frames", "2-6x3", *options,
             "--threads", "1")
    alone = {r["frame"]: r for r in read_energies("some")}
    assert sorted(alone) == [2, 5]
    for row in read_energies("all"):
        if row["frame"] in alone:
            for key in FIGURES[:-1]:
                assert row[key] == alone[row["frame"]][key], (row["frame"], key)


def test_which_frames():
    ball_frames(moved, {1: 0.1, 2: 0.2, 10: 1.0})
    ball_frames(moved, {3: 0.3}, name="b/g.-{:03d}.obj")
    ball_frames(moved, {2: 0.3}, name="b/h.{:02d}.obj")

    def numbers(*arguments):
        innermap("sequence", "rest.obj", *arguments, "-o", "out", *SMALL)
        return [r["frame"] for r in read_energies("out")]

    assert numbers("frames/f.0010.obj", "frames/f.0001.obj") == [1, 10]
    assert numbers("frames/f.%04d.obj", "b/g.*.obj") == [-3, 1, 2, 10]
    assert numbers("frames", "--frames", "2-9,10") == [2, 10]
    assert numbers("f*/?.???0.obj") == [10]
    innermap("sequence", "rest.obj", "*.obj", "frames/*", "-o", "out", *SMALL)  # the rest pose too
    fails(1, "sequence", "rest.obj", "frames/f.*.obj", "b/h.*.obj", "-o", "x",
          says=["f.0002.obj", "h.02.obj"])
    fails(1, "sequence", "rest.obj", "no/*.obj", "-o", "x", says=["no/*.obj"])
    fails(1, "sequence", "rest.obj", "frames/f.0009.obj", "-o", "x", says=["f.0009.obj"])
    fails(1, "sequence", "rest.obj", "frames", "-o", "x", "--frames", "20-30",
          says=["--frames", "1 to 10"])
    fails(1, "sequence", "rest.obj", "frames", "-o", "x", "--frames", "1..3", says=["--frames"])
    fails(2, "sequence", "rest.obj", "-o", "x", says=["FRAMES"])
    fails(1, "sequence", "no.obj", "frames", "-o", "x", says=["no.obj"])


def test_limits_and_dry_run():
    ball_frames(moved, {1: 0.1, 2: 0.2})
    assert "8000" in cli.dry_run("sequence", "rest.obj", "frames", "-o", "x").text
    fails(1, "sequence", "rest.obj", "frames", "-o", "x", "--max-memory", "270MB",
          says=["--charges"])
    fails(1, "sequence", "rest.obj", "frames", "-o", "x", "--distance", "0.5",
          says=["--distance", "4 spacings"])
    no_leftovers("rest.obj", "frames")


def minima(values):
    """Places in the row that are lower than all within five to either side."""
    return [i for i, v in enumerate(values) if v == min(values[max(0, i - 5):i + 6])]


@nightly
def test_the_gallop_has_four_cycles():
    gallop = cli.MODELS / "horse-gallop"
    if not gallop.exists():
        raise cli.Skip(f"no models at {gallop}")
    innermap("sequence", gallop / "reference.obj", gallop / "frame.####.obj", "-o", "out",
             "--resolution", "96", "--quiet", timeout=900)
    rows = read_energies("out")
    assert [r["frame"] for r in rows] == list(range(1, 49))
    assert max(r["boundary_rms"] for r in rows) < 1e-3
    for energy in ["harmonic", "deformation"]:
        found = [rows[i]["frame"] for i in minima([r[energy] for r in rows])]
        found = [n for n in found if n < 48]
        assert len(found) == 4, (energy, found)
        # The legs are least stretched in frames 2 to 3, 14 to 15 and so on (the triangles' own
        # strain says so too).
        for n, expected in zip(found, [2.5, 14.5, 26.5, 38.5]):
            assert abs(n - expected) <= 1, (energy, found)


cli.run(globals())
