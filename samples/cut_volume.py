#!/usr/bin/python3
"""A solid cut open:  cut_volume.py SOLID.vdb OUT.vdb

SOLID.vdb has `surface` and `density` of innermap voxelize --fog; OUT.vdb gets `density`, full in the
lower half and in balls of a cubic lattice that stand out of it, and `color`: a fine board of cubes
below a skin, its hue along the solid.
"""
import sys

import numpy as np
import pyopenvdb as vdb



CUBE, SPACING, RADIUS, SKIN = 0.05, 0.1, 0.030, 0.012  # world units
BONE, HIDE = np.array([0.93, 0.87, 0.72]), np.array([0.05, 0.20, 0.16])  # linear


def hues(t):
    """Saturated colours around the wheel, t in [0, 1)."""
    return np.clip(np.abs((6 * t[..., None] + np.array([0, 4, 2])) % 6 - 3) - 1, 0.03, 0.95)


def main():
    fog, band = vdb.read(sys.argv[1], "density"), vdb.read(sys.argv[1], "surface")
    low, high = fog.evalActiveVoxelBoundingBox()
    shape = [b - a + 1 for a, b in zip(low, high)]
    inside, depth = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    fog.copyToArray(inside, ijk=low)
    band.copyToArray(depth, ijk=low)
    depth = -depth
    size, corner = fog.transform.voxelSize()[0], fog.transform.indexToWorld(low)
    x, y, z = np.meshgrid(*(a + size * np.arange(n) for a, n in zip(corner, shape)), indexing="ij")
    middle = 0.5 * (z[..., 0].min() + z[..., -1].max())

    # Balls that lie in the solid whole.
    spots = [SPACING * (np.round(a / SPACING)) for a in (x, y)]
    at = [np.clip(np.round((a - c) / size).astype(int), 0, n - 1)
          for a, c, n in zip((*spots, np.full_like(x, middle)), corner, shape)]
    away = np.sqrt((x - spots[0]) ** 2 + (y - spots[1]) ** 2 + (z - middle) ** 2)
    ball = np.clip((RADIUS - away) / size + 0.5, 0, 1) * (depth[tuple(at)] > RADIUS + SKIN)
    half = np.clip((middle - z) / size + 0.5, 0, 1)

    board = (np.floor(x / CUBE) + np.floor(y / CUBE) + np.floor(z / CUBE)) % 2
    along = 0.85 * (y - y.min()) / (y.max() - y.min())
    colour = hues(along) * np.where(board > 0, 1.0, 0.12)[..., None]
    colour = np.where((depth < SKIN)[..., None], HIDE, colour)
    colour = np.where((ball > 0)[..., None], BONE, colour)
    colour[inside <= 0] = 0

    density = vdb.FloatGrid()
    density.copyFromArray((inside * np.maximum(half, ball)).astype(np.float32), ijk=low)
    density.name, density.transform, density.gridClass = "density", fog.transform, vdb.GridClass.FOG_VOLUME
    color = vdb.Vec3SGrid()
    color.copyFromArray(colour.astype(np.float32), ijk=low)
    color.name, color.transform = "color", fog.transform
    vdb.write(sys.argv[2], [density, color])


main()
