"""Scenes that several of the command-line tests have, and a Python that reads what they made."""

import math
import struct
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


SPLAT_NAMES = (["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"] + [f"f_rest_{i}" for i in range(9)] +
               ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"])


def write_splats(path, splats, names=None):
    """A capture of Gaussian splats, colours of degree 1: dicts by these names, 0 where they lack one."""
    names = names or SPLAT_NAMES
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(splats) +
                    "".join(f"property float {name}\n" for name in names) + "end_header\n").encode())
        for splat in splats:
            file.write(struct.pack(f"<{len(names)}f", *(splat.get(name, 0) for name in names)))
