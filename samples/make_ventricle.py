#!/usr/bin/env python3
"""Makes the mesh of a heart's left ventricle: a half ellipsoid with a cavity, cut flat at the base. The OBJ has
the groups inside, outside, base and apex. World units are centimetres.

    samples/make_ventricle.py OUT.obj [CORNERS]      corners around the axis; 96 unless given
"""
import math
import sys

ACROSS, DEEP, THICK = 2.5, 6.5, 1.0  # half axes of the cavity, and the wall
APEX = 0.93  # the share of the wall under the cavity from which on the outside is the apex


def bowl(vertices, radius, depth, around, along):
    """Adds an ellipsoid's half from the base down; the rings of its vertices and its triangles."""
    first = len(vertices)
    for i in range(along):
        t = 0.5 * math.pi * i / along
        for j in range(around):
            a = 2 * math.pi * j / around
            vertices.append((radius * math.cos(t) * math.cos(a), radius * math.cos(t) * math.sin(a),
                             -depth * math.sin(t)))
    tip = len(vertices)
    vertices.append((0.0, 0.0, -depth))
    rings = [[first + i * around + j % around for j in range(around + 1)] for i in range(along)]
    faces = []
    for upper, lower in zip(rings, rings[1:]):
        for j in range(around):
            faces += [(upper[j], lower[j], lower[j + 1]), (upper[j], lower[j + 1], upper[j + 1])]
    faces += [(rings[-1][j], tip, rings[-1][j + 1]) for j in range(around)]
    return rings[0], faces


def ventricle(around=96, along=40):
    """Vertices, and a list of triangles for each group."""
    vertices = []
    outer, outside = bowl(vertices, ACROSS + THICK, DEEP + THICK, around, along)
    inner, inside = bowl(vertices, ACROSS, DEEP, around, along)
    groups = {"outside": [], "apex": [], "inside": [face[::-1] for face in inside], "base": []}
    for face in outside:
        low = sum(vertices[v][2] for v in face) / 3 < -(DEEP + APEX * THICK)
        groups["apex" if low else "outside"].append(face)
    for j in range(around):
        groups["base"] += [(outer[j], outer[j + 1], inner[j]), (inner[j], outer[j + 1], inner[j + 1])]
    return vertices, groups


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    around = int(sys.argv[2]) if len(sys.argv) > 2 else 96
    vertices, groups = ventricle(around, max(8, around * 5 // 12))
    with open(sys.argv[1], "w", encoding="ascii") as file:
        file.write("# a left ventricle, made by samples/make_ventricle.py\n")
        for v in vertices:
            file.write("v {:.9g} {:.9g} {:.9g}\n".format(*v))
        for name, faces in groups.items():
            file.write(f"g {name}\n")
            for face in faces:
                file.write("f {} {} {}\n".format(*(i + 1 for i in face)))


if __name__ == "__main__":
    main()
