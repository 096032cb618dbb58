#!/usr/bin/python3
"""A volume texture to numpy and back: the inside of a gecko as arrays, marble computed in them,
written as an EXR atlas for engines, read again and carried into the gecko's next step.

    samples/python/volume_texture.py [PICTURE]     default: out/volume_texture.png
"""
import sys
from pathlib import Path

import innermap
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SAMPLES = Path(__file__).resolve().parent.parent


def marble(places):
    """Linear colours (..., 3) at places (..., 3): veins where sheets that were stirred lie."""
    x, y, z = np.moveaxis(9 * places, -1, 0)
    stirred = x + 1.4 * np.sin(0.9 * y + 0.6 * np.sin(1.7 * x)) + 0.5 * np.sin(2.3 * y - 2.9 * z)
    vein = np.abs(np.sin(1.6 * stirred))[..., None] ** 0.6
    return vein * (0.75, 0.82, 0.78) + (1 - vein) * (0.02, 0.08, 0.10)


def cut(axes, grids, title):
    """The slice that has most of the solid; outside of it white."""
    density = grids["density"]
    k = np.argmax(density.sum(axis=(0, 1)))
    inside = density[:, :, k, None]
    colours = np.clip(grids["Cd"][:, :, k], 0, 1) ** (1 / 2.2)
    axes.imshow(np.swapaxes(inside * colours + 1 - inside, 0, 1), origin="lower",
                interpolation="bilinear")
    axes.axis("off")
    axes.set_title(title, fontsize=11)


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/volume_texture.png")
    picture.parent.mkdir(parents=True, exist_ok=True)
    atlas = str(picture.with_suffix(".exr"))

    gecko = innermap.voxelize(SAMPLES / "gecko.obj", resolution=192, fog=True)
    index = np.stack(np.indices(gecko.shape), axis=-1)
    places = index @ gecko.matrix[:3, :3].T + gecko.matrix[:3, 3]
    colours = marble(places).astype(np.float32)
    grids = innermap.grids({"density": gecko["density"], "Cd": colours}, gecko.matrix,
                           fogs="density")
    made = innermap.write_volume_texture(atlas, grids)
    again = innermap.read_volume_texture(atlas)
    assert np.array_equal(again["Cd"], colours) and np.allclose(again.matrix, gecko.matrix)
    print(f"{atlas}: {made['tiles'][0]} x {made['tiles'][1]} tiles of "
          f"{again.shape[0]} x {again.shape[1]} voxels, channels {', '.join(made['channels'])}")

    m = innermap.fit(SAMPLES / "gecko.obj", SAMPLES / "gecko_step.obj", tolerance=1e-2)
    posed = innermap.push(m, again)

    figure, axes = plt.subplots(1, 3, figsize=(11, 4.2), dpi=100, constrained_layout=True)
    cut(axes[0], again, "a slice of the arrays")
    columns, rows = made["tiles"]
    sheet = np.ones((rows * again.shape[1], columns * again.shape[0], 3))
    for k in range(again.shape[2]):
        row, column = divmod(k, columns)
        inside = again["density"][:, ::-1, k, None]
        tile = inside * np.clip(again["Cd"][:, ::-1, k], 0, 1) ** (1 / 2.2) + 1 - inside
        sheet[row * again.shape[1]:(row + 1) * again.shape[1],
              column * again.shape[0]:(column + 1) * again.shape[0]] = np.swapaxes(tile, 0, 1)
    axes[1].imshow(sheet, interpolation="antialiased")
    axes[1].axis("off")
    axes[1].set_title("all slices, as in the EXR atlas", fontsize=11)
    cut(axes[2], posed, "carried into a step")
    figure.savefig(picture)
    print(f"volume_texture: {picture}")


if __name__ == "__main__":
    main()
