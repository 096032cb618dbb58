#!/usr/bin/python3
"""The volume of samples/deform, stripes where a fog is:  deform_volume.py FOG.vdb OUT.vdb"""
import sys

import numpy as np
import pyopenvdb

PERIOD = 14  # voxels


def stripes(source, target):
    fog = pyopenvdb.read(source, "density")
    lower, upper = (np.array(c) for c in fog.evalActiveVoxelBoundingBox())
    values = np.zeros(upper - lower + 1, np.float32)
    fog.copyToArray(values, ijk=tuple(int(c) for c in lower))
    i, j, _ = np.meshgrid(*[np.arange(n) for n in values.shape], indexing="ij")
    wave = [0.5 + 0.5 * np.cos(2 * np.pi * k / PERIOD) for k in (i, j)]
    values = np.where(values > 0, np.maximum(np.maximum(*wave), 0.005), 0)
    grid = pyopenvdb.FloatGrid()
    grid.copyFromArray(values.astype(np.float32), ijk=tuple(int(c) for c in lower))
    grid.transform, grid.name = fog.transform, "stripes"
    pyopenvdb.write(target, [grid])


if __name__ == "__main__":
    stripes(*sys.argv[1:3])
