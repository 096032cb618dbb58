#!/usr/bin/python3
"""Draws bodies as glass, with the geometry that is inside them, side by side:

    render_inside.py OUT.png FROM BODY.obj INSIDE.obj [BODY.obj INSIDE.obj ...]

FROM is where the viewer stands: three numbers with commas between; y is up, or z when FROM ends in
",z". Colours of vertices (x y z r g b) are taken where INSIDE has some.
"""
import sys

import numpy as np
import OpenImageIO as oiio

SIZE = 640          # pixels a body
SAMPLES = 3         # along a pixel's edge
INSIDE = (0.80, 0.36, 0.13)
BODY = np.array([0.20, 0.36, 0.55])
PAPER = np.array([1.0, 1.0, 1.0])


def read(path):
    """Vertices, triangles and colours of an OBJ file."""
    vertices, colours, triangles = [], [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append([float(w) for w in words[1:4]])
                colours.append([float(w) for w in words[4:7]] if len(words) >= 7 else INSIDE)
            elif words[:1] == ["f"]:
                corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
                triangles += [(corners[0], a, b) for a, b in zip(corners[1:], corners[2:])]
    return np.array(vertices), np.array(triangles), np.array(colours)


def axes(towards, up):
    back = np.array(towards) / np.linalg.norm(towards)
    right = np.cross(np.eye(3)[up], back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back])


def dots(vertices, triangles, colours, view, low, scale):
    """Places in the picture (x, y from the top, nearness), facing and colours, dense enough."""
    seen = vertices @ view.T
    places = np.column_stack([(seen[:, 0] - low[0]) * scale, (low[1] - seen[:, 1]) * scale, seen[:, 2]])
    corners = places[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edges = np.linalg.norm(corners[:, [1, 2, 0], :2] - corners[:, :, :2], axis=2).max(1)
    flat = np.cross((seen[triangles[:, 1]] - seen[triangles[:, 0]]), (seen[triangles[:, 2]] - seen[triangles[:, 0]]))
    flat /= np.maximum(np.linalg.norm(flat, axis=1), 1e-300)[:, None]
    for parts in sorted(set(np.ceil(edges).astype(int) + 1)):
        of = np.where(np.ceil(edges).astype(int) + 1 == parts)[0]
        i, j = np.meshgrid(np.arange(parts + 1), np.arange(parts + 1))
        keep = i + j <= parts
        weights = np.column_stack([i[keep], j[keep], parts - i[keep] - j[keep]]) / parts
        for some in np.array_split(of, max(1, len(of) * len(weights) // 2000000)):
            yield (np.einsum("wk,tkd->twd", weights, corners[some]).reshape(-1, 3),
                   np.repeat(flat[some], len(weights), 0),
                   np.einsum("wk,tkd->twd", weights, colours[triangles[some]]).reshape(-1, 3))
    del normals


def nearest(mesh, view, low, scale, pixels):
    """Colour and facing of what is nearest at each pixel; nearness is -inf where nothing is."""
    depth = np.full(pixels * pixels, -np.inf)
    facing, colour = np.zeros((pixels * pixels, 3)), np.zeros((pixels * pixels, 3))
    for place, normal, tint in dots(*mesh, view, low, scale):
        x, y = place[:, 0].astype(int), place[:, 1].astype(int)
        good = (x >= 0) & (x < pixels) & (y >= 0) & (y < pixels)
        at, near = (y * pixels + x)[good], place[good, 2]
        order = np.argsort(near, kind="stable")
        at, near = at[order], near[order]
        wins = near > depth[at]
        at, pick = at[wins], np.where(good)[0][order][wins]
        depth[at], facing[at], colour[at] = place[pick, 2], normal[pick], tint[pick]
    return depth, facing, colour


def drawn(body_path, inside_path, view):
    body, inside = read(body_path), read(inside_path)
    pixels = SIZE * SAMPLES
    seen = body[0] @ view.T
    lower, upper = seen.min(0)[:2], seen.max(0)[:2]
    extent = (upper - lower).max() * 1.08
    middle = (lower + upper) / 2
    low = (middle[0] - extent / 2, middle[1] + extent / 2)
    scale = pixels / extent
    depth, facing, colour = nearest(inside, view, low, scale, pixels)
    light = np.array([-0.4, 0.5, 0.75]) / np.linalg.norm([-0.4, 0.5, 0.75])
    shade = 0.35 + 0.65 * np.abs(facing @ light)
    picture = np.where(np.isfinite(depth)[:, None], colour * shade[:, None], PAPER)
    glass, turned, _ = nearest(body, view, low, scale, pixels)
    there = np.isfinite(glass)
    cover = np.where(there, 0.16 + 0.55 * (1 - np.abs(turned[:, 2])) ** 2.5, 0)[:, None]
    picture = (1 - cover) * picture + cover * BODY
    return picture.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 3).mean((1, 3))


def main():
    out, towards = sys.argv[1], sys.argv[2].split(",")
    up = 2 if towards[-1] == "z" else 1
    view = axes([float(w) for w in towards[:3]], up)
    paths = sys.argv[3:]
    picture = np.concatenate([drawn(b, i, view) for b, i in zip(paths[::2], paths[1::2])], 1)
    pixels = np.where(picture <= 0.0031308, 12.92 * picture, 1.055 * np.maximum(picture, 0) ** (1 / 2.4) - 0.055)
    spec = oiio.ImageSpec(picture.shape[1], picture.shape[0], 3, "uint8")
    file = oiio.ImageOutput.create(out)
    file.open(out, spec)
    file.write_image((255 * np.clip(pixels, 0, 1) + 0.5).astype(np.uint8))
    file.close()


if __name__ == "__main__":
    main()
