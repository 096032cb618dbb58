#!/usr/bin/python3
"""The cells on which a map is proven not to fold: a slice through a gecko that takes a step. Cells are
small where charges are near.

    samples/python/proof_cells.py [PICTURE]     default: out/proof_cells.png
"""
import sys
from pathlib import Path

import innermap
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import PatchCollection  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402

SAMPLES = Path(__file__).resolve().parent.parent


def cut(cells, height):
    """Squares in which a plane z = height meets the cubes."""
    met = cells[np.abs(cells[:, 2] - height) < cells[:, 3]]
    return [Rectangle((x - r, y - r), 2 * r, 2 * r) for x, y, _, r in met], met


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/proof_cells.png")
    V, F = innermap.read_mesh(SAMPLES / "gecko.obj")
    m = innermap.fit(V, F, innermap.read_mesh(SAMPLES / "gecko_step.obj").vertices, tolerance=1e-3)
    proven, undecided, folded = m.proof_cells()
    print(f"{m.charges} charges; cells: {len(proven)} proven, {len(undecided)} undecided, "
          f"{len(folded)} folded")

    figure, axes = plt.subplots(1, 2, figsize=(10, 5), dpi=100, constrained_layout=True)
    height = np.median(V[:, 2])
    squares, met = cut(proven, height)
    shown = axes[0].add_collection(PatchCollection(squares, edgecolor="white", linewidth=0.3,
                                                   cmap="viridis_r"))
    shown.set_array(np.log2(met[:, 3].max() / met[:, 3]))
    for cells, colour in ((undecided, "orange"), (folded, "red")):
        axes[0].add_collection(PatchCollection(cut(cells, height)[0], facecolor=colour))
    axes[0].set_title("each square: det J > 0 in the whole cube", fontsize=11)

    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    for x, y, _, r in met:
        edge = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in zip(corners, corners[1:])])
        points = np.column_stack([[x, y] + r * edge, np.full(len(edge), height)])
        inside = m.contains(points)
        moved = np.full((len(points), 3), np.nan)
        moved[inside] = m(points[inside])
        axes[1].plot(*np.vstack([moved, moved[:1]])[:, :2].T, color="#35608d", linewidth=0.4)
    axes[1].set_title("where the map takes them", fontsize=11)
    for ax in axes:
        ax.set_aspect("equal")
        ax.autoscale_view()
        ax.axis("off")
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture)
    print(f"proof cells: {picture}")


if __name__ == "__main__":
    main()
