#!/usr/bin/python3
"""Puts pictures side by side, each with a title above that says what it shows:

    panels.py OUT.png TITLE A.png [TITLE B.png ...]

The strip with the titles has the colour of the pictures' corner. Needs python3-openimageio.
"""
import sys

import numpy as np
import OpenImageIO as oiio

FONT, SIZE, STRIP = "DejaVuSans", 20, 46  # letters and the strip's height in pixels


def main():
    out, titles, paths = sys.argv[1], sys.argv[2::2], sys.argv[3::2]
    if not paths or len(titles) != len(paths):
        sys.exit(__doc__)
    pictures = [oiio.ImageBuf(path).get_pixels(oiio.FLOAT)[:, :, :3] for path in paths]
    paper = pictures[0][0, 0]
    ink = (0.95, 0.95, 0.95) if paper.mean() < 0.5 else (0.1, 0.1, 0.12)
    pixels = np.empty((STRIP + max(p.shape[0] for p in pictures),
                       sum(p.shape[1] for p in pictures), 3), np.float32)
    pixels[:] = paper
    at = 0
    for p in pictures:
        pixels[STRIP:STRIP + p.shape[0], at:at + p.shape[1]] = p
        at += p.shape[1]
    whole = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float"))
    whole.set_pixels(oiio.ROI(), pixels)
    at = 0
    for title, p in zip(titles, pictures):
        if not oiio.ImageBufAlgo.render_text(whole, at + 26, STRIP - 14, title, SIZE, FONT, ink):
            sys.exit(whole.geterror())
        at += p.shape[1]
    whole.set_write_format("uint8")
    if not whole.write(out):
        sys.exit(whole.geterror())


if __name__ == "__main__":
    main()
