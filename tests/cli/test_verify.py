#!/usr/bin/env python3
"""innermap verify: what a map's file claims is proven again, and edited files are found out."""

import array
import math
import os

from cli import (cube, error_line, fails, icosphere_arrays, innermap, no_leftovers, read_file, read_json, run,
                 write_file, write_obj)

PROOF = "one_to_one_proof_"


def bent(p, strength=0.3):
    return (p[0] + strength * p[2] * p[2], p[1] * (1 + 0.2 * p[2]), p[2])


def long(p):
    return (p[0], p[1], 8 * p[2])


def ringed(p):
    """That bent to a ring whose ends run through each other."""
    turn, radius = 3.5 * p[2], 16 / 7 - p[0]
    return (radius * math.cos(turn), p[1], -radius * math.sin(turn))


def fitted(path="map.ply", *options, source=lambda p: p, to=bent):
    """The file of a map of a ball, in parts."""
    vertices, faces = icosphere_arrays(3)
    write_obj("ball.obj", [source(p) for p in vertices], faces)
    write_obj("bent.obj", [to(p) for p in vertices], faces)
    innermap("fit", "ball.obj", "bent.obj", "-o", path, "--quiet", "--tolerance", "0.01", *options)
    return MapFile(path)


class MapFile:
    """A map.ply: its comments, and its charges x, y, z, w0, w1, w2, which may be edited."""

    def __init__(self, path):
        data = read_file(path)
        end = data.index(b"end_header\n") + len(b"end_header\n")
        self.header = data[:end].decode("ascii").split("\n")
        count = next(int(line.split()[2]) for line in self.header if "element vertex" in line)
        self.charges = array.array("d", data[end:end + 48 * count])
        self.rest = data[end + 48 * count:]

    def fact(self, name):
        return next(line.split(" ", 2)[2] for line in self.header
                    if line.startswith(f"comment {PROOF}{name} "))

    def claiming(self, **facts):
        """The file with other claims; None takes one out."""
        header = list(self.header)
        for name, value in facts.items():
            start = f"comment {PROOF}{name} "
            at = next(i for i, line in enumerate(header) if line.startswith(start))
            header[at:at + 1] = [] if value is None else [start + str(value)]
        return "\n".join(header).encode("ascii") + self.charges.tobytes() + self.rest

    def charged(self, change):
        """The file with the charges that change(list of numbers) leaves behind."""
        charges = array.array("d", self.charges)
        change(charges)
        return "\n".join(self.header).encode("ascii") + charges.tobytes() + self.rest


def verified(data, *options, exit_code=0):
    """Results by claim of a file of these bytes."""
    write_file("edited.ply", data)
    if os.path.exists("verify.json"):
        os.remove("verify.json")
    done = innermap("verify", "edited.ply", "--report", "verify.json", "--quiet", *options,
                    exit_code=exit_code)
    said = read_json("verify.json")["verification"]
    assert said["holds"] == (exit_code == 0), said
    results = dict(zip(said["claims"], said["results"]))
    for name, result in results.items():
        if result != "holds":
            assert f"{name} ({result})" in error_line(done), done.stderr
    return results


def refused(data, *options):
    """That it is no map: in words, exit code 1."""
    write_file("edited.ply", data)
    return fails(1, "verify", "edited.ply", *options, says=["edited.ply"])


def test_a_proven_map_is_proven_again():
    file = fitted()
    results = verified(file.claiming())
    assert set(results) == {"sense", "least", "boundary", "preimages", "agreement"}, results
    said = read_json("verify.json")["verification"]
    assert said["proven"]["proof_cells"] > 0 and "places" not in said, said
    assert verified(file.claiming(), "--sample", "0", "--require", "whole").get("agreement") is None
    assert verified(file.claiming(), "--seed", "7", "--threads", "1") == results
    no_leftovers("ball.obj", "bent.obj", "map.ply", "edited.ply", "verify.json")


def test_one_to_one_is_proven_again():
    file = fitted("map.ply", "--prove", "full")
    assert file.fact("one_to_one") == "1"
    assert verified(file.claiming())["one-to-one"] == "holds"
    assert "one-to-one" not in verified(file.claiming(one_to_one=0))
    ring = fitted("ring.ply", "--prove", "full", "--best-effort", source=long, to=ringed)
    assert ring.fact("one_to_one") == "0"
    claimed = verified(ring.claiming(one_to_one=1), exit_code=1)
    assert claimed["one-to-one"] != "holds", claimed


def test_weaker_claims_hold_and_stronger_do_not():
    file = fitted()
    error, least = float(file.fact("boundary_error")), float(file.fact("least"))
    verified(file.claiming(boundary_error=2 * error, least=least / 2, cells=1))
    smaller = verified(file.claiming(boundary_error=0.9 * error), exit_code=1)
    assert smaller["boundary"] == "fails" and smaller["sense"] == "holds", smaller
    assert smaller["preimages"] == "cannot be shown", smaller
    assert len(read_json("verify.json")["verification"]["places"]) == 3
    verified(file.claiming(least=repr(1.5 * least)))  # cells are cut until that is shown
    larger = verified(file.claiming(least=100), exit_code=1)
    assert larger["least"] == "fails" and larger["sense"] == "holds", larger
    mirrored = verified(file.claiming(mirrored=1), exit_code=1)
    assert mirrored["sense"] == "fails", mirrored


def test_claims_are_as_fits_write_them():
    file = fitted()
    for facts in ({"cells": 0}, {"cells": "nan"}, {"cells": 1.5}, {"cells": -1}, {"cells": 1e300},
                  {"mirrored": 2}, {"least": "nan"}, {"least": "inf"}, {"least": -1},
                  {"boundary_error": "inf"}, {"boundary_error": 0}, {"boundary_error": "small"},
                  {"proven_share": 1.5}, {"undecided_share": -0.5}, {"undecided": 10**12},
                  {"undecided": None}, {"cells": f"1\ncomment {PROOF}cells 1"},
                  {"cells": f"1\ncomment {PROOF}embedding 1"}):
        results = verified(file.claiming(**facts), exit_code=1)
        assert results == {"form": "fails"}, (facts, results)


def test_a_file_without_claims_says_so():
    file = fitted("map.ply", "--prove", "off")
    assert verified(file.claiming()) == {}
    said = read_json("verify.json")["verification"]
    assert said["any"] is False and "proven" not in said, said
    for what in ("proof", "whole"):
        fails(1, "verify", "map.ply", "--require", what, says=["--require"])
    fails(2, "verify", "map.ply", "--require", "luck", says=["--require"])


def test_changed_charges_are_found_out():
    file = fitted()
    boundary = float(file.fact("boundary_error"))

    def last_digits(charges):
        charges[3] *= 1 + 1e-15

    verified(file.charged(last_digits))

    def moved(charges):
        """The boundary by some 2.6 errors; det J keeps its sign."""
        charges[3] += 4 * boundary * 3.5
    results = verified(file.charged(moved), exit_code=1)
    assert results["boundary"] == "fails", results

    def inside(charges):
        charges[0:3] = array.array("d", [0.1, 0.2, 0.05])
    results = verified(file.charged(inside), exit_code=1)
    assert results["sense"] == "fails" and results["boundary"] != "holds", results
    place = read_json("verify.json")["verification"]["places"][0:3]
    assert math.dist(place, (0.1, 0.2, 0.05)) < 1e-9, place

    def on_the_surface(charges):
        charges[0:3] = array.array("d", icosphere_arrays(3)[0][5])
    results = verified(file.charged(on_the_surface), exit_code=1)
    assert results["sense"] != "holds" and results["boundary"] != "holds", results

    def cancelling(charges):
        """Two charges in one place whose weights cancel but for what the map needs."""
        charges[0:3] = charges[6:9]
        charges[3] += 1e12
        charges[9] -= 1e12
    results = verified(file.charged(cancelling), exit_code=1)
    assert results["sense"] != "holds" and results["boundary"] != "holds", results


def test_what_is_no_map_is_refused():
    file = fitted()

    def nan(charges):
        charges[4] = math.nan
    refused(file.charged(nan))
    whole = file.claiming()
    for length in (0, 100, whole.index(b"end_header") + 40, len(whole) - 1):
        refused(whole[:length])
    cube("cube.obj")
    fails(1, "verify", "cube.obj", says=["cube.obj"])
    fails(1, "verify", "none.ply", says=["none.ply"])


def test_a_mirrored_map_is_proven_again():
    file = fitted("map.ply", to=lambda p: bent((-p[0], p[1], p[2])))
    assert file.fact("mirrored") == "1"
    results = verified(file.claiming())
    assert results["sense"] == results["agreement"] == "holds", results
    assert verified(file.claiming(mirrored=0), exit_code=1)["sense"] == "fails"


def test_of_two_parts_each_point_is_proven_and_no_more():
    """One to one as a whole is not, as one part might lie in the other; the rest is."""
    vertices, faces = icosphere_arrays(2)
    other = [(x + 3, y, z) for x, y, z in vertices]
    count = len(vertices)
    both = faces + [tuple(v + count for v in face) for face in faces]
    write_obj("two.obj", vertices + other, both)
    write_obj("bent.obj", [bent(p, 0.1) for p in vertices + other], both)
    innermap("fit", "two.obj", "bent.obj", "-o", "map.ply", "--quiet", "--tolerance", "0.01", "--prove",
             "full", "--report", "fit.json")
    known = read_json("fit.json")["one_to_one"]
    assert known["parts"] == known["surfaces"] == 2, known
    assert known["proof_undecided"] == known["proof_negative"] == 0, known
    assert known["proof_one_to_one"] == 0, known
    file = MapFile("map.ply")
    assert set(verified(file.claiming())) == {"sense", "least", "boundary", "preimages", "agreement"}
    assert verified(file.claiming(one_to_one=1), exit_code=1)["one-to-one"] == "cannot be shown"


def dented(p):
    """A ball pushed in deeply; one harmonic map folds there."""
    angle = math.acos(max(-1.0, min(1.0, p[2])))
    return (p[0], p[1], p[2] - 0.85 * math.exp(-(angle / 0.6) ** 2))


def test_a_folded_map_keeps_to_what_it_says():
    file = fitted("map.ply", "--one-to-one", "off", to=dented)
    assert int(file.fact("negative")) > 0 and int(file.fact("undecided")) > 0
    results = verified(file.claiming())
    assert results["folded"] == results["undecided"] == "holds", results
    verified(file.claiming(undecided_share=1, proven_share=0.1, negative_share=0.5))
    no_folds = verified(file.claiming(undecided=0, negative=0), exit_code=1)
    assert no_folds["sense"] == "fails", no_folds
    few = ["--proof-cells", "16"]
    more = verified(file.claiming(proven_share=0.9999), *few, exit_code=1)
    assert more["sense"] == "cannot be shown", more
    smaller = verified(file.claiming(undecided_share=1e-9), *few, exit_code=1)
    assert smaller["undecided"] == "cannot be shown", smaller
    smaller = verified(file.claiming(negative_share=0), *few, exit_code=1)
    assert smaller["sense"] == "cannot be shown", smaller


def test_a_map_in_steps_is_proven_again():
    file = fitted("map.ply", "--one-to-one", "on", "--best-effort", to=dented)
    assert any(line.startswith("comment step_sources") for line in file.header)
    results = verified(file.claiming())
    assert results["sense"] == results["boundary"] == results["agreement"] == "holds", results
    error = float(file.fact("boundary_error"))
    smaller = verified(file.claiming(boundary_error=0.9 * error), exit_code=1)
    assert smaller["boundary"] == "fails", smaller


run(globals())
