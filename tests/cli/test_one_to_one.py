#!/usr/bin/env python3
"""--one-to-one: maps in steps, where one harmonic map folds."""

import math
import os
import re

from cli import fails, icosphere_arrays, innermap, no_leftovers, read_json, run, write_obj


def dented(p):
    """A ball pushed in deeply; one harmonic map folds there."""
    angle = math.acos(max(-1.0, min(1.0, p[2])))
    return (p[0], p[1], p[2] - 0.85 * math.exp(-(angle / 0.6) ** 2))


def pair(subdivisions=4):
    vertices, faces = icosphere_arrays(subdivisions)
    write_obj("ball.obj", vertices, faces)
    write_obj("dented.obj", [dented(p) for p in vertices], faces)


def mapped(*options, **others):
    innermap("map", "ball.obj", "dented.obj", "-o", "out", "--quiet", "--resolution", "48",
             "--tolerance", "0.002", *options, **others)
    return read_json("out/report.json")


def test_one_map_folds_and_steps_do_not():
    """One map in steps, looked at in each way: it takes ten seconds to make."""
    pair()
    report = mapped("--one-to-one", "off")
    assert report["jacobian"]["folded_fraction"] > 0.005, report["jacobian"]
    assert report["inside"]["folded"] > 0.005 and report["steps"]["count"] == 1, report["inside"]
    report = mapped()
    check_steps(report)
    check_statement(report)
    check_what_takes_maps_takes_steps(report)


def check_steps(report):
    assert report["steps"]["count"] > 1 and report["steps"]["to"][-1] == 1, report["steps"]
    assert os.path.getsize("out/steps.png") > 10000
    # Single points beside the surface, as many as `auto` lets be.
    assert report["inside"]["folded"] <= 4e-4, report["inside"]
    assert report["jacobian"]["folded_fraction"] < 1e-4, report["jacobian"]
    assert report["tolerance"]["met"], report["tolerance"]
    assert report["notes"], report


def check_statement(report):
    """It stands in report and grids, and a saved map knows what was checked when it was fitted."""
    known = report["one_to_one"]
    assert known["inside_checked"] == report["inside"]["samples"], known
    assert known["voxels_checked"] == report["grid"]["interior_voxels"], known
    assert known["boundary_checked"] == 10000 and known["cells_checked"] > 0, known
    assert known["degree_least"] == known["degree_greatest"] == 1, known
    assert known["source_crossings_at"] == known["target_crossings_at"] == [], known
    assert known["statement"] in innermap("info", "out/map.vdb", "--metadata").stdout
    innermap("evaluate", "out/map.ply", "-o", "again.vdb", "--resolution", "48", "--quiet",
             "--report", "again.json")
    places = known.pop("proof_places", [])  # are not kept in the file
    unproven = known["proof_undecided"] + known["proof_negative"]
    assert known["proof_cells"] > 0 and (places != []) == (unproven > 0), known
    assert read_json("again.json")["one_to_one"] == known


def test_a_fit_says_what_it_knows():
    """No voxels were looked at."""
    pair(3)
    innermap("fit", "ball.obj", "dented.obj", "-o", "m.ply", "--quiet", "--tolerance", "0.01",
             "--report", "fit.json")
    known = read_json("fit.json")["one_to_one"]
    assert known["inside_checked"] > 0 and "voxels_checked" not in known, known


def test_a_target_that_runs_through_itself_is_told_apart():
    """A ball whose poles have passed through one another."""
    vertices, faces = icosphere_arrays(4)
    write_obj("ball.obj", vertices, faces)
    write_obj("through.obj", [(p[0], p[1], p[2] - 1.6 * math.copysign(
        math.exp(-(math.acos(min(1.0, abs(p[2]))) / 0.4) ** 2), p[2])) for p in vertices], faces)
    innermap("map", "ball.obj", "through.obj", "-o", "out", "--quiet", "--resolution", "32",
             "--best-effort", "--max-steps", "2")
    report = read_json("out/report.json")
    known = report["one_to_one"]
    assert report["target"]["self_intersections"] > 0
    assert len(known["target_crossings_at"]) == 3 * 16, known
    assert 0 < known["inside_folded_at_overlap"] <= known["inside_folded"], known
    share = known["inside_folded_at_overlap"] / known["inside_checked"]
    assert abs(report["inside"]["folded_at_overlap"] - share) < 1e-12, report["inside"]


def check_what_takes_maps_takes_steps(report):
    innermap("info", "out/map.ply")
    again = read_json("again.json")
    for section in ("energy", "jacobian", "grid"):
        assert report[section] == again[section], (report[section], again[section])
    innermap("voxelize", "ball.obj", "-o", "ball.vdb", "--resolution", "48", "--fog", "--quiet")
    innermap("push", "out/map.ply", "ball.vdb", "-o", "there.vdb", "--densities", "density",
             "--report", "push.json", "--quiet")
    push = read_json("push.json")
    assert push["inverse"]["inverted_fraction"] > 0.998, push["inverse"]
    # Below the dent volumes shrink three hundredfold, within a few of these voxels.
    mass, densities = push["mass"], push["densities"]
    assert abs(mass["density_after"] / mass["density_before"] - 1) < 1e-3, mass
    assert mass["density_left"] < 1e-6 * mass["density_before"], mass
    assert 2 < densities["density_largest_ratio"] < 300, densities
    assert densities["density_folded_cells"] < 1e-3 * densities["density_cells"], densities
    innermap("pull", "out/map.ply", "there.vdb", "-o", "back.vdb", "--quiet")
    innermap("transfer-distance", "out/map.ply", "-o", "distance", "--resolution", "32", "--quiet")
    assert read_json("distance/report.json")["distance"]["outside_fraction"] < 0.01


def bumps():
    """A ball with a sharp dent: its single map folds a few voxels about it, beside the surface."""
    vertices, faces = icosphere_arrays(4)
    write_obj("ball.obj", vertices, faces)
    write_obj("dented.obj", [(p[0], p[1], p[2] - 0.3 * math.exp(-(math.acos(
        max(-1.0, min(1.0, p[2]))) / 0.22) ** 2)) for p in vertices], faces)


def test_folds_of_a_few_voxels_are_repaired():
    bumps()
    innermap("map", "ball.obj", "dented.obj", "-o", "out", "--quiet", "--resolution", "64",
             "--tolerance", "0.004", "--one-to-one", "off", "--best-effort", "--repair", "off")
    before = read_json("out/report.json")
    assert "repair" not in before and before["jacobian"]["min"] < 0, before["jacobian"]
    for when in ("on", "auto", "off"):
        innermap("evaluate", "out/map.ply", "-o", f"{when}.vdb", "--resolution", "64", "--quiet",
                 "--repair", when, "--report", f"{when}.json")
    after, single = read_json("on.json"), read_json("off.json")
    assert read_json("auto.json")["repair"] == after["repair"]
    assert after["repair"]["folded_voxels"] > 0 and after["repair"]["left"] == 0, after["repair"]
    assert after["jacobian"]["min"] > 0, after["jacobian"]
    assert 0 < after["repair"]["farthest"] < 0.3, after["repair"]
    assert "repair" not in single and single["jacobian"] == before["jacobian"], single
    for when, repaired in (("on", True), ("auto", True), ("off", False)):
        grids = re.findall(r"^ *(\w+): ", innermap("info", f"{when}.vdb").stdout, re.M)
        assert ("repaired" in grids) == repaired, (when, grids)


def test_what_cannot_be_one_to_one_is_said():
    pair()
    done = innermap("map", "ball.obj", "dented.obj", "-o", "out", "--quiet", "--resolution", "32",
                    "--one-to-one", "on", "--max-steps", "1", exit_code=1)
    assert "--one-to-one" in done.stderr, done.stderr
    assert len(read_json("out/report.json")["inside"]["folded_at"]) >= 3
    assert os.path.exists("out/map.vdb")
    fails(1, "fit", "ball.obj", "dented.obj", "-o", "m.ply", "--one-to-one", "on", "--charges",
          "300", says=["--one-to-one"])
    no_leftovers("ball.obj", "dented.obj", "out")


run(globals())
