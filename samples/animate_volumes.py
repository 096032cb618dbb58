#!/usr/bin/python3
"""Draws volumes as render_volume.py does, one after another as a GIF that goes round:

    animate_volumes.py OUT.gif FRAME.vdb [FRAME.vdb ...]

All frames show the same piece of space; their files have one lattice, as innermap deform writes them.
"""
import sys

import numpy as np
import OpenImageIO as oiio
import pyopenvdb as vdb

from render_volume import MARGIN, PAPER, drawn

SECONDS = 2.0  # of the whole
ENLARGED = 1.6


def place(path):
    """Corners of a volume's active box, columns and rows of its lattice."""
    low, high = vdb.read(path, "density").evalActiveVoxelBoundingBox()
    return np.array(low[:2]), np.array(high[:2])


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear,
                    1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def enlarged(picture, width, height):
    pixels = oiio.ImageBuf(oiio.ImageSpec(picture.shape[1], picture.shape[0], 3, "float"))
    pixels.set_pixels(oiio.ROI(), np.ascontiguousarray(picture, np.float32))
    roi = oiio.ROI(0, width, 0, height, 0, 1, 0, 3)
    return oiio.ImageBufAlgo.resize(pixels, filtername="lanczos3", roi=roi).get_pixels(oiio.FLOAT)


def main():
    out, paths = sys.argv[1], sys.argv[2:]
    places = [place(path) for path in paths]
    low = np.min([p[0] for p in places], 0) - MARGIN
    high = np.max([p[1] for p in places], 0) + MARGIN
    columns, rows = (high - low + 1).tolist()
    width, height = round(ENLARGED * columns), round(ENLARGED * rows)
    spec = oiio.ImageSpec(width, height, 3, "uint8")
    spec.attribute("oiio:Movie", 1)
    spec.attribute("FramesPerSecond", float(len(paths) / SECONDS))
    file = oiio.ImageOutput.create(out)
    if not file or not file.open(out, tuple([spec] * len(paths))):
        sys.exit(file.geterror() if file else oiio.geterror())
    for number, (path, (first, last)) in enumerate(zip(paths, places)):
        picture = np.zeros((rows, columns, 3), np.float32) + PAPER
        left, top = first[0] - low[0], high[1] - last[1]
        piece = drawn(path)
        picture[top:top + piece.shape[0], left:left + piece.shape[1]] = piece
        if number and not file.open(out, spec, "AppendSubimage"):
            sys.exit(file.geterror())
        if not file.write_image((255 * np.clip(srgb(enlarged(picture, width, height)), 0, 1) +
                                 0.5).astype(np.uint8)):
            sys.exit(file.geterror())
    file.close()


if __name__ == "__main__":
    main()
