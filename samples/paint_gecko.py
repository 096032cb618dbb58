#!/usr/bin/env python3
"""Paints gecko.obj: rings of colour along the body, as colours of the vertices.

    samples/paint_gecko.py OUT.obj
"""
import colorsys
import math
import os
import sys

GECKO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "gecko.obj")
RINGS = 2.5  # a unit of length


def colour(x, y):
    """Red, green and blue at a vertex: hue from head to tail, rings light and dark."""
    ring = 0.5 + 0.5 * math.tanh(3 * math.sin(2 * math.pi * RINGS * y))
    return colorsys.hsv_to_rgb((0.55 + 0.30 * y) % 1, 0.95 - 0.5 * ring, 0.7 + 0.3 * ring)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(GECKO, encoding="utf-8") as file:
        lines = file.readlines()
    with open(sys.argv[1], "w", encoding="ascii") as out:
        for line in lines:
            if line.startswith("v "):
                x, y, z = (float(word) for word in line.split()[1:4])
                line = "v {:.6g} {:.6g} {:.6g} {:.4f} {:.4f} {:.4f}\n".format(x, y, z, *colour(x, y))
            out.write(line)


if __name__ == "__main__":
    main()
