"""Grids, meshes, cells, files and points through a map, and frames: as the program does them."""

import os
import warnings

import numpy as np

import cli
import innermap
import shapes
from caches import write_gltf


def a_map():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    m.save("map.ply")
    return m


def smoke(path="smoke.vdb"):
    """A ball of density inside, with positions."""
    n = 24
    matrix = np.diag([1.6 / n, 1.6 / n, 1.6 / n, 1])
    matrix[:3, 3] = -0.8 + 0.8 / n
    at = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1)
    places = at @ matrix[:3, :3].T + matrix[:3, 3]
    inside = np.linalg.norm(places, axis=-1) < 0.6
    density = (inside * (1 + 0.5 * places[..., 2])).astype(np.float32)
    grids = innermap.grids({"density": density, "place": (places * inside[..., None]).astype("f4")},
                           matrix)
    grids.write_vdb(path)
    return grids


def identical(a, b, names):
    for name in names:
        assert np.allclose(a.matrix, b.matrix) and np.array_equal(a[name], b[name]), name


def test_pushes_grids_as_the_program_does():
    m, grids = a_map(), smoke()
    pushed = innermap.push(m, "smoke.vdb", "module.vdb", densities=["density"])
    cli.innermap("push", "map.ply", "smoke.vdb", "-o", "program.vdb", "--densities", "density")
    identical(innermap.read_vdb("module.vdb"), innermap.read_vdb("program.vdb"),
              ["density", "place"])
    mass = pushed.totals["mass"]["density"]
    assert abs(mass["after"] / mass["before"] - 1) < 1e-4
    identical(innermap.push(m, grids, densities=True), pushed, ["density", "place"])
    assert list(innermap.push(m, grids, grids="density")) == ["density"]


def test_pulls_grids_as_the_program_does():
    m = a_map()
    smoke()
    pulled = innermap.pull(m, "smoke.vdb", grids="density", resolution=32)
    cli.innermap("pull", "map.ply", "smoke.vdb", "-o", "program.vdb", "--grids", "density",
                 "--resolution", "32")
    identical(pulled, innermap.read_vdb("program.vdb"), ["density"])


def test_pushes_points_and_meshes():
    m = a_map()
    X = shapes.inside(100)
    Y, found, J = innermap.push(m, X, jacobian=True)
    assert found.all()
    assert np.abs(Y - m(X)).max() < 1e-6 and np.abs(J - m(X, jacobian=True)[1]).max() < 1e-5
    back, found = innermap.pull(m, Y)
    assert found.all() and np.abs(back - X).max() < 1e-5
    far, found = innermap.push(m, [[5.0, 0, 0], [0, 0, 0]])
    assert list(found) == [False, True] and np.isnan(far[0]).all()
    V, F = shapes.ball(2)
    W, G = innermap.push(m, (0.5 * V, F))
    assert np.array_equal(F, G) and np.abs(W - m(0.5 * V)).max() < 1e-6
    shifted = np.hstack([np.eye(3), [[1], [0], [0]]])
    moved, found = innermap.push(m, [[1.4, 0, 0]], outside=0.3, fade_to=shifted)
    assert found.all()
    try:
        innermap.push(m, (5 * V, F))
    except innermap.DataError as error:
        assert "outside" in str(error)
    else:
        raise AssertionError("no error")


def test_pushes_files_as_the_program_does():
    m = a_map()
    V, F = shapes.ball(2)
    innermap.write_mesh("small.obj", 0.5 * V, F)
    figures = innermap.push(m, "small.obj", "module.obj", subdivide=1e-4)
    cli.innermap("push", "map.ply", "small.obj", "-o", "program.obj", "--subdivide", "1e-4")
    assert open("module.obj").read() == open("program.obj").read()
    assert figures["points"] == len(V) and figures["points_added"] > 0
    assert figures["points_cut"] == 0


def test_refuses_what_cannot_be_carried():
    m, grids = a_map(), smoke()
    shapes.refuses(
        (lambda: innermap.push(m, "nothing.vdb"), innermap.FileError, "nothing.vdb"),
        (lambda: innermap.push(m, grids, densities=["fog"]), innermap.DataError, "fog"),
        (lambda: innermap.push(m, grids, grids=["fog"]), KeyError, "fog"),
        (lambda: innermap.push(m, grids, fade_to="fitted"), ValueError, "outside"),
        (lambda: innermap.push(m, grids, sampling="cubic"), innermap.SettingError, "sampling"),
        (lambda: innermap.push("map.ply", grids), TypeError, "map: "),
        (lambda: innermap.push(m, np.zeros((3, 2))), ValueError, "X: expects"),
        (lambda: innermap.push(m, grids, max_memory="1MB"), MemoryError, "1 MB"),
        (lambda: innermap.grids({"a": np.zeros((2, 2))}, np.eye(4)), ValueError, "a: expects"),
        (lambda: innermap.grids({"a": np.ones((2, 2, 2))}, np.zeros((4, 4))), ValueError,
         "matrix"),
        (lambda: innermap.grids({"a": np.zeros((2, 2, 2))}, np.eye(4)), ValueError,
         "no active"))


def frames():
    V, F = shapes.ball(3)
    poses = []
    for i in range(3):
        pose = V.copy()
        pose[:, 0] += 0.1 * i * V[:, 2] ** 2
        innermap.write_mesh(f"pose.{i:04d}.obj", pose, F)
        poses.append(pose)
    innermap.write_mesh("rest.obj", V, F)
    return V, F, poses


def test_deforms_through_frames_as_the_program_does():
    V, F, poses = frames()
    smoke()
    X = shapes.inside(50)
    places, found = innermap.deform((V, F), X, poses, charges=800)
    assert places.shape == (3, 50, 3) and found.all()
    assert np.abs(places[0] - X).max() < 1e-6
    table = innermap.deform("rest.obj", "smoke.vdb", "pose.*.obj", "module.####.vdb", charges=800,
                            grids="density", densities=True)
    cli.innermap("deform", "rest.obj", "smoke.vdb", "pose.*.obj", "-o", "program.####.vdb",
                 "--charges", "800", "--grids", "density", "--density")
    assert list(table["frame"]) == [0, 1, 2] and table["error"] == ["", "", ""]
    assert (table["boundary_rms"] < 1e-2).all()
    for i in range(3):
        identical(innermap.read_vdb(f"module.{i:04d}.vdb"), innermap.read_vdb(f"program.{i:04d}.vdb"),
                  ["density"])
    made = innermap.deform("rest.obj", "smoke.vdb", poses, charges=800, grids="density", only="1-2",
                           densities=True, velocity=True)
    assert len(made) == 2 and list(made[0]) == ["density", "velocity"]


def test_deforms_files_as_the_program_does():
    V, F, _ = frames()
    innermap.write_mesh("inner.obj", 0.5 * V, F)
    innermap.deform("rest.obj", "inner.obj", "pose.*.obj", "module.####.obj", charges=800)
    cli.innermap("deform", "rest.obj", "inner.obj", "pose.*.obj", "-o", "program.####.obj",
                 "--charges", "800")
    assert open("module.0002.obj").read() == open("program.0002.obj").read()


def test_measures_a_sequence_as_the_program_does():
    V, F, poses = frames()
    table = innermap.sequence("rest.obj", "pose.*.obj", charges=800, resolution=32,
                              output="module.####.vdb", grids="jacobian", prove="core")
    cli.innermap("sequence", "rest.obj", "pose.*.obj", "-o", "program", "--charges", "800",
                 "--resolution", "32", "--prove", "core")
    report = cli.read_json("program/report.json")
    for name in ("harmonic", "deformation", "boundary_p99", "folded_fraction", "volume", "proof_cells",
                 "proof_boundary_error"):
        assert np.allclose(table[name], report["energies"][name], rtol=1e-6, atol=1e-12), name
    assert table["statement"] == report["energies"]["statement"] and all(table["statement"])
    assert abs(table["harmonic"][0] - 3) < 0.02 < table["harmonic"][2] - 3, table["harmonic"]
    assert list(innermap.read_vdb("module.0001.vdb")) == ["jacobian"]
    poses[1] = poses[1] * 0  # bounds no solid
    table = innermap.sequence((V, F), poses, charges=800, resolution=32, prove="off")
    assert "proof_cells" not in table and "statement" not in table, table.keys()
    assert table["error"][1] and not table["error"][0] and np.isnan(table["harmonic"][1])


def test_marks_frames_left_out_and_warns_of_each():
    V, F = shapes.ball(2)
    spike = np.concatenate([3 * V[:1], V[1:]])  # more than so few charges can fit
    poses = [V, 0 * V, spike]                   # the second bounds no solid
    few, X = {"charges": 30, "numbers": [4, 7, 9]}, shapes.inside(20)
    for carry in (lambda: list(innermap.deform((V, F), X, poses, **few)[0][:, 0, 0]),
                  lambda: innermap.deform((V, F), smoke(), poses, grids="density", **few),
                  lambda: list(innermap.sequence((V, F), poses, resolution=16, **few)["harmonic"])):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            made = carry()
        assert len(made) == 3 and (made[1] is None or np.isnan(made[1])), made
        assert made[0] is not None and made[2] is not None and made[2] == made[2], made
        assert [w.category for w in told] == [RuntimeWarning] * 2, told
        told = [str(w.message) for w in told]
        assert told[0].startswith("frame 7 is left out: ") and told[1].startswith("frame 9: "), told
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shapes.refuses((carry, RuntimeWarning, "frame 7"))
    shapes.refuses((lambda: innermap.deform((V, F), X, [0 * V], charges=30), innermap.DataError, ""))


def test_ends_where_a_frame_cannot_be_written():
    V, F = shapes.ball(2)
    innermap.write_mesh("inner.obj", 0.5 * V, F)
    for ending in ("vdb", "obj"):
        os.mkdir(f"made.0001.{ending}")  # where the second frame should go
    few = {"charges": 30, "output": "made.####.vdb"}
    shapes.refuses(*[(carry, innermap.FileError, "stopped at frame 1") for carry in (
        lambda: innermap.deform((V, F), smoke(), [V] * 3, grids="density", **few),
        lambda: innermap.deform((V, F), "inner.obj", [V] * 3, **{**few, "output": "made.####.obj"}),
        lambda: innermap.sequence((V, F), [V] * 3, resolution=16, **few))])
    assert os.path.isfile("made.0000.vdb") and not os.path.exists("made.0002.vdb")


def test_takes_point_caches():
    V, F, poses = frames()
    V, poses = (np.asarray(a, np.float32) for a in (V, poses))
    with open("walk.mdd", "wb") as file:
        np.array([len(poses), len(V)], ">i4").tofile(file)
        np.zeros(len(poses), ">f4").tofile(file)
        poses.astype(">f4").tofile(file)
    X = 0.5 * V[:20]
    places, _ = innermap.deform((V, F), X, poses, charges=400)
    cached, _ = innermap.deform((V, F), X, "walk.mdd", charges=400, first_frame=5, only="6")
    assert cached.shape == (1, 20, 3) and np.array_equal(cached[0], places[1])
    try:
        innermap.deform((V[:-1], F[(F < len(V) - 1).all(1)]), X, "walk.mdd", charges=400)
        assert False, "a cache of another mesh"
    except innermap.DataError as error:
        assert "points" in str(error)


def test_takes_gltf_as_rest_pose_and_frames():
    write_gltf("ball.gltf")
    X = 0.5 * shapes.ball(1)[0]
    places, found = innermap.deform("ball.gltf", X, "ball.gltf", charges=400, fps=2)
    assert places.shape == (3, len(X), 3) and found.all()
    assert np.abs(places[1] - 1.25 * X - [0.5, -1, 0.25]).max() < 1e-5


if __name__ == "__main__":
    cli.run(globals())
