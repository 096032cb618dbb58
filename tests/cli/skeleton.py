"""Tubes along the middle of a mesh's limbs, as OBJ with texture coordinates and normals.

    skeleton.py MESH.obj OUT.obj

The middle is that of the parts into which the surface falls between levels of the distance along it
from one of its ends (a Reeb graph)."""
import collections
import heapq
import sys

import numpy as np


def read(path):
    points, faces = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                points.append([float(w) for w in words[1:4]])
            elif words[:1] == ["f"]:
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
    return np.array(points), faces


def neighbours(count, faces):
    near = [set() for _ in range(count)]
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            near[a].add(b)
            near[b].add(a)
    return near


def distances(points, near, start):
    far = np.full(len(points), np.inf)
    far[start] = 0
    heap = [(0.0, start)]
    while heap:
        d, v = heapq.heappop(heap)
        if d > far[v]:
            continue
        for w in near[v]:
            e = d + np.linalg.norm(points[v] - points[w])
            if e < far[w]:
                far[w] = e
                heapq.heappush(heap, (e, w))
    return far


def parts(points, near, levels=60):
    """Centres, radii and links of the parts between levels."""
    first = distances(points, near, int(np.argmin(points[:, 0])))
    reached = np.isfinite(first)
    far = distances(points, near, int(np.argmax(np.where(reached, first, 0))))
    band = np.where(reached, np.minimum(levels - 1, far / far[reached].max() * levels), -1).astype(int)
    part = np.full(len(points), -1)
    centres, radii = [], []
    for v in range(len(points)):
        if part[v] >= 0 or band[v] < 0:
            continue
        members, waiting = [], [v]
        part[v] = len(centres)
        while waiting:
            a = waiting.pop()
            members.append(a)
            for b in near[a]:
                if part[b] < 0 and band[b] == band[v]:
                    part[b] = part[v]
                    waiting.append(b)
        centre = points[members].mean(0)
        centres.append(centre)
        radii.append(np.linalg.norm(points[members] - centre, axis=1).min() if len(members) > 8 else 0)
    links = set()
    for v in range(len(points)):
        for w in near[v]:
            if part[v] >= 0 and band[w] == band[v] + 1:
                links.add((part[v], part[w]))
    return np.array(centres), np.array(radii), sorted(links)


def winding(points, faces, at):
    """Winding number of the surface about a point (van Oosterom and Strackee, 1983)."""
    a, b, c = (points[faces[:, k]] - at for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    det = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a))]
    return np.arctan2(det, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum() / (2 * np.pi)


def tubes(points, faces, centres, radii, links, sides=12, rings=8):
    """Vertices, normals and quadrilaterals of a tube for each link between parts that have room."""
    vertices, normals, uvs, quads = [], [], [], []
    for a, b in links:
        axis = centres[b] - centres[a]
        length = np.linalg.norm(axis)
        if min(radii[a], radii[b]) <= 0 or length == 0:
            continue
        if any(winding(points, faces, (1 - t) * centres[a] + t * centres[b]) < 0.5 for t in (0, 0.25, 0.5, 0.75, 1)):
            continue
        axis /= length
        side = np.cross(axis, np.eye(3)[np.argmin(abs(axis))])
        side /= np.linalg.norm(side)
        other = np.cross(axis, side)
        start = len(vertices)
        for r in range(rings + 1):
            t = r / rings
            middle = (1 - t) * centres[a] + t * centres[b]
            radius = 0.4 * np.linalg.norm(points - middle, axis=1).min()
            for s in range(sides):
                angle = 2 * np.pi * s / sides
                out = np.cos(angle) * side + np.sin(angle) * other
                vertices.append(middle + radius * out)
                normals.append(out)
                uvs.append((s / sides, t))
        for r in range(rings):
            for s in range(sides):
                p, q = start + r * sides + s, start + r * sides + (s + 1) % sides
                quads.append((p, q, q + sides, p + sides))
    return np.array(vertices), np.array(normals), np.array(uvs), quads


def write(path, vertices, normals, uvs, quads):
    with open(path, "w", encoding="utf-8") as file:
        file.write("# tubes\no bones\ng all\nusemtl bone\n")
        for row in vertices:
            file.write("v %r %r %r\n" % tuple(map(float, row)))
        for row in uvs:
            file.write("vt %r %r\n" % tuple(map(float, row)))
        for row in normals:
            file.write("vn %r %r %r\n" % tuple(map(float, row)))
        for quad in quads:
            file.write("f " + " ".join(f"{v + 1}/{v + 1}/{v + 1}" for v in quad) + "\n")


def make(mesh, out):
    points, faces = read(mesh)
    centres, radii, links = parts(points, neighbours(len(points), faces))
    bones = tubes(points, np.array([f[:3] for f in faces]), centres, radii, links)
    write(out, *bones)
    return bones


if __name__ == "__main__":
    made = make(sys.argv[1], sys.argv[2])
    print(len(made[0]), "vertices,", len(made[3]), "quadrilaterals")
