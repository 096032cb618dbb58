#!/usr/bin/env python3
"""Makes a mesh that runs through itself out of one that does not.

    tests/wild/make_crossing.py KIND SEED IN.obj OUT.obj

KIND is one of
  bend    a limb is curled until its tip runs into the limb, or into the body;
  push    a limb's tip is pushed through the body;
  spikes  four places of the skin are drawn out through the other side;
  copy    a turned copy is added that overlaps.
The seed chooses the limb, the angles and the places. Triangles, and so the mesh's own handles, stay as
they are; the mesh has a second piece with `copy`.
"""

import sys

import numpy as np


def read_obj(path):
    vertices, faces = [], []
    with open(path, encoding="utf-8") as file:
        for words in map(str.split, file):
            if words[:1] == ["v"]:
                vertices.append([float(w) for w in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(w.split("/")[0]) for w in words[1:]]
                corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
                faces += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
    return np.array(vertices), np.array(faces)


def write_obj(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        file.writelines("v {:.9g} {:.9g} {:.9g}\n".format(*v) for v in vertices)
        file.writelines("f {} {} {}\n".format(*(f + 1)) for f in faces)


def neighbours(count, faces):
    out = [set() for _ in range(count)]
    for a, b, c in faces:
        out[a] |= {b, c}
        out[b] |= {a, c}
        out[c] |= {a, b}
    return out


def tips(vertices, around):
    """Vertices farther from the middle than all about them, those that stick out most first."""
    far = np.linalg.norm(vertices - vertices.mean(axis=0), axis=1)
    high = [v for v in range(len(vertices))
            if around[v] and all(far[v] >= far[w] for n in around[v] for w in around[n] | {n})]
    high.sort(key=lambda v: -far[v])
    apart, kept = 0.15 * np.ptp(vertices, axis=0).max(), []
    for v in high:
        if all(np.linalg.norm(vertices[v] - vertices[k]) > apart for k in kept):
            kept.append(v)
    return kept[:6]


def limb(vertices, around, tip, share):
    """The part about the tip beyond a plane across the way to it, how far beyond, and that way."""
    middle = vertices.mean(axis=0)
    way = vertices[tip] - middle
    length = np.linalg.norm(way)
    way /= length
    beyond = (vertices - middle) @ way - share * length
    part, open_ = {tip}, [tip]
    while open_:
        for w in around[open_.pop()]:
            if beyond[w] > 0 and w not in part:
                part.add(w)
                open_.append(w)
    part = np.array(sorted(part))
    return part, beyond[part], way


def across(way, random):
    side = np.cross(way, random.normal(size=3))
    return side / np.linalg.norm(side)


def bend(vertices, faces, random):
    around = neighbours(len(vertices), faces)
    found = tips(vertices, around)
    part, beyond, way = limb(vertices, around, found[random.integers(len(found))], 0.45)
    side, angle = across(way, random), np.radians(random.uniform(200, 290))
    radius = beyond.max() / angle
    p = vertices[part]
    foot = p - beyond[:, None] * way
    # About an axis that lies so far to the side of the limb's root that the limb has room to turn.
    middle = foot.mean(axis=0) + (radius + 0.5 * np.abs((foot - foot.mean(axis=0)) @ side).max()) * side
    turn = beyond / radius
    arm = (foot - middle) @ side
    out = vertices.copy()
    out[part] = (middle + (foot - middle) - arm[:, None] * side + (arm * np.cos(turn))[:, None] * side
                 - (arm * np.sin(turn))[:, None] * way)
    return out, faces


def push(vertices, faces, random):
    around = neighbours(len(vertices), faces)
    found = tips(vertices, around)
    tip = found[random.integers(len(found))]
    part, beyond, _ = limb(vertices, around, tip, 0.55)
    share = beyond / beyond.max()
    out = vertices.copy()
    goal = vertices.mean(axis=0) + 0.1 * np.ptp(vertices, axis=0).max() * random.normal(size=3)
    out[part] += (3 * share ** 2 - 2 * share ** 3)[:, None] * (goal - vertices[tip])
    return out, faces


def spikes(vertices, faces, random):
    normals = np.zeros_like(vertices)
    across_ = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]],
                       vertices[faces[:, 2]] - vertices[faces[:, 0]])
    for k in range(3):
        np.add.at(normals, faces[:, k], across_)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
    out = vertices.copy()
    for v in random.choice(len(vertices), 4, replace=False):
        near = np.linalg.norm(vertices - vertices[v], axis=1) / (random.uniform(0.02, 0.04) * diagonal)
        out -= (random.uniform(0.2, 0.4) * diagonal * np.exp(-near ** 2))[:, None] * normals[v]
    return out, faces


def copy(vertices, faces, random):
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    middle = vertices.mean(axis=0)
    moved = middle + 0.2 * np.ptp(vertices, axis=0) * random.uniform(-1, 1, 3) + (vertices - middle) @ turn.T
    return np.vstack([vertices, moved]), np.vstack([faces, faces + len(vertices)])


KINDS = {"bend": bend, "push": push, "spikes": spikes, "copy": copy}


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in KINDS or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    vertices, faces = read_obj(sys.argv[3])
    write_obj(sys.argv[4], *KINDS[sys.argv[1]](vertices, faces, np.random.default_rng(int(sys.argv[2]))))


if __name__ == "__main__":
    main()
