#!/usr/bin/env python3
"""--max-time ends what improves a result; its files and its verdict are written all the same."""

import os

from cli import ROOT, cube, fails, icosphere, innermap, no_leftovers, read_json, run
from frames import ball_frames, read_energies, twisted
from scenes import cells_and_map

AT_ONCE = ("--max-time", "1e-3", "--report", "r.json", "--quiet")
STRANGERS = tuple(ROOT / "samples" / name for name in ("sphere.obj", "gecko.obj"))


def stopped():
    report = read_json("r.json")
    assert report["stopped_by_time"] is True, report.keys()
    return report


def test_strangers_are_mapped():
    innermap("map", *STRANGERS, "-o", "out", "--resolution", 24, "--best-effort", *AT_ONCE)
    report = stopped()
    assert report["tolerance"]["ended"] == "--max-time is reached", report["tolerance"]
    assert 0 < report["tolerance"]["missed"] <= 1 and len(report["tolerance"]["worst_at"]) == 3
    assert report["verdict"], report
    assert {"map.ply", "map.vdb", "section.png"} <= set(os.listdir("out")), os.listdir("out")
    no_leftovers("out", "r.json")


def test_frames_are_left():
    ball_frames(twisted, {1: 0.0, 2: 0.2, 3: 0.4})
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "out", "--charges", 400, "--resolution", 24, *AT_ONCE)
    frames = stopped()["frames"]
    assert frames["number"] == [1] and frames["left"] == 2, frames
    assert len(read_energies("out")) == 1
    deform = ("deform", "rest.obj", "rest.obj", "frames/*.obj", "-o", "d/r.####.obj", "--charges", 400)
    innermap(*deform, *AT_ONCE)
    assert stopped()["frames"]["left"] == 2 and os.listdir("d") == ["r.0001.obj"]
    innermap(*deform, "--quiet")
    assert len(os.listdir("d")) == 3


def test_fits_end():
    pair = [ROOT / "samples" / name for name in ("gecko.obj", "gecko_step.obj")]
    innermap("fit", *pair, "-o", "m.ply", "--tolerance", "1e-5", "--best-effort", *AT_ONCE)
    assert stopped()["tolerance"]["ended"] == "--max-time is reached"
    with open("halves.obj", "w", encoding="ascii") as file:
        lines = (ROOT / "samples" / "sphere.obj").read_text(encoding="ascii").splitlines()
        faces = [line for line in lines if line.startswith("f ")]
        for line in [*(v for v in lines if v.startswith("v ")), "g a", *faces[::2], "g b", *faces[1::2]]:
            file.write(line + "\n")
    innermap("weights", "halves.obj", "-o", "w.vdb", "--groups", "a,b", "--resolution", 16, "--best-effort",
             *AT_ONCE)
    stopped()


def test_correspondences_stay_one_to_one():
    innermap("correspond", *STRANGERS, "-o", "c.ply", *AT_ONCE)
    assert stopped()["correspondence"]["flips"] == 0


def test_cells_are_written():
    cells_and_map(resolution=12)
    innermap("remesh", "map.ply", "ball.vtu", "-o", "cells.vtu", *AT_ONCE)
    report = stopped()["remesh"]
    assert report["inverted"] <= report["inverted_carried"], report
    icosphere("small.obj", 2)
    innermap("hexahedralize", "small.obj", "-o", "h.vtu", "--blocks", 3, "--max-time", 1000,
             "--report", "h.json", "--quiet")
    assert "stopped_by_time" not in read_json("h.json")


def test_a_time_is_above_0():
    cube()
    fails(1, "correspond", "cube.obj", "cube.obj", "-o", "c.ply", "--max-time", "0",
          says=["--max-time"])


run(globals())
