"""Small solids as arrays, for the tests of the Python module."""

import numpy as np

import cli

# A fit of few charges on one shell: fast, and as exact as smooth shapes need.
FEW = {"tolerance": 1e-2}


def ball(subdivisions=3):
    """V, F of a unit ball."""
    vertices, faces = cli.icosphere_arrays(subdivisions)
    return np.array(vertices), np.array(faces)


def inside(count, radius=0.8, seed=1):
    """Random points of the unit ball."""
    generator = np.random.default_rng(seed)
    directions = generator.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return directions * radius * generator.random((count, 1)) ** (1 / 3)


def twisted(V):
    """Turned about the z axis, the more the higher."""
    angle = 0.5 * V[:, 2]
    x, y = V[:, 0], V[:, 1]
    return np.stack([np.cos(angle) * x - np.sin(angle) * y,
                     np.sin(angle) * x + np.cos(angle) * y, V[:, 2]], axis=1)


def bent(V):
    return V + np.stack([0.1 * np.sin(3 * V[:, 1]), 0.2 * V[:, 2] ** 2, 0.1 * V[:, 0]], axis=1)


def refuses(*cases):
    """Each case, (call, error, words), raises that error with these words."""
    for wrong, kind, says in cases:
        try:
            wrong()
        except kind as error:
            assert says in str(error), error
        else:
            raise AssertionError(f"no error: {says}")
