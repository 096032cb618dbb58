#!/usr/bin/python3
"""A harmonic field inside a gecko: 1 on its head, 0 on its tail, and nothing flows through the rest
of its skin; with its gradient. No tetrahedra.

    samples/python/field.py [PICTURE]     default: out/field.png
"""
import sys
from pathlib import Path

import innermap
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SAMPLES = Path(__file__).resolve().parent.parent


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/field.png")
    V, F = innermap.read_mesh(SAMPLES / "gecko.obj")
    x, y, _ = V[F].mean(axis=1).T  # of the triangles' middles
    length = np.ptp(V[:, 1])
    body = np.abs(x) < 0.1 * length  # not the hands and feet
    tail = body & (y < V[:, 1].min() + 0.3 * length)
    head = body & (y > V[:, 1].max() - 0.2 * length)
    h = innermap.harmonic(V, F, fix=[(tail, 0), (head, 1)], tolerance=2e-2)
    print(f"{h.charges} charges; 99% of the patches within {h.boundary_error.p99:.1e} of their values")

    low, high = V.min(axis=0), V.max(axis=0)
    x, y = np.meshgrid(np.linspace(low[0], high[0], 240), np.linspace(low[1], high[1], 300))
    X = np.stack([x, y, np.full_like(x, np.median(V[:, 2]))], axis=-1).reshape(-1, 3)
    inside = h.contains(X)
    values, slopes = np.full(len(X), np.nan), np.full((len(X), 3), np.nan)
    values[inside], slopes[inside] = h(X[inside]), h.gradient(X[inside])
    steep = np.linalg.norm(slopes, axis=1) * length

    figure, axes = plt.subplots(1, 2, figsize=(10, 5), dpi=100, constrained_layout=True)
    shown = axes[0].contourf(x, y, values.reshape(x.shape), np.linspace(0, 1, 26), cmap="viridis",
                             extend="both")
    axes[0].contour(x, y, values.reshape(x.shape), np.linspace(0.05, 0.95, 19), colors="white",
                    linewidths=0.7)
    figure.colorbar(shown, ax=axes[0], shrink=0.6, ticks=np.linspace(0, 1, 6))
    axes[0].set_title("0 on the tail, 1 on the head", fontsize=11)
    shown = axes[1].pcolormesh(x, y, steep.reshape(x.shape), cmap="magma", shading="nearest",
                               vmin=0, vmax=np.nanpercentile(steep, 99))
    axes[1].streamplot(x, y, slopes[:, 0].reshape(x.shape), slopes[:, 1].reshape(x.shape),
                       color="white", linewidth=0.6, arrowsize=0.7, density=2.2)
    figure.colorbar(shown, ax=axes[1], shrink=0.6)
    axes[1].set_title("its gradient, per length of the body", fontsize=11)
    for ax in axes:
        ax.set_aspect("equal")
        ax.axis("off")
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture)
    print(f"field: {picture}")


if __name__ == "__main__":
    main()
