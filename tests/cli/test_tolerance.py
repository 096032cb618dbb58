#!/usr/bin/env python3
"""--tolerance: charges where the error is, and what is said when it cannot be met."""

import os

from cli import (MODELS, Skip, error_line, fails, icosphere_arrays, innermap, no_leftovers,
                 read_json, run, write_obj)
from scenes import kinked


def pair(function=kinked, subdivisions=4):
    vertices, faces = icosphere_arrays(subdivisions)
    write_obj("ball.obj", vertices, faces)
    write_obj("target.obj", [function(p) for p in vertices], faces)


def fit(*options, **others):
    done = innermap("fit", "ball.obj", "target.obj", "-o", "m.ply", "--quiet", "--report",
                    "r.json", *options, **others)
    return done, read_json("r.json")


def test_tolerance_is_the_default_and_met():
    pair()
    _, report = fit()
    assert report["tolerance"] == {"wanted": 0.001, "met": True,
                                   "reached": report["boundary_error"]["p99"]}, report["tolerance"]
    _, report = fit("--tolerance", "2e-4", "--interpolation", "linear")
    assert report["solve"]["method"] == "adaptive", report["solve"]
    assert report["tolerance"]["met"] and report["boundary_error"]["p99"] <= 2e-4, report
    assert report["boundary_error"]["max"] < 5 * 2e-4, report
    told = innermap("info", "m.ply", "--metadata").stdout
    assert "tolerance: 0.0002" in told and "tolerance_met: true" in told, told


def test_more_is_asked_more_charges_are_placed():
    pair()
    sources = [fit("--tolerance", t, "--interpolation", "linear")[1]["solve"]["sources"]
               for t in ["1e-3", "1e-4", "3e-5"]]
    assert sources[0] <= sources[1] < sources[2], sources


def test_smooth_vertices_stay_exact():
    pair(lambda p: (p[0] * p[0] - p[1] * p[1], p[0] * p[1], p[0] + 2 * p[1] * p[2]),
         subdivisions=5)
    _, report = fit()
    assert report["tolerance"]["met"], report["tolerance"]
    assert report["solve"]["interpolation"] == "smooth", report["solve"]
    assert report["boundary_error"]["vertices_rms"] < 1e-9, report["boundary_error"]


def test_not_met_is_said_and_files_are_written():
    pair()
    # The error's line, also with --quiet; the files, marked.
    options = ("--tolerance", "1e-6", "--max-charges", "1200", "--interpolation", "linear")
    done, report = fit(*options, exit_code=1)
    for text in ["--tolerance 1e-06 is not met", "--max-charges 1200", "--best-effort"]:
        assert text in error_line(done), done.stderr
    assert report["tolerance"]["met"] is False, report["tolerance"]
    assert report["tolerance"]["reached"] == report["boundary_error"]["p99"] > 1e-6, report
    assert report["solve"]["sources"] <= 1200, report["solve"]
    assert "tolerance_met: false" in innermap("info", "m.ply", "--metadata").stdout
    done, report = fit(*options, "--best-effort")
    assert report["tolerance"]["met"] is False, report["tolerance"]
    assert any("not met" in warning for warning in report["warnings"]), report["warnings"]


def test_map_marks_its_grids():
    pair()
    for wanted, met, code in [("1e-6", "false", 1), ("1e-3", "true", 0)]:
        innermap("map", "ball.obj", "target.obj", "-o", wanted, "--tolerance", wanted, "--quiet",
                 "--max-charges", "1200", "--resolution", "24", exit_code=code)
        assert sorted(os.listdir(wanted)) == ["map.ply", "map.vdb", "report.json", "section.png",
                                              "slices.exr"], os.listdir(wanted)
        told = innermap("info", f"{wanted}/map.vdb", "--metadata").stdout
        assert f"innermap_tolerance_met: {met}" in told.replace(" = ", ": "), told
        report = read_json(f"{wanted}/report.json")
        assert report["tolerance"]["met"] is (met == "true"), report["tolerance"]


def test_bad_settings():
    pair(subdivisions=2)
    command = ("fit", "ball.obj", "target.obj", "-o", "m.ply")
    for bad in ["0", "-1", "-1e-3", "1e-13", "2"]:
        fails(1, *command, "--tolerance", bad, says=["--tolerance", "out of range"])
    for bad in ["nan", "inf", "small"]:
        fails(2, *command, "--tolerance", bad, says=["--tolerance"])
    fails(1, *command, "--distance", "0.1", "--radius-ratio", "2", says=["--distance", "--radius-ratio"])
    for option, value in [("--charges", "300"), ("--charge-ratio", "1"), ("--collocation", "900"),
                          ("--collocation-ratio", "2"), ("--distance", "0.1"),
                          ("--radius-ratio", "2"), ("--solver", "dense"), ("--method", "tsvd"),
                          ("--regularization", "1e-3")]:
        fails(2, *command, "--tolerance", "1e-3", option, value, says=["--tolerance", option])
    fails(1, *command, "--max-charges", "3", says=["--max-charges"])
    fails(1, *command, "--max-memory", "70M", says=["--max-memory"])


def test_options_of_the_uniform_way_need_no_tolerance():
    pair(subdivisions=3)
    for options in [("--charges", "300"), ("--distance", "0.1", "--charge-ratio", "0.3")]:
        _, report = fit(*options)
        assert "tolerance" not in report and report["solve"]["placement"] == "shell", report


def test_limit_of_memory_is_kept():
    pair()
    _, report = fit("--tolerance", "1e-7", "--max-memory", "340M", "--best-effort",
                    "--interpolation", "linear")
    assert report["tolerance"]["met"] is False, report["tolerance"]
    assert report["peak_memory_bytes"] < 340e6, report["peak_memory_bytes"]


def test_dry_run_says_what_would_be_done():
    pair(subdivisions=2)
    told = innermap("fit", "ball.obj", "target.obj", "-o", "m.ply", "--tolerance", "1e-4",
                    "--dry-run").stdout
    assert "0.0001" in told and "100000 charges" in told, told
    no_leftovers("ball.obj", "target.obj")


def test_horse():
    if not MODELS.exists():
        raise Skip("no ../shared/models")
    poses = MODELS / "horse-poses"
    innermap("fit", poses / "reference.obj", poses / "pose-03.obj", "-o", "m.ply", "--quiet",
             "--report", "r.json")
    report = read_json("r.json")
    assert report["tolerance"]["met"] and report["solve"]["sources"] <= 8000, report
    assert report["boundary_error"]["max"] < 20 * report["boundary_error"]["rms"], report


run(globals())
