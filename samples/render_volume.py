#!/usr/bin/python3
"""Draws a volume, seen from above (against the z axis, y up):

    render_volume.py FILE.vdb OUT.png

Density from the grid `density`, colour (linear) from `color`, a pixel a voxel: layer by layer from the
nearest to the farthest, each with the light that falls on it by the slope of the density.
"""
import sys

import numpy as np
import OpenImageIO as oiio
import pyopenvdb as vdb

EXTINCTION = 170.0                        # where the density is 1, per world unit
LIGHT = np.array([-0.45, 0.5, 0.74])      # towards it
AMBIENT = 0.5
PAPER = np.array([0.032, 0.045, 0.075])   # behind the volumes, linear
MARGIN = 26                               # pixels


def dense(path, name, channels, low, shape):
    values = np.zeros(shape + ([channels] if channels > 1 else []), np.float32)
    vdb.read(path, name).copyToArray(values, ijk=low)
    return values


def smooth(values):
    """The mean of each voxel and its neighbours along the three axes."""
    for axis in range(3):
        values = (values + np.roll(values, 1, axis) + np.roll(values, -1, axis)) / 3
    return values


def drawn(path):
    """The picture of one file, linear, rows from the top: (height, width, 3)."""
    grid = vdb.read(path, "density")
    low, high = grid.evalActiveVoxelBoundingBox()
    shape = [b - a + 1 for a, b in zip(low, high)]
    density = dense(path, "density", 1, low, shape)
    colour = dense(path, "color", 3, low, shape)
    slope = np.stack(np.gradient(smooth(smooth(np.minimum(density, 1)))), -1)
    length = np.linalg.norm(slope, axis=-1)
    facing = -(slope @ LIGHT) / np.linalg.norm(LIGHT) / np.maximum(length, 1e-6)
    light = AMBIENT + (1 - AMBIENT) * np.where(length > 1e-4, np.clip(facing, -0.6, 1), 0.3)
    step = EXTINCTION * grid.transform.voxelSize()[2]
    seen, through = np.zeros(shape[:2] + [3]), np.ones(shape[:2])
    for k in range(shape[2] - 1, -1, -1):
        opacity = 1 - np.exp(-step * density[:, :, k])
        seen += (through * opacity * light[:, :, k])[..., None] * colour[:, :, k]
        through *= 1 - opacity
    seen += through[..., None] * PAPER
    return np.transpose(seen, (1, 0, 2))[::-1]


def main():
    path, out = sys.argv[1:]
    linear = np.pad(drawn(path) - PAPER, ((MARGIN, MARGIN), (MARGIN, MARGIN), (0, 0))) + PAPER
    srgb = np.where(linear <= 0.0031308, 12.92 * linear,
                    1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    picture = oiio.ImageBuf(oiio.ImageSpec(linear.shape[1], linear.shape[0], 3, "uint8"))
    picture.set_pixels(oiio.ROI(), np.ascontiguousarray(np.clip(srgb, 0, 1), np.float32))
    if not picture.write(out):
        sys.exit(picture.geterror())


if __name__ == "__main__":
    main()
