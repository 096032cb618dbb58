"""Muscle fibres in the wall of a heart's left ventricle, found by rules in two harmonic fields (see
samples/python/ventricle.py): three layers, the outer ones cut away to show what is below.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/fibres.py -- OUT.jpg [SAMPLES]
"""
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "python")]
import innermap  # noqa: E402
import studio  # noqa: E402
import ventricle  # noqa: E402

AROUND, RADIUS = 8, 0.032
# Depth in the wall, and from and to which angle around the axis the layer is shown.
LAYERS = ((0.03, 0, 360), (0.27, 212, 360), (0.5, 242, 360), (0.73, 272, 360), (0.97, 303, 360))


def tubes(paths):
    """Points and quadrilaterals about paths (steps, n, 3)."""
    steps, count = paths.shape[:2]
    ahead = np.gradient(paths, axis=0)
    ahead /= np.linalg.norm(ahead, axis=-1, keepdims=True)
    side = np.cross(ahead, [0, 0, 1.0])
    side /= np.linalg.norm(side, axis=-1, keepdims=True) + 1e-12
    over = np.cross(side, ahead)
    a = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)[:, None]
    thin = RADIUS * np.sqrt(np.sin(np.linspace(0.03, 0.97, steps) * np.pi))[:, None, None, None]
    points = paths[:, :, None] + thin * (np.cos(a) * side[:, :, None] + np.sin(a) * over[:, :, None])
    index = np.arange(steps * count * AROUND).reshape(steps, count, AROUND)
    turned = np.roll(index, -1, axis=2)
    faces = np.stack([index[:-1], turned[:-1], turned[1:], index[1:]], axis=-1).reshape(-1, 4)
    return points.reshape(-1, 3), faces


def main():
    out, samples = studio.arguments(__doc__)
    studio.scene((900, 840), samples, 0.5)
    V, F, parts = ventricle.shell()
    depth = innermap.harmonic(V, F, fix=[(parts["inside"], 0), (parts["outside"], 1)], tolerance=1e-2)
    height = innermap.harmonic(V, F, fix=[(parts["apex"], 0), (parts["base"], 1)], tolerance=1e-2)
    thread = studio.painted("fibre", 0.35, 0.5)
    rng = np.random.default_rng(3)
    for wanted, first, last in LAYERS:
        rows = np.arcsin(np.linspace(0.04, 0.93, 34))
        along, around = [], []
        for k, row in enumerate(rows):
            n = max(6, int(64 * np.cos(row)))
            turn = np.linspace(0, 2 * np.pi, n, endpoint=False) + k * 0.7
            around += list(turn + rng.uniform(-0.03, 0.03, n))
            along += [row] * n
        around, along = np.array(around), np.array(along)
        shown = (np.degrees(around) % 360 >= first) & (np.degrees(around) % 360 <= last)
        starts = ventricle.layer(depth, wanted, around[shown], along[shown])
        paths = ventricle.trace(depth, height, starts, step=0.07, steps=8)
        paths = paths[:, ~np.isnan(paths).any(axis=(0, 2))]
        angle = ventricle.fibres(depth, height, paths.reshape(-1, 3))[1]
        rgb = studio.ramp(0.08 + 0.84 * (angle + 60) / 120)
        points, faces = tubes(paths)
        studio.mesh("fibres", points, faces, thread, np.repeat(rgb, AROUND, axis=0))
    studio.floor(-ventricle.DEEP - ventricle.THICK - 0.35)
    studio.camera((0, -20, 5.5), (0, 0, -3.55), lens=80)
    studio.light((-8, -10, 9), (0, 0, -3), 5, 2600, (1, 0.95, 0.88))
    studio.light((9, -8, 2), (0, 0, -4), 7, 900, (0.85, 0.93, 1))
    studio.render(out, 0.05)


if __name__ == "__main__":
    main()
