"""Tetrahedra and hexahedra: in meshio's terms, and as the program writes them."""

import collections
import fractions
import itertools
import os
import sys

import numpy as np

import cli
import innermap
import shapes


def same(a, b):
    assert np.array_equal(a.points, b.points)
    assert a.cells_dict.keys() == b.cells_dict.keys()
    for kind, cells in a.cells_dict.items():
        assert np.array_equal(cells, b.cells_dict[kind])
    for one, other in ((a.point_data, b.point_data), (a.cell_data, b.cell_data)):
        assert one.keys() == other.keys()
        for name in one:
            assert np.array_equal(one[name], other[name]), name


def cli_seed():
    return int(os.environ.get("INNERMAP_TEST_SEED", 1))


def as_cells(points, cells):
    """Through a file that holds them as they are."""
    import meshio
    meshio.write("as.vtu", meshio.Mesh(points, cells))
    return innermap.read_cells("as.vtu")


def test_fills_with_tetrahedra_as_the_program_does():
    V, F = shapes.ball(3)
    innermap.write_mesh("ball.obj", V, F)
    cells = innermap.tetrahedralize(V, F, resolution=10)
    cli.innermap("tetrahedralize", "ball.obj", "-o", "program.vtu", "--resolution", "10")
    same(cells, innermap.read_cells("program.vtu"))
    quality = cells.quality()
    assert quality["inverted"] == 0 and quality["least_dihedral"].min() >= 10
    assert cells.figures["components"] == 1 and cells.figures["least_dihedral"] >= 10
    surface = cells.surface()
    assert innermap.tetrahedralize(surface, resolution=8).figures["inverted"] == 0


def test_goes_to_meshio_and_back():
    import meshio
    V, F = shapes.ball(2)
    cells = innermap.tetrahedralize(V, F, resolution=8)
    mesh = cells.to_meshio()
    assert isinstance(mesh, meshio.Mesh)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    mesh.point_data["fibre"] = np.tile([0.0, 0.0, 1.0], (len(mesh.points), 1))
    mesh.cell_data["label"] = [np.arange(len(mesh.cells[0].data))]
    pushed = innermap.push(m, mesh, vectors="fibre")
    Y, J = m(mesh.points[:20], jacobian=True)
    assert np.abs(pushed.points[:20] - Y).max() < 1e-5
    assert np.abs(pushed.point_data["fibre"][:20] - J[:, :, 2]).max() < 1e-3
    assert pushed.cell_data["label"][0].dtype.kind == "i"
    assert np.array_equal(pushed.cell_data["label"][0], mesh.cell_data["label"][0])
    pushed.write("pushed.vtu")
    same(innermap.read_cells("pushed.vtu"), pushed)
    assert np.array_equal(meshio.read("pushed.vtu").points, pushed.points)


def test_does_without_meshio():
    V, F = shapes.ball(2)
    cells = innermap.tetrahedralize(V, F, resolution=8)
    again = innermap.push(innermap.fit(V, F, V, **shapes.FEW), (cells.points, cells.cells_dict))
    assert np.abs(again.points - cells.points).max() < 1e-6
    had = sys.modules.get("meshio")
    sys.modules["meshio"] = None  # not to be imported
    try:
        cells.to_meshio()
    except ImportError:
        pass
    else:
        raise AssertionError("no error")
    finally:
        sys.modules.pop("meshio")
        if had:
            sys.modules["meshio"] = had


def test_remeshes_as_the_program_does():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    m.save("map.ply")
    cells = innermap.tetrahedralize(V, F, resolution=10)
    cells.write("rest.vtu")
    made = innermap.remesh(m, cells)
    cli.innermap("remesh", "map.ply", "rest.vtu", "-o", "program.vtu")
    same(made, innermap.read_cells("program.vtu"))
    assert made.figures["inverted"] == 0
    X = shapes.inside(20, radius=0.6)
    through, found = innermap.push(m, X, through=made)
    assert found.all() and np.abs(through - m(X)).max() < 0.05
    back, _ = innermap.pull(m, through, through=made)
    assert np.abs(back - X).max() < 1e-9


def test_fills_with_hexahedra_as_the_program_does():
    V, F = shapes.ball(2)
    innermap.write_mesh("ball.obj", V, F)
    cells = innermap.hexahedralize((V, F), blocks=4)
    cli.innermap("hexahedralize", "ball.obj", "-o", "program.vtu", "--blocks", "4")
    same(cells, innermap.read_cells("program.vtu"))
    assert cells.figures["proven"] and cells.cells_dict["hexahedron"].shape[1] == 8
    assert len(cells.figures["in_blocks"].points) == len(cells.points)


def test_stands_cubes_in_as_the_program_does():
    V, F = shapes.ball(3)
    innermap.write_mesh("ball.obj", V, F)
    (W, G), figures = innermap.polycube(V, F, blocks=5)
    cli.innermap("polycube", "ball.obj", "-o", "program.obj", "--blocks", "5")
    P, Q = innermap.read_mesh("program.obj")
    assert np.allclose(W, P) and np.array_equal(G, Q) and len(W) >= 3000
    assert figures["across"] == 5 and figures["handles"] == 0


def test_compares_with_finite_elements():
    V, F = shapes.ball(3)
    table = innermap.compare_fem(V, F, resolutions=[6, 12], charges=[100], samples=1000)
    assert table["method"] == ["elements", "elements", "charges"]
    assert table["value_error"][1] < table["value_error"][0] and table["value_order"] > 1
    table = innermap.compare_fem(V, F, shapes.twisted(V), resolutions=[8], tolerances=[2e-2],
                                 reference=1e-2, samples=1000)
    assert len(table["harmonic_energy"]) == 2 and (table["folded"] == 0).all()


def test_ends_when_progress_raises():
    V, F = shapes.ball(3)

    class Stop(Exception):
        pass

    def stop(stage, share):
        assert stage and 0 <= share <= 1
        raise Stop

    for call in (lambda: innermap.tetrahedralize(V, F, resolution=160, progress=stop),
                 lambda: innermap.voxelize(V, F, resolution=800, progress=stop),
                 lambda: innermap.study(V, F, shapes.twisted(V), progress=stop),
                 lambda: innermap.deform((V, F), 0.3 * V, [V] * 8, progress=stop)):
        try:
            call()
        except Stop:
            pass
        else:
            raise AssertionError("was not stopped")


def test_refuses_what_are_no_cells():
    V, F = shapes.ball(1)
    m = innermap.fit(V, F, V, **shapes.FEW)
    shapes.refuses(
        (lambda: innermap.remesh(m, (V, {"wedge": np.zeros((1, 6), int)})), ValueError, "wedge"),
        (lambda: innermap.remesh(m, (V, {"tetra": [[0, 1, 2, 999]]})), ValueError, "999"),
        (lambda: innermap.remesh(m, (V, {"tetra": [[0, 1, 2]]})), ValueError, "(n, 4)"),
        (lambda: innermap.remesh(m, (V, {"triangle": F})), ValueError, "no cells"),
        (lambda: innermap.read_cells("nothing.vtu"), innermap.FileError, "nothing.vtu"),
        (lambda: innermap.tetrahedralize(V, F, resolution=2), innermap.SettingError,
         "resolution"),
        (lambda: innermap.tetrahedralize(V), TypeError, "triangles"))


def determinant(a, b, c, d):
    """Six times the tetrahedron's volume, exact for Fractions."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([q - p for p, q in zip(a, e)] for e in (b, c, d))
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


def exact(points):
    return [tuple(map(fractions.Fraction, p)) for p in points]


def nearly_flat(random, corners, scale, far):
    """Corners in a plane, but for rounding and now and then a little more."""
    axes = random.normal(size=(2, 3)) * 10.0 ** random.uniform(-4, 0, size=(2, 1))
    flat = random.uniform(-1, 1, size=(corners, 2)) @ axes
    flat += random.normal(size=(corners, 3)) * random.choice([0, 1e-16, 1e-12])
    return scale * (flat + far * random.normal(size=3))


def test_signs_are_those_of_fractions():
    """Of nearly flat tetrahedra at scales from 1e-9 to 1e9, near the origin and far from it."""
    seed = cli_seed()
    random = np.random.default_rng(seed)
    plain_wrong = exactly = 0
    for scale in 1e-9, 1.0, 1e9:
        for far in 0, 1, 1e6:
            points = np.concatenate([nearly_flat(random, 4, scale, far) for _ in range(300)])
            cells = as_cells(points, {"tetra": np.arange(len(points)).reshape(-1, 4)})
            known = exact(points.tolist())
            signs = [determinant(*known[i:i + 4]) > 0 for i in range(0, len(known), 4)]
            proof = cells.prove()
            assert proof["not_right_side_out"] == signs.count(False), (seed, scale, far, proof)
            assert proof["undecided"] == 0, (seed, scale, far, proof)
            exactly += proof["exact"]
            assert cells.quality()["inverted"] == signs.count(False), (seed, scale, far)
            edges = points.reshape(-1, 4, 3)[:, 1:] - points.reshape(-1, 4, 3)[:, :1]
            plain_wrong += int((np.linalg.det(edges) > 0).tolist() != signs)
            # As written, each of them: the same vertices.
            for end in "vtu", "msh", "mesh":
                cells.write(f"flat.{end}")
                again = innermap.read_cells(f"flat.{end}")
                assert np.array_equal(again.points, points), (seed, end)
                assert again.prove() == proof, (seed, end)
    assert plain_wrong >= 5 and exactly >= 5, (seed, plain_wrong, exactly)


def bernstein(p):
    """The 27 coefficients of a hexahedron's determinant, exact, by (x, y, z)."""
    bits = {(x, y, z): p[[0, 1, 3, 2, 4, 5, 7, 6][x + 2 * y + 4 * z]]
            for x in (0, 1) for y in (0, 1) for z in (0, 1)}
    zero = (fractions.Fraction(0),) * 3

    def edge(axis, i, j):
        """Along the axis, with the bits i, j of the other two."""
        low, high = [i, j], [i, j]
        low.insert(axis, 0)
        high.insert(axis, 1)
        return tuple(b - a for a, b in zip(bits[tuple(low)], bits[tuple(high)]))

    out = collections.defaultdict(fractions.Fraction)
    for y1, z1, x1, z2, x2, y2 in itertools.product((0, 1), repeat=6):
        at = (x1 + x2, y1 + y2, z1 + z2)
        out[at] += determinant(zero, edge(0, y1, z1), edge(1, x1, z2), edge(2, x2, y2)) / \
            2 ** at.count(1)
    return out


def test_hexahedra_are_decided_as_fractions_decide():
    seed = cli_seed()
    random = np.random.default_rng(seed)
    cube = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    counts = collections.Counter()
    for scale in 1e-9, 1.0, 1e9:
        for far in 0, 1, 1e6:
            for _ in range(15):
                # Thin: from 1e-18 to 1 in height.
                shape = cube * [1, 1, 10.0 ** random.uniform(-18, 0)] @ random.normal(size=(3, 3))
                shape += shape * random.normal(size=shape.shape) * random.choice([0, 1e-16, 0.05])
                shape = shape if np.linalg.det(shape[[1, 3, 4]] - shape[0]) > 0 else shape[[4, 5, 6, 7, 0, 1, 2, 3]]
                points = scale * (shape + far * random.normal(size=3))
                proof = as_cells(points, {"hexahedron": np.arange(8).reshape(1, 8)}).prove()
                known = bernstein(exact(points.tolist()))
                corners = [known[at] for at in itertools.product((0, 2), repeat=3)]
                where = (seed, scale, far, points.tolist(), proof)
                assert not proof["one_to_one"], where  # curved faces
                if min(corners) <= 0:
                    assert proof["not_right_side_out"] == 1, where
                if proof["not_right_side_out"]:
                    assert min(known.values()) <= 0, where
                if proof["right_side_out"]:
                    assert min(corners) > 0, where
                if proof["right_side_out"] and min(known.values()) <= 0:
                    counts["by halves"] += 1
                counts[proof["statement"][:8]] += 1
    assert len(counts) >= 2, (seed, counts)


if __name__ == "__main__":
    cli.run(globals())
