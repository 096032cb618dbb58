#!/usr/bin/python3
"""Clouds and coloured bands in a solid:  push_volume.py SOLID.vdb OUT.vdb

SOLID.vdb has the fog `density` of innermap voxelize --fog; OUT.vdb gets `density`, value noise of
three octaves in it, and `color`, bands along the axes.
"""
import sys

import numpy as np
import pyopenvdb as vdb


def noise(shape, cell, random):
    """Smoothly interpolated random numbers on a lattice of `cell` voxels."""
    lattice = random.random([n // cell + 3 for n in shape])
    places = [np.arange(n) / cell for n in shape]
    whole = [p.astype(int) for p in places]
    parts = [p - w for p, w in zip(places, whole)]
    parts = [t * t * (3 - 2 * t) for t in parts]
    out = np.zeros(shape)
    for corner in np.ndindex(2, 2, 2):
        weights = [t if c else 1 - t for t, c in zip(parts, corner)]
        out += (weights[0][:, None, None] * weights[1][None, :, None] * weights[2][None, None, :] *
                lattice[np.ix_(*(w + c for w, c in zip(whole, corner)))])
    return out


solid = vdb.read(sys.argv[1], "density")
low, high = solid.evalActiveVoxelBoundingBox()
inside = np.zeros([b - a + 1 for a, b in zip(low, high)], np.float32)
solid.copyToArray(inside, ijk=low)
random = np.random.default_rng(3)
clouds = sum(weight * noise(inside.shape, cell, random)
             for weight, cell in ((0.6, 24), (0.3, 10), (0.1, 5)))

density = vdb.FloatGrid()
density.copyFromArray((inside * np.clip(3 * clouds - 1.05, 0, 1)).astype(np.float32), ijk=low)
density.name, density.transform, density.gridClass = "density", solid.transform, vdb.GridClass.FOG_VOLUME

bands = np.stack(np.meshgrid(*(0.5 + 0.5 * np.sin(np.arange(n) / 9) for n in inside.shape),
                             indexing="ij"), -1).astype(np.float32)
bands[inside <= 0] = 0
color = vdb.Vec3SGrid()
color.copyFromArray(bands, ijk=low)
color.name, color.transform = "color", solid.transform
vdb.write(sys.argv[2], [density, color])
