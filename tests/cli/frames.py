"""Frames of a moving ball for the tests of sequence and deform."""

import csv
import math
import os

import cli

FIGURES = ["harmonic", "deformation", "deformation_mean", "boundary_rms", "boundary_p99",
           "boundary_max", "jacobian_min", "jacobian_max", "folded_fraction", "volume", "seconds"]


def rotated(v, angle):
    c, s = math.cos(angle), math.sin(angle)
    return (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def rigid(v, t):
    """Turned about z by t radians and moved."""
    x, y, z = rotated(v, t)
    return (x + 0.5 * t, y - t, z + 2 * t)


def twisted(v, t):
    return rotated(v, t * v[2])


def moved(v, t):
    return (v[0] + t, v[1] - 2 * t, v[2] + 0.5 * t)


def ball_frames(motion, times, name="frames/f.{:04d}.obj", subdivisions=3):
    """rest.obj and a file for each number: time in `times`."""
    vertices, faces = cli.icosphere_arrays(subdivisions)
    cli.write_obj("rest.obj", vertices, faces)
    for number, t in times.items():
        path = name.format(number)
        os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
        cli.write_obj(path, [motion(v, t) for v in vertices], faces)


def break_frame(path):
    cli.write_file(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")


def read_energies(folder):
    """Rows of energies.csv with figures as numbers, None where they are missing."""
    with open(os.path.join(folder, "energies.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        assert None not in row and None not in row.values(), row
        row["frame"] = int(row["frame"])
        for key in FIGURES:
            row[key] = float(row[key]) if row[key] else None
    return rows
