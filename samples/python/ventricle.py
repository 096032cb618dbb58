#!/usr/bin/python3
"""Fibres of a heart's left ventricle by rules, after Bayer, Blake, Plank and Trayanova, "A novel
rule-based algorithm for assigning myocardial fiber orientation to computational heart models"
(Annals of Biomedical Engineering 40, 2012), without tetrahedra:

- the wall's depth is the harmonic field that is 0 on its inside and 1 on its outside,
- from the apex to the base goes a second one, 0 at the one and 1 at the other,
- their gradients are a frame at each point of the wall, in which the fibres turn from +60 degrees
  to the circumference at the inside to -60 degrees at the outside.

    samples/python/ventricle.py [PICTURE]     default: out/ventricle.png
"""
import sys
from pathlib import Path

import innermap
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.append(str(Path(__file__).resolve().parents[1]))
from make_ventricle import ACROSS, DEEP, THICK, ventricle  # noqa: E402

INNER, OUTER, WANTED = 60.0, -60.0, 1e-2  # degrees, degrees, share of the field's span


def shell():
    """The mesh, V and F, and the triangles of inside, outside, base and apex, which is part of the outside."""
    V, groups = ventricle(around=48, along=20)
    ends = np.cumsum([0] + [len(some) for some in groups.values()])
    parts = {name: np.arange(a, b) for name, a, b in zip(groups, ends, ends[1:])}
    parts["outside"] = np.concatenate([parts["outside"], parts["apex"]])
    return np.array(V), np.array([face for some in groups.values() for face in some]), parts


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def fibres(depth, height, X):
    """Unit directions along the fibres at X, and their angles in degrees."""
    share = np.clip(depth(X)[:, None], 0, 1)
    up = unit(height.gradient(X))
    outward = depth.gradient(X)
    outward = unit(outward - np.sum(outward * up, axis=1, keepdims=True) * up)
    around = np.cross(up, outward)
    angle = np.radians(INNER * (1 - share) + OUTER * share)
    return np.cos(angle) * around + np.sin(angle) * up, np.degrees(angle[:, 0])


def between(share, around, along):
    """Points between the cavity's ellipsoid (share 0) and the outer one (1)."""
    across, deep = ACROSS + share * THICK, DEEP + share * THICK
    return np.stack([across * np.cos(along) * np.cos(around), across * np.cos(along) * np.sin(around),
                     -deep * np.sin(along)], axis=-1)


def layer(depth, wanted, around, along):
    """The points of that depth, between the ellipsoids."""
    low, high = np.zeros_like(around), np.ones_like(around)
    for _ in range(8):
        middle = 0.5 * (low + high)
        deeper = depth(between(middle, around, along)) < wanted
        low, high = np.where(deeper, middle, low), np.where(deeper, high, middle)
    return between(middle, around, along)


def trace(depth, height, X, step=0.09, steps=14):
    """Paths (steps, n, 3) along the fibres through X, both ways; NaN beyond the wall."""
    halves = []
    for way in (-step, step):
        path = [X]
        for _ in range(steps):
            at = path[-1]
            middle = at + 0.5 * way * fibres(depth, height, at)[0]
            path.append(at + way * fibres(depth, height, middle)[0])
        halves.append(np.array(path))
    path = np.concatenate([halves[0][:0:-1], halves[1]])
    outside = ~depth.contains(path.reshape(-1, 3)).reshape(path.shape[:2])
    path[outside] = np.nan
    return path


def draw_section(axes, depth, height):
    """The plane y = 0: depth as colours, height as lines."""
    x, z = np.meshgrid(np.linspace(-3.7, 3.7, 260), np.linspace(-7.7, 0.2, 280))
    X = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)
    inside = depth.contains(X)
    shown = [np.full(len(X), np.nan) for _ in range(2)]
    for values, field in zip(shown, (depth, height)):
        values[inside] = field(X[inside])
    depths, heights = (values.reshape(x.shape) for values in shown)
    colours = axes.contourf(x, z, depths, np.linspace(-0.02, 1.02, 27), cmap="viridis", extend="both")
    axes.contour(x, z, heights, np.linspace(0.1, 0.9, 9), colors="white", linewidths=0.9)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title("depth in the wall;\nlines: from apex to base", fontsize=11)
    bar = plt.colorbar(colours, ax=axes, orientation="horizontal", ticks=[0, 0.5, 1], shrink=0.7,
                       pad=0.03)
    bar.ax.set_xticklabels(["inside", "middle", "outside"])


def draw_layer(axes, depth, height, wanted, name):
    """The half of a layer of the wall that faces us, its fibres coloured by their angle."""
    rows = np.arcsin(np.linspace(0.03, 0.9, 16))
    along = np.repeat(rows, 12)
    around = np.pi * (1 + (np.tile(np.arange(12), 16) + 0.5 * (np.repeat(np.arange(16), 12) % 2)) / 12)
    starts = layer(depth, wanted, around, along)
    path = trace(depth, height, starts)
    angle = fibres(depth, height, starts)[1]
    path[path[..., 1] > 0] = np.nan
    order = np.argsort(-np.nanmin(path[..., 1], axis=0))  # the nearest last
    for i in order:
        axes.plot(path[:, i, 0], path[:, i, 2], lw=1.7, solid_capstyle="round",
                  color=plt.cm.turbo((angle[i] + 75) / 150))
    rim = np.linspace(0, np.pi / 2, 50)
    outline = between(wanted, 0 * rim, rim)
    for side in (-1, 1):
        axes.plot(side * outline[:, 0], outline[:, 2], color="0.75", lw=0.8)
    axes.set_xlim(-3.7, 3.7)
    axes.set_ylim(-7.7, 0.2)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title(f"fibres, {name}:\n{round(np.mean(angle)):d} degrees", fontsize=11)


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/ventricle.png")
    V, F, parts = shell()
    depth = innermap.harmonic(V, F, fix=[(parts["inside"], 0), (parts["outside"], 1)],
                              tolerance=WANTED)
    height = innermap.harmonic(V, F, fix=[(parts["apex"], 0), (parts["base"], 1)], tolerance=WANTED)
    for name, field in (("depth", depth), ("height", height)):
        print(f"{name}: {field.charges} charges, 99% of the surface within "
              f"{field.boundary_error.p99:.1e} of what was given there")

    figure, axes = plt.subplots(1, 4, figsize=(11, 4.3), dpi=100)
    draw_section(axes[0], depth, height)
    for ax, wanted, name in zip(axes[1:], (0.02, 0.5, 0.98), ("inside", "middle", "outside")):
        draw_layer(ax, depth, height, wanted, name)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.88, bottom=0.01, wspace=0.02)
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture)
    print(f"ventricle: {picture}")


if __name__ == "__main__":
    main()
