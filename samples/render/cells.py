"""Tetrahedra in a gecko and hexahedra in a torus, cut open; colours are the quality of each cell.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/cells.py -- OUT.jpg [SAMPLES]
"""
import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parent))
import innermap  # noqa: E402
import studio  # noqa: E402

SHRUNK = 0.93  # of each cell, about its middle, so that cells show
TETRA_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
HEXA_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
HEXA_EDGES = [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def least_angle(corners):
    """The least dihedral angle of each tetrahedron, in degrees."""
    normals = [unit(np.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a]))
               for a, b, c in TETRA_FACES]
    angles = [np.degrees(np.arccos(np.clip(-np.sum(p * q, axis=1), -1, 1)))
              for i, p in enumerate(normals) for q in normals[:i]]
    return np.min(angles, axis=0)


def scaled_jacobian(corners):
    """The least over each hexahedron's corners: 1 for a cube."""
    out = [np.einsum("ij,ij->i", unit(corners[:, a] - corners[:, i]),
                     np.cross(unit(corners[:, b] - corners[:, i]), unit(corners[:, c] - corners[:, i])))
           for i, (a, b, c) in enumerate(HEXA_EDGES)]
    return np.min(out, axis=0)


def show(points, cells, faces, share, kept, at):
    """The cells that are kept, drawn together; share: of the colour scale."""
    corners = points[cells[kept]]
    middle = corners.mean(axis=1, keepdims=True)
    P = (middle + SHRUNK * (corners - middle)).reshape(-1, 3)
    first = corners.shape[1] * np.arange(len(corners))[:, None, None]
    quads = (first + np.array(faces)[None]).reshape(-1, len(faces[0]))
    rgb = np.repeat(studio.ramp(0.92 - 0.80 * share[kept]), corners.shape[1], axis=0)
    return studio.mesh("cells", P, quads, studio.painted("cells", 0.5, 0.25), rgb, at, smooth=False)


def bar(at, width, words, camera):
    """A colour scale with its name above and its ends below."""
    steps = np.linspace(0, 1, 65)
    points = [(at[0] + (t - 0.5) * width, at[1] + y, at[2]) for t in steps for y in (0, 0.055)]
    faces = [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(64)]
    made, nodes, links, out = studio.material("scale")
    ink, colour = nodes.new('ShaderNodeEmission'), nodes.new('ShaderNodeVertexColor')
    colour.layer_name = "rgb"
    links.new(colour.outputs[0], ink.inputs[0])
    links.new(ink.outputs[0], out.inputs["Surface"])
    studio.mesh("scale", points, faces, made, np.repeat(studio.ramp(0.92 - 0.80 * steps), 2, axis=0))
    name, low, high = words
    studio.label(name, (at[0], at[1] + 0.13, at[2]), 0.085, camera)
    for text, x in ((low, -0.5), (high, 0.5)):
        studio.label(text, (at[0] + x * width, at[1] - 0.06, at[2]), 0.075, camera)


def main():
    out, samples = studio.arguments(__doc__)
    studio.scene((1100, 640), samples, 0.5)
    V, F = innermap.read_mesh(studio.ROOT / "samples/gecko.obj")
    tetra = innermap.tetrahedralize(V, F, resolution=34)
    points, cells = np.asarray(tetra.points), tetra.cells_dict["tetra"]
    angle = least_angle(points[cells])
    kept = points[cells].mean(axis=1)[:, 2] < 0.0
    show(points, cells, TETRA_FACES, np.clip((angle - 10) / 50, 0, 1), kept, (-1.0, 0.20, 0))
    V, F = innermap.read_mesh(studio.ROOT / "samples/torus.obj")
    cubes = innermap.hexahedralize(V, F)
    points, cells = 0.60 * np.asarray(cubes.points), cubes.cells_dict["hexahedron"]
    quality = scaled_jacobian(points[cells])
    print(f"least angle {angle.min():.1f}, scaled Jacobian {quality.min():.2f} to {quality.max():.2f}")
    middle = points[cells].mean(axis=1)
    kept = (middle[:, 2] < 0) | ((middle[:, 1] > 0) & (middle[:, 0] < 0.25))
    show(points, cells, HEXA_FACES, np.clip((quality - 0.3) / 0.7, 0, 1), kept, (1.05, 0.12, 0))
    studio.mesh("floor", [(-40, -40, -0.33), (40, -40, -0.33), (40, 40, -0.33), (-40, 40, -0.33)],
                [(0, 1, 2, 3)], studio.plain("paper", studio.PAPER, 0.9))
    camera = studio.camera((0, -0.6, 8), (0, -0.04, 0), across=4.6)
    bar((-1.0, -1.24, 0.1), 0.9, ("least dihedral angle, degrees", "10", "60"), camera)
    bar((1.05, -1.24, 0.1), 0.9, ("scaled Jacobian", "0.3", "1"), camera)
    studio.light((-3, 2.5, 4.5), (0, 0, 0), 2, 260, (1, 0.95, 0.88))
    studio.light((4, -3, 4), (0, 0, 0), 4, 80, (0.85, 0.93, 1))
    studio.render(out, 0.025)


if __name__ == "__main__":
    main()
