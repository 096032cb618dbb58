#!/usr/bin/env python3
"""Makes the frames of a gecko that sways: a wave runs down the spine of gecko.obj, once in all frames.

    samples/sequence_frames.py FOLDER [COUNT]    gecko.0001.obj and so on; 24 unless given
"""
import bisect
import math
import os
import sys

SWAY, WAVE = 0.5, 1.6  # greatest turn in radians, radians along the body per unit of length
STEPS = 400


def read(path):
    with open(path, encoding="utf-8") as file:
        lines = file.readlines()
    vertices = [[float(x) for x in line.split()[1:4]] for line in lines if line.startswith("v ")]
    return vertices, [line for line in lines if line.startswith("f ")]


def spine(lower, upper, phase):
    """Places along y, and for each the point of the bent spine and how far it is turned there; the
    spine keeps its length."""
    h = (upper - lower) / STEPS
    places, points, turns = [lower + i * h for i in range(STEPS + 1)], [(0.0, lower)], []
    for y in places:
        grows = 0.4 + 0.6 * (upper - y) / (upper - lower)  # more at the tail
        turns.append(SWAY * grows * math.sin(phase + WAVE * y))
    for a, b in zip(turns, turns[1:]):
        x, y = points[-1]
        middle = (a + b) / 2
        points.append((x - h * math.sin(middle), y + h * math.cos(middle)))
    return places, points, turns


def main():
    here, folder = os.path.dirname(os.path.abspath(__file__)), sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 24
    rest, faces = read(os.path.join(here, "gecko.obj"))
    lower, upper = min(v[1] for v in rest), max(v[1] for v in rest)
    os.makedirs(folder, exist_ok=True)
    for frame in range(1, count + 1):
        places, points, turns = spine(lower, upper, 2 * math.pi * (frame - 1) / count)
        with open(os.path.join(folder, f"gecko.{frame:04d}.obj"), "w", encoding="ascii") as out:
            for x, y, z in rest:
                i = min(bisect.bisect_right(places, y) - 1, STEPS - 1)
                t = (y - places[i]) / (places[i + 1] - places[i])
                turn = turns[i] + t * (turns[i + 1] - turns[i])
                cx, cy = ((1 - t) * a + t * b for a, b in zip(points[i], points[i + 1]))
                out.write("v {:.6g} {:.6g} {:.6g}\n".format(cx + x * math.cos(turn),
                                                            cy + x * math.sin(turn), z))
            out.writelines(faces)


if __name__ == "__main__":
    main()
