#!/usr/bin/python3
"""Makes the sample meshes sphere.obj and torus.obj, which other solids are mapped onto: a unit ball
(an icosahedron, its triangles cut in four four times) and a torus about the z axis.

    samples/make_shapes.py [FOLDER]

Tests make their balls and tori by the functions here.
"""
import math
import os
import sys



def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def sphere(levels=4, evenly=True):
    """(vertices, faces) of a unit ball: an icosahedron, each triangle cut in four `levels` times.
    Evenly: vertices go onto the sphere after each cut, else after the last."""
    t = (1 + math.sqrt(5)) / 2
    vertices = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t),
                (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    vertices = [unit(v) for v in vertices]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                p = tuple((x + y) / 2 for x, y in zip(vertices[a], vertices[b]))
                vertices.append(unit(p) if evenly else p)
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return [unit(v) for v in vertices], faces


def torus(around=90, across=36, major=1.0, minor=0.4):
    vertices, faces = [], []
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = major + minor * math.cos(v)
            vertices.append((r * math.cos(u), r * math.sin(u), minor * math.sin(v)))
            here, there = i * across, (i + 1) % around * across
            up = (j + 1) % across
            faces += [(here + j, there + j, there + up), (here + j, there + up, here + up)]
    return vertices, faces


def write(path, what, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"# {what}, made by samples/make_shapes.py\n")
        for v in vertices:
            file.write("v {:.7g} {:.7g} {:.7g}\n".format(*v))
        for f in faces:
            file.write("f {} {} {}\n".format(*(i + 1 for i in f)))


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    write(os.path.join(folder, "sphere.obj"), "a unit ball", *sphere())
    write(os.path.join(folder, "torus.obj"), "a torus", *torus())


if __name__ == "__main__":
    main()
