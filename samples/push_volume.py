#!/usr/bin/python3
"""Balls in a translucent solid:  push_volume.py SOLID.vdb OUT.vdb

SOLID.vdb has `surface` and `density` of innermap voxelize --fog; OUT.vdb gets `density`, thin
everywhere inside and full in balls on a cubic lattice, and `color`, whose hue runs along the solid.
Balls that would reach the skin are smaller.
"""
import sys

import numpy as np
import pyopenvdb as vdb

SPACING, RADIUS = 0.1, 0.036  # of the balls, world units
LEAST = 0.014                 # depth of a ball's middle below the skin, world units
THIN = 0.012                  # density between them


def hues(t):
    """Saturated colours around the wheel, t in [0, 1)."""
    return np.clip(np.abs((6 * t[..., None] + np.array([0, 4, 2])) % 6 - 3) - 1, 0.03, 0.95)


def level_set(points):
    """The solid's signed distance at world points (..., 3), of the nearest voxel."""
    grid = vdb.read(sys.argv[1], "surface")
    first, last = grid.evalActiveVoxelBoundingBox()
    values = np.zeros([b - a + 1 for a, b in zip(first, last)], np.float32)
    grid.copyToArray(values, ijk=first)
    at = np.round((points - np.array(grid.transform.indexToWorld(first))) /
                  grid.transform.voxelSize()[0]).astype(int)
    within = np.all((at >= 0) & (at < values.shape), axis=-1)
    return np.where(within, values[tuple(np.moveaxis(np.where(within[..., None], at, 0), -1, 0))], 1)


solid = vdb.read(sys.argv[1], "density")
low, high = solid.evalActiveVoxelBoundingBox()
inside = np.zeros([b - a + 1 for a, b in zip(low, high)], np.float32)
solid.copyToArray(inside, ijk=low)
size = solid.transform.voxelSize()[0]
corner = solid.transform.indexToWorld(low)
places = np.stack(np.meshgrid(*(a + size * np.arange(n) for a, n in zip(corner, inside.shape)),
                              indexing="ij"), -1)
nearest = np.round(places / SPACING)
depth = -level_set(nearest * SPACING)
radius = np.where(depth > LEAST, np.minimum(RADIUS, depth - size), -1)
bead = np.clip((radius - np.linalg.norm(places - nearest * SPACING, axis=-1)) / size + 0.5, 0, 1)

density = vdb.FloatGrid()
density.copyFromArray((inside * np.maximum(bead, THIN)).astype(np.float32), ijk=low)
density.name, density.transform, density.gridClass = "density", solid.transform, vdb.GridClass.FOG_VOLUME

along = np.linspace(0, 0.85, inside.shape[1])[None, :, None] + np.zeros(inside.shape)
shades = np.where(bead[..., None] > 0, hues(along), 0.7).astype(np.float32)
shades[inside <= 0] = 0
color = vdb.Vec3SGrid()
color.copyFromArray(shades, ijk=low)
color.name, color.transform = "color", solid.transform
vdb.write(sys.argv[2], [density, color])
