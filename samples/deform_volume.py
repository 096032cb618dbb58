#!/usr/bin/python3
"""The volume and the picture of samples/deform.

    deform_volume.py stripes FOG.vdb OUT.vdb      stripes where the fog is
    deform_volume.py join OUT.png A.png B.png     pictures side by side
"""
import sys

import numpy as np
import OpenImageIO as oiio
import pyopenvdb

PERIOD = 14  # voxels


def stripes(source, target):
    fog = pyopenvdb.read(source, "density")
    lower, upper = (np.array(c) for c in fog.evalActiveVoxelBoundingBox())
    values = np.zeros(upper - lower + 1, np.float32)
    fog.copyToArray(values, ijk=tuple(int(c) for c in lower))
    i, j, _ = np.meshgrid(*[np.arange(n) for n in values.shape], indexing="ij")
    wave = [0.5 + 0.5 * np.cos(2 * np.pi * k / PERIOD) for k in (i, j)]
    values = np.where(values > 0, np.maximum(*wave), 0)
    grid = pyopenvdb.FloatGrid()
    grid.copyFromArray(values.astype(np.float32), ijk=tuple(int(c) for c in lower))
    grid.transform, grid.name = fog.transform, "stripes"
    pyopenvdb.write(target, [grid])


def join(target, sources):
    pictures = [oiio.ImageBuf(path) for path in sources]
    height = max(p.spec().height for p in pictures)
    width = sum(p.spec().width for p in pictures)
    all_of_them = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "uint8"))
    oiio.ImageBufAlgo.fill(all_of_them, (1, 1, 1))
    at = 0
    for p in pictures:
        oiio.ImageBufAlgo.paste(all_of_them, at, 0, 0, 0, p)
        at += p.spec().width
    if not all_of_them.write(target):
        sys.exit(all_of_them.geterror())


if __name__ == "__main__":
    if sys.argv[1] == "stripes":
        stripes(*sys.argv[2:4])
    else:
        join(sys.argv[2], sys.argv[3:])
