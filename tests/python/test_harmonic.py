"""Harmonic fields: conditions in all ways that arrays and callables give them."""

import math

import numpy as np

import cli
import innermap
import shapes


def cylinder(around=32, up=12):
    """V, F of a closed cylinder of radius and height 1, and its triangles' part: 0 the side, 1 the
    bottom, 2 the top."""
    phi = 2 * np.pi * np.arange(around) / around
    rings = [np.stack([np.cos(phi), np.sin(phi), 0 * phi + z], 1) for z in np.linspace(0, 1, up + 1)]
    V = np.concatenate([*rings, [[0, 0, 0], [0, 0, 1]]])
    F, part = [], []
    for j in range(around):
        k = (j + 1) % around
        for i in range(up):
            low, high = i * around, (i + 1) * around
            F += [(low + j, low + k, high + k), (low + j, high + k, high + j)]
            part += [0, 0]
        F += [(k, j, len(V) - 2), (up * around + j, up * around + k, len(V) - 1)]
        part += [1, 2]
    return V, np.array(F), np.array(part)


def test_meets_mixed_conditions_on_a_cylinder():
    V, F, part = cylinder()
    h = innermap.harmonic(V, F, fix=[(part == 1, [0, 5]), (part == 2, [1, 7])], names=["a", "b"])
    X = np.random.default_rng(3).uniform([-0.7, -0.7, 0.02], [0.7, 0.7, 0.98], (1000, 3))
    X = X[h.contains(X)]
    assert np.abs(h(X)[:, 0] - X[:, 2]).max() < 1e-3
    assert np.abs(h(X)[:, 1] - 5 - 2 * X[:, 2]).max() < 2e-3
    assert np.abs(h.gradient(X)[:, 0] - [0, 0, 1]).max() < 0.02
    assert h.channels == ["a", "b"] and h.tolerance_met
    # A flux in place of the upper value.
    g = innermap.harmonic(V, F, groups={"low": np.nonzero(part == 1)[0], "high": part == 2},
                          fix={"low": 3}, flux={"high": -2.0})
    assert np.abs(g(X) - (3 - 2 * X[:, 2])).max() < 2e-3
    flux = np.where(part == 2, -2.0, np.where(part == 0, 0.0, np.nan))
    same = innermap.harmonic(V, F, np.full(len(V), 3.0), flux=flux)
    assert np.abs(same(X) - g(X)).max() < 2e-3
    # Both as functions of the place; the triangles' own normals are those of the caps.
    called = innermap.harmonic(V, F, lambda P: 3 - 2 * P[:, 2], fix=part == 1, crease_angle=0,
                               flux=lambda P, N: -2 * N[:, 2])
    assert np.abs(called(X) - g(X)).max() < 2e-3
    # Vertices without a value leave the triangles about them free.
    values = np.where(V[:, 2] == 0, 3.0, np.where(V[:, 2] == 1, 5.0, np.nan))
    free = innermap.harmonic(V, F, values)
    assert np.abs(free(X) - (3 + 2 * X[:, 2])).max() < 2e-3


def test_weights_sum_up_to_one():
    """Here by their values alone; what fits lack is shared out in FitHarmonic's unit test."""
    V, F, part = cylinder()
    w = innermap.weights(V, F, {"low": part == 1, "high": np.nonzero(part == 2)[0]})
    X = shapes.inside(500, 0.9) * [1, 1, 0.5] + [0, 0, 0.5]
    assert w.channels == ["low", "high"]
    assert np.abs(w(X).sum(1) - 1).max() < 1e-12
    assert np.abs(w(X)[:, 1] - X[:, 2]).max() < 2e-2
    grids = w.evaluate(resolution=16, gradients=False, directions=False, magnitudes=False)
    assert set(grids) == {"surface", "density", "low", "high"}


def test_keeps_its_field_in_a_file():
    V, F = shapes.ball(2)
    h = innermap.harmonic(V, F, V[:, 0] * V[:, 1], names=["saddle"], tolerance=1e-2)
    h.save("field.ply")
    again = innermap.load("field.ply")
    X = shapes.inside(50)
    assert isinstance(again, innermap.Field) and np.array_equal(again(X), h(X))
    assert again(X).shape == (50,) and again.gradient(X).shape == (50, 3)
    assert again.channels == ["saddle"] and math.isclose(again.bound, h.bound, rel_tol=1e-6)
    assert "harmonic field" in cli.innermap("info", "field.ply").stdout


def test_reads_what_the_program_wrote():
    V, F = shapes.ball(2)
    low = V[F].mean(1)[:, 2] < -0.5
    high = V[F].mean(1)[:, 2] > 0.5
    with open("ball.obj", "w", encoding="ascii") as file:
        file.writelines("v %.17g %.17g %.17g\n" % tuple(v) for v in V)
        for name, which in (("low", low), ("high", high), ("side", ~(low | high))):
            file.write(f"g {name}\n")
            file.writelines("f %d %d %d\n" % tuple(f + 1) for f in F[which])
    cli.innermap("harmonic", "ball.obj", "-o", "f.vdb", "--field", "f.ply", "--fix", "low=0,high=1",
                 "--tolerance", 0.05, "--resolution", 12)
    X = shapes.inside(100)
    theirs = innermap.load("f.ply")
    ours = innermap.harmonic("ball.obj", fix={"low": 0, "high": 1}, tolerance=0.05)
    assert np.array_equal(theirs(X), ours(X))
    assert theirs.facts == ours.facts
    w = innermap.weights("ball.obj", ["high", "low"], tolerance=0.1)
    assert w.channels == ["high", "low"]


def test_names_what_is_wrong():
    V, F = shapes.ball(1)
    x = V[:, 0]
    none = np.array([], int)
    shapes.refuses(
        (lambda: innermap.harmonic(V, F), TypeError, "give `values` or `fix`"),
        (lambda: innermap.harmonic(V, F, x, x), TypeError, "no more"),
        (lambda: innermap.harmonic(V, F, x[1:]), innermap.DataError, "values: expects 42 rows"),
        (lambda: innermap.harmonic(V, F, "x"), TypeError, "values: "),
        (lambda: innermap.harmonic(V, F, x, names=["a", "b"]), ValueError, "names: "),
        (lambda: innermap.harmonic(V, F, x, names="a"), TypeError, "names: "),
        (lambda: innermap.harmonic(V, F, np.full(42, np.nan)), innermap.DataError, "value"),
        (lambda: innermap.harmonic(V, F, lambda P: P[1:]), ValueError, "values: expects"),
        (lambda: innermap.harmonic(V, F, x, flux=lambda P, N: x), ValueError, "flux: "),
        (lambda: innermap.harmonic(V, F, fix=[]), ValueError, "fix: is empty"),
        (lambda: innermap.harmonic(V, F, fix={"a": 1}), ValueError, "no group 'a'"),
        (lambda: innermap.harmonic(V, F, fix=[([80], 1)]), ValueError, "fix: has 80"),
        (lambda: innermap.harmonic(V, F, fix=[([0], np.inf)]), ValueError, "fix: "),
        (lambda: innermap.harmonic(V, F, fix=[([0], 1), ([1], [1, 2])]), ValueError, "fix: has 2"),
        (lambda: innermap.harmonic(V, F, fix=[(none, 1)]), ValueError, "small ball or tube"),
        (lambda: innermap.harmonic(V, F, fix=[(np.ones(3, bool), 1)]), ValueError, "a mask"),
        (lambda: innermap.weights(V, F, {"a": [1]}), ValueError, "two groups"),
        (lambda: innermap.weights(V, F, {"a": [1], "b": none}), ValueError, "small ball"),
        (lambda: innermap.weights(V, F, {"a": [1], "b": [1]}), ValueError, "triangle 1"),
        (lambda: innermap.weights(V, F, ["a"]), ValueError, "no group 'a'"),
        (lambda: innermap.harmonic(V, F, x, max_memory="5MB"), MemoryError, "5 MB"))


if __name__ == "__main__":
    cli.run(globals())
