#!/usr/bin/env python3
"""Makes a body with eyes and clothes that cross its skin, at rest and moving.

    tests/wild/make_clothed.py SEED IN.obj FOLDER [FRAMES]

Two balls stand half in the skin for eyes. A part of the skin, as the band of a shirt, is taken off and
on the body again as a sheet that dips in and out of the skin; its two ends are open. The body bends
and twists along its longest side; the eyes roll, and the sheet slides along the skin. FOLDER gets
rest.obj and frame_00.obj on (24 unless told otherwise), all with the same triangles. The seed chooses
the places and sizes.
"""

import sys
from pathlib import Path

import numpy as np
from make_crossing import read_obj, write_obj


def vertex_normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    out = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(out, faces[:, k], np.cross(b - a, c - a))
    return out / np.maximum(np.linalg.norm(out, axis=1), 1e-300)[:, None]


def ball(rings=10, sides=16):
    """Unit ball: vertices and faces, outward."""
    up = np.pi * np.arange(1, rings) / rings
    round_ = 2 * np.pi * np.arange(sides) / sides
    middle = np.stack([np.sin(up)[:, None] * np.cos(round_), np.sin(up)[:, None] * np.sin(round_),
                       np.cos(up)[:, None] + 0 * round_], axis=-1).reshape(-1, 3)
    vertices = np.vstack([middle, [[0, 0, 1], [0, 0, -1]]])
    top, bottom, faces = len(middle), len(middle) + 1, []
    for s in range(sides):
        n = (s + 1) % sides
        faces += [(top, s, n), (bottom, (rings - 2) * sides + n, (rings - 2) * sides + s)]
        for r in range(rings - 2):
            a, b, c, d = r * sides + s, r * sides + n, (r + 1) * sides + s, (r + 1) * sides + n
            faces += [(a, c, b), (b, c, d)]
    return vertices, np.array(faces)


def turned(points, axis, angle):
    axis = axis / np.linalg.norm(axis)
    return (points * np.cos(angle) + np.cross(axis, points) * np.sin(angle)
            + np.outer(points @ axis, axis) * (1 - np.cos(angle)))


class Body:
    def __init__(self, vertices, faces, random):
        self.skin, self.faces = vertices, faces
        self.size = np.linalg.norm(np.ptp(vertices, axis=0))
        self.axis = int(np.argmax(np.ptp(vertices, axis=0)))
        self.low, self.length = vertices[:, self.axis].min(), np.ptp(vertices[:, self.axis])
        normals = vertex_normals(vertices, faces)
        along = (vertices[:, self.axis] - self.low) / self.length
        begin = random.uniform(0.3, 0.4)
        band = faces[((along[faces] > begin) & (along[faces] < begin + 0.25)).all(axis=1)]
        self.used, numbers = np.unique(band, return_inverse=True)
        self.sheet_faces = numbers.reshape(-1, 3)
        waves = random.uniform(20, 40)
        off = 0.004 + 0.008 * np.sin(waves * along[self.used] + 6 * normals[self.used, (self.axis + 1) % 3])
        self.sheet = vertices[self.used] + self.size * off[:, None] * normals[self.used]
        self.slide = 0.02 * self.size
        self.unit, self.ball_faces = ball()
        ends = np.flatnonzero(along > 0.85)
        self.eyes = vertices[random.choice(ends, 2, replace=False)]
        self.radius = self.size * random.uniform(0.02, 0.03)

    def all_faces(self):
        parts, first = [], 0
        for faces, count in ((self.faces, len(self.skin)), (self.sheet_faces, len(self.sheet)),
                             (self.ball_faces, len(self.unit)), (self.ball_faces, len(self.unit))):
            parts.append(faces + first)
            first += count
        return np.vstack(parts)

    def at(self, time):
        """Vertices when the motion has come so far, from 0, at rest, to 1 and on."""
        sheet = self.sheet.copy()
        sheet[:, self.axis] += self.slide * np.sin(np.pi * time)
        roll = [e + self.radius * turned(self.unit, np.array([1.0, 1, 0]), 0.8 * np.sin(2 * np.pi * time))
                for e in self.eyes]
        return self.moved(np.vstack([self.skin, sheet, *roll]), time)

    def moved(self, points, time):
        """Bent along the longest side, and twisted about it."""
        out = points.copy()
        a, b, c = self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3
        along = (points[:, a] - self.low) / self.length
        twist = 0.5 * np.sin(2 * np.pi * time) * along
        middle = self.skin.mean(axis=0)
        y, z = points[:, b] - middle[b], points[:, c] - middle[c]
        y, z = np.cos(twist) * y - np.sin(twist) * z, np.sin(twist) * y + np.cos(twist) * z
        angle = 0.7 * np.sin(np.pi * time)
        if abs(angle) > 1e-9:
            radius = self.length / angle
            out[:, a] = self.low + (radius - y) * np.sin(angle * along)
            y = radius - (radius - y) * np.cos(angle * along)
        out[:, b], out[:, c] = middle[b] + y, middle[c] + z
        return out


def main():
    if len(sys.argv) not in (4, 5) or not sys.argv[1].isdigit():
        sys.exit(__doc__)
    frames = int(sys.argv[4]) if len(sys.argv) == 5 else 24
    folder = Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    body = Body(*read_obj(sys.argv[2]), np.random.default_rng(int(sys.argv[1])))
    faces = body.all_faces()
    write_obj(folder / "rest.obj", body.at(0), faces)
    for f in range(frames):
        write_obj(folder / f"frame_{f:02d}.obj", body.at((f + 1) / frames), faces)


if __name__ == "__main__":
    main()
