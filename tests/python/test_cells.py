"""Tetrahedra and hexahedra: in meshio's terms, and as the program writes them."""

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


if __name__ == "__main__":
    cli.run(globals())
