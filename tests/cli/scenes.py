"""Scenes that several of the command-line tests have, and a Python that reads what they made."""

import math
import subprocess

from cli import Skip, icosphere_arrays, innermap, write_obj


def swirl(p):
    """Twisted about z, stretched and moved."""
    x, y, z = p
    a = 0.6 * z
    return (1.2 * (math.cos(a) * x - math.sin(a) * y) + 4,
            1.2 * (math.sin(a) * x + math.cos(a) * y), 1.1 * z)


def fitted_ball(function=swirl, *options, subdivisions=4, sources=400):
    """map.ply from ball.obj to target.obj."""
    vertices, faces = icosphere_arrays(subdivisions)
    write_obj("ball.obj", vertices, faces)
    write_obj("target.obj", [function(p) for p in vertices], faces)
    innermap("fit", "ball.obj", "target.obj", "-o", "map.ply", "--charges", sources, *options,
             "--quiet")


def dent(p):
    """A ball's upper side pushed in so deep that the harmonic map folds."""
    x, y, z = p
    return (x, y, z - 0.9 * math.exp(-(x * x + y * y) / 0.15)) if z > 0 else p


def cells_and_map(function=dent, resolution=24):
    """map.ply from ball.obj to target.obj, and the ball's tetrahedra, ball.vtu."""
    fitted_ball(function, sources=600)
    innermap("tetrahedralize", "ball.obj", "-o", "ball.vtu", "--resolution", resolution, "--quiet")


def debian_python(script, *arguments):
    """What a script prints with Debian's Python; skips where a module is missing."""
    done = subprocess.run(["/usr/bin/python3", "-c", script, *map(str, arguments)],
                          capture_output=True, text=True, check=False)
    if "No module" in done.stderr:
        raise Skip(done.stderr.strip().split("\n")[-1])
    assert done.returncode == 0, done.stderr
    return done.stdout
