#!/usr/bin/python3
"""Points inside a gecko, driven by the gecko's next step: only the two surfaces say how.

    samples/python/pose.py [PICTURE]     default: out/pose.png
"""
import sys
from pathlib import Path

import innermap
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SAMPLES = Path(__file__).resolve().parent.parent


def lattice(m, spacing):
    """Points inside the solid of m, in the plane half way up."""
    V, _ = m.source
    low, high = V.min(axis=0), V.max(axis=0)
    x, y = np.meshgrid(*(np.arange(low[i], high[i], spacing) for i in (0, 1)))
    X = np.stack([x.ravel(), y.ravel(), np.full(x.size, np.median(V[:, 2]))], axis=1)
    return X[m.contains(X)]


def draw(axes, mesh, points, title, **colours):
    V, F = mesh
    axes.tripcolor(V[:, 0], V[:, 1], F, np.zeros(len(F)), cmap="Greys", vmin=-0.25, vmax=1)
    shown = axes.scatter(points[:, 0], points[:, 1], s=5, zorder=2, **colours)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title(title, fontsize=11)
    return shown


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/pose.png")
    m = innermap.fit(SAMPLES / "gecko.obj", SAMPLES / "gecko_step.obj", tolerance=1e-2)
    print(f"{m.charges} charges; 99% of the surface within {m.boundary_error.p99:.1e} of the diagonal")
    X = lattice(m, 0.02)
    Y, J = m(X, jacobian=True)
    growth = np.log2(np.maximum(np.linalg.det(J), 1e-3))  # of volumes
    back, found = m.inverse(Y)
    print(f"{len(X)} points; the inverse brings {np.mean(found):.1%} of them back to within "
          f"{np.linalg.norm(back - X, axis=1)[found].max():.1e}")

    figure, axes = plt.subplots(1, 3, figsize=(11, 4.4), dpi=100, constrained_layout=True)
    step = innermap.read_mesh(SAMPLES / "gecko_step.obj")
    stripes = np.where(np.floor(8 * X[:, 1]) % 2, "teal", "goldenrod")
    draw(axes[0], m.source, X, "points inside, at rest", c=stripes)
    draw(axes[1], step, Y, "where the map takes them", c=stripes)
    shown = draw(axes[2], step, Y, "how volumes change", c=growth, cmap="coolwarm", vmin=-0.35,
                 vmax=0.35)
    bar = figure.colorbar(shown, ax=axes[2], shrink=0.6, ticks=np.log2([0.8, 0.9, 1, 1.1, 1.25]))
    bar.ax.set_yticklabels(["0.8", "0.9", "1", "1.1", "1.25"])
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture)
    print(f"pose: {picture}")


if __name__ == "__main__":
    main()
