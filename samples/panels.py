#!/usr/bin/python3
"""Puts pictures side by side, each with a title above that says what it shows:

    panels.py [--rows N] OUT.png TITLE A.png [TITLE B.png ...]

The title stands in place of the picture's own. The whole is at most 1400 pixels wide, and has the colour of
the first picture's corner. OUT may also be a .jpg. Needs python3-openimageio.
"""
import sys

import numpy as np
import OpenImageIO as oiio

WIDTH = 1400
FONT, SIZE, STRIP = "DejaVuSans", 19, 44  # letters and the strip's height in pixels
LINE, MARGIN = 40, 12  # a line of text is lower than this; what stays free above the picture


def own_title(pixels):
    """The rows of the lines of text at the top."""
    ink = np.abs(pixels - pixels[0, 0]).max(axis=(1, 2)) > 0.02
    edges = np.flatnonzero(np.diff(np.concatenate([[0], ink, [0]])))
    for begin, end in edges.reshape(-1, 2):
        if end - begin > LINE:
            return max(0, begin - MARGIN)
    return 0


def read(path):
    pixels = oiio.ImageBuf(path).get_pixels(oiio.FLOAT)[:, :, :3]
    return np.ascontiguousarray(pixels[own_title(pixels):])


def image(pixels):
    out = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float"))
    out.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels))
    return out


def shrunk(pixels, scale):
    size = [max(1, round(scale * length)) for length in pixels.shape[:2]]
    out = oiio.ImageBufAlgo.resize(image(pixels), roi=oiio.ROI(0, size[1], 0, size[0], 0, 1, 0, 3))
    return out.get_pixels(oiio.FLOAT)


def main():
    words = sys.argv[1:]
    rows = 1
    if words[:1] == ["--rows"]:
        rows, words = int(words[1]), words[2:]
    out, titles, paths = words[0], words[1::2], words[2::2]
    if not paths or len(titles) != len(paths):
        sys.exit(__doc__)
    pictures = [read(path) for path in paths]
    columns = -(-len(pictures) // rows)
    lines = [range(k, min(k + columns, len(pictures))) for k in range(0, len(pictures), columns)]
    scale = min(1, WIDTH / max(sum(pictures[i].shape[1] for i in line) for line in lines))
    if scale < 1:
        pictures = [shrunk(p, scale) for p in pictures]
    paper = pictures[0][0, 0]
    ink = (0.95, 0.95, 0.95) if paper.mean() < 0.5 else (0.1, 0.1, 0.12)
    heights = [STRIP + max(pictures[i].shape[0] for i in line) for line in lines]
    pixels = np.empty((sum(heights), max(sum(pictures[i].shape[1] for i in line) for line in lines), 3),
                      np.float32)
    pixels[:] = paper
    places = []
    for line, top in zip(lines, np.cumsum([0, *heights])):
        left = 0
        for i in line:
            height, width = pictures[i].shape[:2]
            pixels[top + STRIP:top + STRIP + height, left:left + width] = pictures[i]
            places.append((left, int(top)))
            left += width
    whole = image(pixels)
    for title, (left, top) in zip(titles, places):
        if not oiio.ImageBufAlgo.render_text(whole, left + 16, top + STRIP - 14, title, SIZE, FONT, ink):
            sys.exit(whole.geterror())
    whole.set_write_format("uint8")
    whole.specmod().attribute("CompressionQuality", 88)
    if not whole.write(out):
        sys.exit(whole.geterror())


if __name__ == "__main__":
    main()
