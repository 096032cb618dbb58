"""The module itself: maps, arrays and errors."""

import numpy as np

import cli
import innermap
import shapes


def test_maps_points_and_derivatives():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    X = shapes.inside(200)
    Y, J = m(X, jacobian=True)
    assert Y.shape == (200, 3) and J.shape == (200, 3, 3)
    h = 1e-5
    for axis in range(3):
        step = np.eye(3)[axis] * h
        difference = (m(X + step) - m(X - step)) / (2 * h)
        assert np.abs(difference - J[:, :, axis]).max() < 1e-6


def test_keeps_its_map_in_a_file():
    V, F = shapes.ball(2)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    m.save("map.ply")
    X = shapes.inside(50)
    assert np.array_equal(innermap.load("map.ply")(X), m(X))
    assert "harmonic field" in cli.innermap("info", "map.ply").stdout


def test_names_the_argument_that_is_wrong():
    V, F = shapes.ball(1)
    m = innermap.fit(V, F, V, **shapes.FEW)
    nan = V.copy()
    nan[3, 1] = np.nan
    shapes.refuses(
        (lambda: innermap.fit(V, F, V, tolerence=1), TypeError, "is it 'tolerance'"),
        (lambda: innermap.fit(V, F, V, tolerance=3), innermap.SettingError, "tolerance: "),
        (lambda: innermap.fit(V, F, V, tolerance="a"), TypeError, "tolerance: "),
        (lambda: innermap.fit(V, F + 1, V), innermap.DataError, "F: row"),
        (lambda: innermap.fit(V, F - 1, V), innermap.DataError, "F: row"),
        (lambda: innermap.fit(V, F.astype(float), V), TypeError, "F: expects"),
        (lambda: innermap.fit(V[:, :2], F, V), ValueError, "V: expects an array of shape"),
        (lambda: innermap.fit(nan, F, V), ValueError, "V: row 3 is not finite"),
        (lambda: innermap.fit(V, F, nan), ValueError, "V_target: row 3 is not finite"),
        (lambda: innermap.fit(V[:0], F, V), ValueError, "V: is empty"),
        (lambda: innermap.fit(V, F[:0], V), ValueError, "F: "),
        (lambda: innermap.fit("nothing.obj", V), innermap.FileError, "nothing.obj"),
        (lambda: innermap.fit("nothing.obj", V), OSError, "nothing.obj"),
        (lambda: m(np.zeros((3, 2))), ValueError, "X: expects an array of shape (n, 3)"),
        (lambda: m("text"), TypeError, "X: expects"),
        (lambda: m(None), TypeError, "X: expects"),
        (lambda: m(1j * V), TypeError, "X: expects"),
        (lambda: m(), TypeError, "lacks its argument 'X'"),
        (lambda: innermap.Map.save(), TypeError, "save() is a method of Map"),
        (lambda: innermap.Map.save("m.ply", "m.ply"), TypeError, "save() is a method of Map"))


def test_refuses_what_needs_more_memory():
    V, F = shapes.ball(2)
    shapes.refuses((lambda: innermap.fit(V, F, V, charges=20000, max_memory="500MB"), MemoryError,
                    "use charges "))
    try:
        innermap.fit(V, F, V, max_memory="1MB")
    except innermap.MemoryError as error:
        assert isinstance(error, MemoryError) and isinstance(error, innermap.Error)
        assert "1 MB" in str(error)
    else:
        raise AssertionError("no error")


def test_inverts_its_maps():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.bent(V), tolerance=1e-3)
    X = shapes.inside(5000, radius=0.99)
    X = X[m.contains(X)]
    Y, J = m(X, jacobian=True)
    assert np.linalg.det(J).min() > 0  # folds nowhere
    back, found, K = m.inverse(Y, jacobian=True)
    assert found.dtype == bool and found.all()
    assert np.linalg.norm(back - X, axis=1).max() < 1e-9 * np.linalg.norm(np.ptp(V, axis=0))
    assert np.abs(J @ K - np.eye(3)).max() < 1e-6
    far, found = m.inverse([[9, 9, 9], Y[0]])
    assert list(found) == [False, True]
    assert np.isnan(far[0]).all() and np.allclose(far[1], X[0])


def test_says_what_it_knows():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.bent(V), tolerance=1e-3)
    e = m.boundary_error
    assert 0 < e.rms < e.p99 < 1e-3 and e.p99 < e.max <= e.bound and e.samples == 20000
    assert m.tolerance_met is True and m.steps == 1 and m.charges > 100
    assert "det J > 0" in m.statement and m.one_to_one["inside_folded"] == 0
    proof = m.prove(cells_per_charge=50)
    assert proof["proof_cells"] > 0 and proof["proof_undecided"] == proof["proof_negative"] == 0
    assert 0 < proof["proof_boundary_error"] < 1e-2  # of flat triangles; this map is smooth
    assert m.one_to_one["proof_undecided"] == 0 and "proof_one_to_one" not in m.one_to_one
    assert m.prove(full=True)["proof_one_to_one"] == 1
    proven, undecided, folded = m.proof_cells(cells_per_charge=50)
    assert len(proven) == proof["proof_cells"] and undecided.shape == folded.shape == (0, 4)
    held = np.abs(V[0] - proven[:, :3]).max(axis=1) <= 1.001 * proven[:, 3]
    assert held.any()  # they cover the closed solid
    assert m.facts["tolerance"] == "0.001"
    assert np.array_equal(m.source.triangles, F) and np.array_equal(m.target.vertices,
                                                                    shapes.bent(V))
    assert np.allclose(m.volumes[0], 4 * np.pi / 3, rtol=0.02)
    m.save("map.ply")
    again = innermap.load("map.ply")
    assert np.isclose(again.boundary_error.max, e.max) and again.tolerance_met is True
    assert again.statement == m.statement
    verified = again.verify(sample=8)
    assert verified["any"] and verified["holds"] and "sense" in verified["claims"], verified
    assert set(verified["results"]) == {"holds"} and verified["proven"]["proof_cells"] > 0
    for attribute in ("notes", "warnings"):
        assert all(isinstance(line, str) for line in getattr(m, attribute))


def test_finds_folds():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, V)
    flat = m.folds(resolution=32)
    assert flat.folded == 0 and flat.share == 0 and flat.places.shape == (0, 3)
    assert flat.checked > 5000 and np.isclose(flat.least_jacobian, 1, atol=1e-3)
    turned = innermap.fit(V, F, V * [1, 1, -1], one_to_one="off").folds(resolution=32)
    assert turned.folded == turned.checked and np.isclose(turned.share, 1)
    assert turned.places.shape == (turned.folded, 3)
    assert np.linalg.norm(turned.places, axis=1).max() < 1


def test_puts_maps_on_grids():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.bent(V), tolerance=1e-3)
    grids = m.evaluate(resolution=24)
    assert set(grids) == {"surface", "density", "map", "jacobian", "harmonic_energy",
                          "deformation_energy"} and len(grids) == 6 and "map" in grids
    arrays = dict(grids)
    assert all(array.shape[:3] == grids.shape for array in arrays.values())
    assert arrays["map"].shape == (*grids.shape, 3) and arrays["map"].dtype == np.float32
    inside = np.argwhere(arrays["surface"] < 0)
    places = inside @ grids.matrix[:3, :3].T + grids.matrix[:3, 3]
    Y, J = m(places, jacobian=True)
    at = tuple(inside.T)
    # Grids are as exact as makes sense beside the boundary's error, whose rms is 1e-3 here.
    assert np.abs(arrays["map"][at] - Y).max() < 3e-4
    assert np.abs(arrays["jacobian"][at] - np.linalg.det(J)).max() < 1e-2
    assert np.isclose(grids.matrix[0, 0], grids.voxel_size)
    assert (places >= grids.bounds[0] - 1e-9).all() and (places <= grids.bounds[1] + 1e-9).all()
    assert grids.totals["folded_fraction"] == 0 and grids.totals["interior_voxels"] == len(inside)
    assert grids.metadata("map")["vector_type"] == "invariant"
    shapes.refuses((lambda: grids["nothing"], KeyError, "nothing"),
                   (lambda: m.evaluate(resolution=3), innermap.SettingError, "resolution"),
                   (lambda: m.evaluate(resolution=4000, max_memory="2GB"), innermap.MemoryError,
                    "2 GB"))


def test_takes_meshes_in_many_ways():
    V, F = shapes.ball(2)
    moved = shapes.twisted(V)
    innermap.write_mesh("rest.ply", V, F)
    innermap.write_mesh("pose.obj", (moved, F))
    read = innermap.read_mesh("rest.ply")
    assert np.array_equal(read.vertices, V) and np.array_equal(read.triangles, F)
    X = shapes.inside(20)
    want = innermap.fit(V, F, moved, **shapes.FEW)(X)
    for arguments in (("rest.ply", "pose.obj"), (read, moved), ((V, F), (moved, F)),
                      (V.tolist(), F.tolist(), moved.tolist()), (V, F.astype(np.uint16), moved),
                      (V, F, moved, F), (read, innermap.read_mesh("pose.obj")),
                      (np.asfortranarray(V), F[:, ::1].astype(np.int64), moved[::-1][::-1])):
        assert np.abs(innermap.fit(*arguments, **shapes.FEW)(X) - want).max() < 1e-9
    report = innermap.check(V, F[1:])
    assert not report.closed and report.open_loops == 1 and report.findings[0]["meaning"]
    assert innermap.check("rest.ply").findings == []


def test_fits_a_number_of_charges():
    V, F = shapes.ball(2)
    m = innermap.fit(V, F, shapes.twisted(V), charges=300, distance=0.2)
    assert m.charges == 300 and m.facts["distance"] == "0.2" and m.tolerance_met is None
    for wrong in ({"sources": 10, "tolerance": 1e-3}, {"distance": 1, "radius_ratio": 2}):
        try:
            innermap.fit(V, F, V, **wrong)
        except innermap.SettingError as error:
            assert "excludes" in str(error)
        else:
            raise AssertionError("no error")


if __name__ == "__main__":
    cli.run(globals())
