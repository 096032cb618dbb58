#!/usr/bin/python3
"""Draws volumes as render_volume.py does, one after another as an animated PNG that goes round:

    animate_volumes.py OUT.png FRAME.vdb [FRAME.vdb ...]

All frames show the same piece of space; their files have one lattice, as innermap deform writes them.
"""
import struct
import sys
import zlib

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


def filtered(pixels):
    """Rows of a PNG, each less what its neighbours say (Paeth)."""
    here = pixels.astype(int)
    left, up, corner = np.zeros_like(here), np.zeros_like(here), np.zeros_like(here)
    left[:, 1:], up[1:], corner[1:, 1:] = here[:, :-1], here[:-1], here[:-1, :-1]
    guess = left + up - corner
    near = np.abs(np.stack([left, up, corner]) - guess).argmin(0)
    rest = here - np.choose(near, [left, up, corner])
    rows = np.full((len(here), 1 + here.shape[1] * 3), 4, np.uint8)
    rows[:, 1:] = (rest & 255).reshape(len(here), -1)
    return rows.tobytes()


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_animation(path, frames):
    """An animated PNG (https://www.w3.org/TR/png-3): frames of one size, 8 bits a channel."""
    height, width = frames[0].shape[:2]
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    data += chunk(b"acTL", struct.pack(">II", len(frames), 0))
    number = 0
    for frame in frames:
        delay = round(1000 * SECONDS / len(frames))
        data += chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, width, height, 0, 0, delay, 1000, 0, 0))
        packed = zlib.compress(filtered(frame), 9)
        if number:
            data += chunk(b"fdAT", struct.pack(">I", number + 1) + packed)
        else:
            data += chunk(b"IDAT", packed)
        number += 2 if number else 1
    with open(path, "wb") as file:
        file.write(data + chunk(b"IEND", b""))


def main():
    out, paths = sys.argv[1], sys.argv[2:]
    places = [place(path) for path in paths]
    low = np.min([p[0] for p in places], 0) - MARGIN
    high = np.max([p[1] for p in places], 0) + MARGIN
    columns, rows = (high - low + 1).tolist()
    width, height = round(ENLARGED * columns), round(ENLARGED * rows)
    frames = []
    for path, (first, last) in zip(paths, places):
        picture = np.zeros((rows, columns, 3), np.float32) + PAPER
        left, top = first[0] - low[0], high[1] - last[1]
        piece = drawn(path)
        picture[top:top + piece.shape[0], left:left + piece.shape[1]] = piece
        pixels = np.clip(srgb(enlarged(picture, width, height)), 0, 1)
        frames.append((255 * pixels + 0.5).astype(np.uint8))
    write_animation(out, frames)


if __name__ == "__main__":
    main()
