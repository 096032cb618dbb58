#!/usr/bin/python3
"""Makes the sample meshes gecko.obj and gecko_step.obj: a gecko and a second pose of it.

Both have the same vertices in the same order and the same triangles. The gecko is an implicit
surface (round cones and ellipsoids, smoothly joined), meshed by OpenVDB, relaxed on the surface,
then posed by smooth skinning. Needs python3-openvdb and python3-numpy (Debian packages):

    /usr/bin/python3 samples/make_gecko.py [FOLDER]
"""
import math
import os
import sys

import numpy as np
import pyopenvdb

VOXEL = 0.0272  # sets the number of vertices, about 6,300

# The spine from the snout to the tip of the tail: x, y, z, radius. Head up, back towards +z.
SPINE = np.array([
    [0.000, 1.000, -0.010, 0.085], [0.000, 0.890, -0.005, 0.140], [0.000, 0.745, 0.000, 0.192],
    [0.000, 0.610, 0.000, 0.160], [0.000, 0.500, 0.000, 0.128], [0.000, 0.360, 0.000, 0.158],
    [0.000, 0.180, 0.000, 0.190], [0.000, 0.000, 0.000, 0.204], [0.000, -0.180, 0.000, 0.186],
    [0.000, -0.340, 0.000, 0.148], [0.010, -0.480, 0.000, 0.106], [0.035, -0.620, 0.000, 0.112],
    [0.065, -0.760, 0.000, 0.108], [0.080, -0.900, 0.000, 0.090], [0.070, -1.030, 0.000, 0.068],
    [0.040, -1.150, 0.000, 0.048], [0.000, -1.260, 0.000, 0.034]])
FLAT = 0.80  # height of the body over its width

# Right side legs: joints with radii, then toes as angles about the last joint's direction.
FORE = np.array([[0.09, 0.355, -0.01, 0.085], [0.345, 0.285, -0.015, 0.066],
                 [0.475, 0.500, -0.025, 0.052], [0.505, 0.560, -0.030, 0.058]])
HIND = np.array([[0.07, -0.325, -0.01, 0.090], [0.335, -0.215, -0.015, 0.072],
                 [0.450, -0.435, -0.025, 0.054], [0.485, -0.490, -0.030, 0.058]])
TOE_ANGLES = {"fore": (-88, -38, 12, 62), "hind": (-72, -22, 28, 78)}
TOE_LENGTH, TOE_RADIUS, PAD_RADIUS = 0.150, 0.031, 0.043
EYE = np.array([0.122, 0.790, 0.098, 0.078])

# Turns at joints in the second pose, degrees: about z (in the plane of the body), and about x for
# the spine (lift). Spine: one for each joint away from its root at index ROOT, both ways.
ROOT = 7
SPINE_TURN = {6: 9, 5: 11, 4: 12, 3: 12, 2: 6, 8: -10, 9: -11, 10: -9, 11: -8, 12: -9, 13: -12,
              14: -14, 15: -15}
SPINE_LIFT = {5: 4, 4: 7, 3: 7, 13: -5, 14: -7, 15: -7}
LEG_TURN = {("fore", 1): (20, -2, -12), ("fore", -1): (10, 10, 0),
            ("hind", 1): (-18, 12, 8), ("hind", -1): (-16, 18, 6)}


def mirrored(points):
    return points * np.array([-1, 1, 1, 1])


def round_cone(p, a, b):
    """Distance to the hull of two spheres (x, y, z, radius), approximately."""
    axis = b[:3] - a[:3]
    t = np.clip((p - a[:3]) @ axis / (axis @ axis), 0, 1)
    nearest = a[:3] + t[:, None] * axis
    return np.linalg.norm(p - nearest, axis=1) - (a[3] + t * (b[3] - a[3]))


def refined(chain, pieces=6):
    """Catmull-Rom through the chain's joints."""
    ends = np.vstack([2 * chain[0] - chain[1], chain, 2 * chain[-1] - chain[-2]])
    out = []
    for i in range(1, len(ends) - 2):
        p0, p1, p2, p3 = ends[i - 1:i + 3]
        for t in np.arange(pieces) / pieces:
            out.append(0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t ** 2
                              + (3 * p1 - p0 - 3 * p2 + p3) * t ** 3))
    return np.array(out + [chain[-1]])


def chain_distance(p, chain):
    return np.min([round_cone(p, a, b) for a, b in zip(chain[:-1], chain[1:])], axis=0)


def smooth_min(a, b, k):
    h = np.clip(0.5 + 0.5 * (b - a) / k, 0, 1)
    return b + (a - b) * h - k * h * (1 - h)


def toes_of(kind):
    leg = FORE if kind == "fore" else HIND
    direction = leg[3, :2] - leg[1, :2]
    middle = math.atan2(direction[1], direction[0])
    for angle in TOE_ANGLES[kind]:
        a = middle + math.radians(angle)
        tip = leg[3, :3] + TOE_LENGTH * np.array([math.cos(a), math.sin(a), -0.03])
        yield np.append(leg[3, :3], TOE_RADIUS), np.append(tip, PAD_RADIUS)


def gecko(p):
    """Negative inside; the zero set is the gecko."""
    squash = np.array([1, 1, 1 / FLAT])
    d = chain_distance(p * squash, refined(SPINE * np.append(squash, 1)))
    for side in (1, -1):
        q = p * np.array([side, 1, 1])
        d = smooth_min(d, np.linalg.norm(q - EYE[:3], axis=1) - EYE[3], 0.035)
        for kind, leg in (("fore", FORE), ("hind", HIND)):
            limb = chain_distance(q, refined(leg))
            for a, b in toes_of(kind):
                limb = smooth_min(limb, round_cone(q, a, b), 0.022)
            d = smooth_min(d, limb, 0.085)
    return d


def meshed():
    low, high = np.array([-0.9, -1.45, -0.35]), np.array([0.9, 1.25, 0.35])
    size = np.ceil((high - low) / VOXEL).astype(int)
    index = np.stack(np.meshgrid(*[np.arange(n) for n in size], indexing="ij"), -1).reshape(-1, 3)
    values = gecko(low + VOXEL * index).reshape(size)
    grid = pyopenvdb.FloatGrid(background=1.0)
    grid.copyFromArray(values.astype(np.float32))
    points, quads = grid.convertToQuads(isovalue=0.0)
    points = low + VOXEL * points.astype(float)
    quads = quads.astype(int)
    diagonal = np.linalg.norm(points[quads[:, 0]] - points[quads[:, 2]], axis=1)
    other = np.linalg.norm(points[quads[:, 1]] - points[quads[:, 3]], axis=1)
    short = (diagonal <= other)[:, None]
    triangles = np.vstack([np.where(short, quads[:, [0, 1, 2]], quads[:, [0, 1, 3]]),
                           np.where(short, quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])])
    if volume(points, triangles) < 0:
        triangles = triangles[:, ::-1]
    return points, triangles


def volume(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def projected(points):
    """Newton steps along the gradient onto the zero set."""
    h = 1e-4
    for _ in range(3):
        value = gecko(points)
        gradient = np.stack([gecko(points + h * e) - gecko(points - h * e) for e in np.eye(3)],
                            -1) / (2 * h)
        length2 = np.maximum(np.einsum("ij,ij->i", gradient, gradient), 0.05)
        points = points - (np.clip(value, -VOXEL, VOXEL) / length2)[:, None] * gradient
    return points


def neighbour_mean(triangles, values, count):
    total = np.zeros((count, values.shape[1]))
    degree = np.zeros(count)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        np.add.at(total, triangles[:, a], values[triangles[:, b]])
        np.add.at(degree, triangles[:, a], 1)
    return total / degree[:, None]


def flipped(points, triangles):
    """Flips edges whose opposite angles sum to more than 180 degrees (Delaunay), once over."""
    triangles = [list(t) for t in triangles]
    half = {(t[k], t[(k + 1) % 3]): i for i, t in enumerate(triangles) for k in range(3)}

    def angle(at, a, b):
        u, v = points[a] - points[at], points[b] - points[at]
        return math.acos(np.clip(u @ v / (math.sqrt(u @ u) * math.sqrt(v @ v)), -1, 1))

    def normal(t):
        n = np.cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]])
        return n / np.linalg.norm(n)

    flips = 0
    for a, b in [e for e in half if e[0] < e[1]]:
        if (a, b) not in half or (b, a) not in half:
            continue
        left, right = half[a, b], half[b, a]
        c = next(v for v in triangles[left] if v not in (a, b))
        d = next(v for v in triangles[right] if v not in (a, b))
        if (c, d) in half or (d, c) in half:
            continue
        if angle(c, a, b) + angle(d, a, b) < math.pi + 1e-3:
            continue
        new = ([c, a, d], [d, b, c])
        if normal(new[0]) @ normal(new[1]) < 0.5:
            continue
        for t in (left, right):
            for k in range(3):
                half.pop((triangles[t][k], triangles[t][(k + 1) % 3]), None)
        triangles[left], triangles[right] = new
        for t in (left, right):
            for k in range(3):
                half[triangles[t][k], triangles[t][(k + 1) % 3]] = t
        flips += 1
    return np.array(triangles), flips


def relaxed(points, triangles, rounds=24):
    for i in range(rounds):
        points = points + 0.5 * (neighbour_mean(triangles, points, len(points)) - points)
        points = projected(points)
        if i % 4 == 3:
            triangles, _ = flipped(points, triangles)
    return points, triangles


def turn(axis, degrees, about):
    """4 x 4: a rotation about an axis through a point."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    r = np.eye(3) + s * cross + (1 - c) * cross @ cross
    m = np.eye(4)
    m[:3, :3] = r
    m[:3, 3] = about - r @ about
    return m


def bones():
    """(distance function, 4 x 4 transform) of each bone in the second pose."""
    moved = {ROOT: np.eye(4)}
    for step in (-1, 1):
        i = ROOT
        while 0 <= i + step < len(SPINE):
            m = moved[i]
            if i != ROOT:
                m = m @ turn((0, 0, 1), SPINE_TURN.get(i, 0), SPINE[i, :3])
                m = m @ turn((1, 0, 0), SPINE_LIFT.get(i, 0), SPINE[i, :3])
            i += step
            moved[i] = m
    for i in range(len(SPINE) - 1):
        # A bone moves with its joint farther from the root.
        far = i if i < ROOT else i + 1
        yield (lambda p, i=i: round_cone(p, SPINE[i], SPINE[i + 1])), moved[far]
    for (kind, side), angles in LEG_TURN.items():
        leg = FORE if kind == "fore" else HIND
        if side < 0:
            leg = mirrored(leg)
        m = moved[5 if kind == "fore" else 9]
        for k in range(3):
            m = m @ turn((0, 0, 1), angles[k], leg[k, :3])
            parts = [(leg[k], leg[k + 1])]
            if k == 2:
                parts += [(a, b) if side > 0 else (mirrored(a), mirrored(b))
                          for a, b in toes_of(kind)]
            yield (lambda p, parts=parts: np.min([round_cone(p, *c) for c in parts], axis=0)), m


def posed(points, triangles):
    distances, transforms = zip(*[(f(points), m) for f, m in bones()])
    d = np.array(distances).T
    weights = np.exp(-(d - d.min(axis=1, keepdims=True)) / 0.03)
    for _ in range(120):
        weights = 0.5 * weights + 0.5 * neighbour_mean(triangles, weights, len(points))
    weights /= weights.sum(axis=1, keepdims=True)
    blended = np.einsum("vb,bij->vij", weights, np.array(transforms)[:, :3, :])
    return np.einsum("vij,vj->vi", blended, np.c_[points, np.ones(len(points))])


def write_obj(path, points, triangles, comment):
    with open(path, "w") as out:
        out.write(f"# {comment}\n# Made by make_gecko.py; part of innermap, Apache-2.0.\n")
        out.writelines("v %.6g %.6g %.6g\n" % tuple(p) for p in points)
        out.writelines("f %d %d %d\n" % tuple(t + 1) for t in triangles)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    points, triangles = relaxed(*meshed())
    points = np.round(points, 6)
    edges = {tuple(sorted(e)) for t in triangles for e in zip(t, np.roll(t, -1))}
    euler = len(points) - len(edges) + len(triangles)
    assert euler == 2 and 2 * len(edges) == 3 * len(triangles), "the gecko is not a closed sphere"
    step = posed(points, triangles)
    print(f"{len(points)} vertices, {len(triangles)} triangles, volumes "
          f"{volume(points, triangles):.4f} and {volume(step, triangles):.4f}")
    write_obj(os.path.join(folder, "gecko.obj"), points, triangles, "A gecko")
    write_obj(os.path.join(folder, "gecko_step.obj"), step, triangles,
              "The same gecko, a step later, looking round")


if __name__ == "__main__":
    main()
