#!/usr/bin/env python3
"""innermap fit: the solver and the interpolation asked for are those used, and agree."""

from cli import icosphere_arrays, innermap, read_json, run, write_obj


def creased_pair():
    """ball.obj and target.obj, which has a kink across its middle."""
    vertices, faces = icosphere_arrays(4)
    write_obj("ball.obj", vertices, faces)
    write_obj("target.obj", [(x + 0.3 * abs(y), y, z) for x, y, z in vertices], faces)


def fitted(*options):
    innermap("fit", "ball.obj", "target.obj", "-o", "m.ply", "--quiet", "--report", "r.json",
             "--charges", "800", *options)
    return read_json("r.json")


def test_the_solver_asked_for_is_used():
    creased_pair()
    dense = fitted("--solver", "dense", "--interpolation", "linear")
    iterative = fitted("--solver", "iterative", "--interpolation", "linear")
    assert dense["solve"]["method"] == "tikhonov", dense["solve"]
    assert dense["solve"]["iterations"] == 0, dense["solve"]
    assert iterative["solve"]["method"] == "iterative", iterative["solve"]
    assert 1 <= iterative["solve"]["iterations"] <= 8, iterative["solve"]
    errors = [r["boundary_error"]["rms"] for r in (dense, iterative)]
    assert errors[1] <= 1.5 * errors[0], errors


def test_the_interpolation_asked_for_is_used():
    creased_pair()
    for name in ("linear", "smooth"):
        report = fitted("--solver", "dense", "--interpolation", name)
        assert report["solve"]["interpolation"] == name, report["solve"]


run(globals())
