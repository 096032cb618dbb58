"""Scenes that several of the command-line tests have, and a Python that reads what they made."""

import math
import struct
import zlib

from cli import icosphere_arrays, innermap, write_file, write_obj


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


def kinked(p):
    """Smooth but for a fold beside (1, 0, 0)."""
    x, y, z = p
    near = math.exp(-6 * ((x - 1) ** 2 + y * y + z * z))
    return (x + 0.2 * abs(y) * near, y + 0.1 * x * z, z)


def cells_and_map(function=dent, resolution=24):
    """map.ply from ball.obj to target.obj, and the ball's tetrahedra, ball.vtu."""
    fitted_ball(function, sources=600)
    innermap("tetrahedralize", "ball.obj", "-o", "ball.vtu", "--resolution", resolution, "--quiet")


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


def write_png(path, size, colour):
    """colour(u, v) in 0..1, v upward; 8 bits, said to be sRGB."""
    width, height = size
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            rows += bytes(round(255 * c) for c in colour((x + 0.5) / width, 1 - (y + 0.5) / height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + \
            struct.pack(">I", zlib.crc32(kind + data))

    write_file(path, b"\x89PNG\r\n\x1a\n" +
                     chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                     chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(bytes(rows))) +
                     chunk(b"IEND", b""))
    return path


def write_mesh(path, vertices, faces, uvs, uv_faces):
    """uv_faces: a tuple of indices into uvs for each face, or None."""
    with open(path, "w", encoding="ascii") as file:
        for v in vertices:
            file.write("v {:.17g} {:.17g} {:.17g}\n".format(*v))
        for uv in uvs:
            file.write("vt {:.17g} {:.17g}\n".format(*uv))
        for face, uv in zip(faces, uv_faces):
            corners = [str(i + 1) for i in face] if uv is None else \
                [f"{i + 1}/{j + 1}" for i, j in zip(face, uv)]
            file.write("f " + " ".join(corners) + "\n")
    return path


MAJOR, MINOR = 1.0, 0.5


def unrolled_ring(path="ring.obj", n=64, m=32):
    """A torus about z, u around the axis and v around the tube: one chart that meets itself along
    two circles, where u and v jump from 1 to 0."""
    vertices, uvs, faces, uv_faces = [], [], [], []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
            r = MAJOR + MINOR * math.cos(b)
            vertices.append((r * math.cos(a), r * math.sin(a), MINOR * math.sin(b)))
    for i in range(n + 1):
        for j in range(m + 1):
            uvs.append((i / n, j / m))
    for i in range(n):
        for j in range(m):
            quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            for k, l in [(1, 2), (2, 3)]:
                corners = [quad[0], quad[k], quad[l]]
                faces.append(tuple(x % n * m + y % m for x, y in corners))
                uv_faces.append(tuple(x * (m + 1) + y for x, y in corners))
    return write_mesh(path, vertices, faces, uvs, uv_faces)


def around(u, v):
    """Meets itself on all sides."""
    return 0.5 + 0.4 * math.cos(2 * math.pi * u), 0.5 + 0.3 * math.sin(2 * math.pi * v), 0.5
