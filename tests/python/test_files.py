"""What the program writes the module reads, and the other way round; other programs' modules."""

import shlex
from pathlib import Path

import numpy as np

import cli
import innermap
import shapes


def write(path, V, F):
    cli.write_obj(path, V.tolist(), F.tolist())
    return path


def test_program_and_module_share_maps():
    V, F = shapes.ball(2)
    write("rest.obj", V, F)
    write("pose.obj", shapes.twisted(V), F)
    cli.innermap("map", "rest.obj", "pose.obj", "-o", "out", "--tolerance", 1e-2, "--resolution", 16)
    theirs = innermap.load("out/map.ply")
    X = shapes.inside(100)
    ours = innermap.fit("rest.obj", "pose.obj", tolerance=1e-2)
    assert np.array_equal(theirs(X), ours(X))
    assert theirs.facts == {**ours.facts, "source": theirs.facts["source"],
                            "target": theirs.facts["target"]}
    ours.save("ours.ply")
    cli.innermap("evaluate", "ours.ply", "-o", "theirs.vdb", "--resolution", 16)
    ours.write_vdb("ours.vdb", resolution=16)
    grids = {}
    for name in ("theirs", "ours", "out/map"):
        info = cli.innermap("info", f"{name}.vdb", "--json").stdout
        grids[name] = [line for line in info.split("\n") if "active" in line or '"name"' in line]
    assert grids["theirs"] == grids["ours"] == grids["out/map"]


def test_writes_jobs_as_the_program_does():
    V, F = shapes.ball(2)
    innermap.fit(V, F, shapes.twisted(V), charges=100).save("map.ply")
    words = ["evaluate", "map.ply", "-o", "it's.vdb", "--resolution", "12"]
    cli.innermap(*words, "--jobs", "theirs.txt")
    theirs = Path("theirs.txt").read_text(encoding="utf-8")
    *command, share, part = shlex.split(theirs.split("&& ")[1])
    assert (share, part) == ("--share", "1/1") and command[-4:] == words[2:], theirs
    innermap.jobs("ours.txt", command)
    assert Path("ours.txt").read_text(encoding="utf-8") == theirs
    shapes.refuses((lambda: innermap.jobs("a.txt", ["a"], first=["f"]), innermap.SettingError, "order"))
    innermap.jobs("ours.json", ["a"], first=["f"], join=["b"], seconds=10, memory=10**9, join_memory=2 * 10**9)
    first, *steps = cli.read_json("ours.json")["steps"]
    assert first["name"] == "First" and steps[0]["dependencies"] == [{"dependsOn": "First"}], first
    asked = [step["hostRequirements"]["amounts"][0]["min"] for step in steps]
    assert 1192 < asked[0] < 1500 and 2384 < asked[1] < 3000, asked
    assert steps[0]["script"]["actions"]["onRun"]["timeout"] == 100


def test_lays_out_on_the_sphere_as_the_program_does():
    V, F = shapes.ball(2)
    V = V * [1.3, 1, 0.8]
    laid, figures = innermap.sphere(V, F)
    assert np.abs(np.linalg.norm(laid.vertices, axis=1) - 1).max() < 1e-12
    assert np.array_equal(laid.triangles, F)
    assert figures["flips"] == 0 and abs(figures["degree"] - 1) < 1e-9
    write("a.obj", V, F)
    cli.innermap("sphere", "a.obj", "-o", "sphere.ply")
    assert np.abs(innermap.read_mesh("sphere.ply").vertices - laid.vertices).max() < 1e-6
    capped, figures = innermap.sphere(V, F[1:])
    assert np.abs(capped.vertices - laid.vertices).max() < 0.2 and figures["flips"] == 0
    shapes.refuses((lambda: innermap.sphere(V, F, V), TypeError, ""))


def test_maps_between_strangers():
    V, F = shapes.ball(2)
    W, G = shapes.ball(1)
    W = W * [1.3, 1, 0.8]
    c = innermap.correspond((V, F), (W, G), candidates=1, landmarks=[(0, 0), (V[5], 5)])
    assert c.positions.shape == V.shape and c.quality["landmark_error"] < 1e-9
    assert c.quality["flips"] == 0 and c.triangles.shape == (len(V),)
    corners = W[G[c.triangles]]
    assert np.abs((corners * c.barycentric[:, :, None]).sum(1) - c.positions).max() < 1e-12
    assert np.abs(c.positions[0] - W[0]).max() < 1e-9
    c.save("laid.ply")
    again = innermap.load_correspondence("laid.ply", V, F)
    assert np.array_equal(again.positions, c.positions)
    assert np.array_equal(again.triangles, c.triangles)
    m = innermap.fit(c, one_to_one="off")
    assert m.facts["tolerance"] == "0.002"
    assert np.array_equal(m.target.vertices, c.positions)
    write("a.obj", V, F)
    write("b.obj", W, G)
    cli.innermap("map", "a.obj", "-o", "out", "--correspond", "laid.ply", "--one-to-one", "off",
                 "--resolution", 12)
    X = shapes.inside(50)
    assert np.abs(innermap.load("out/map.ply")(X) - m(X)).max() < 1e-9
    # Laid on by fit() itself.
    n = innermap.fit((V, F), (W, G), candidates=1, one_to_one="off", tolerance=1e-2)
    assert len(n.source.vertices) >= len(V)
    shapes.refuses(
        (lambda: innermap.correspond((V, F), (W, G), landmarks=[(0, 9999)]), innermap.Error,
         "9999"),
        (lambda: innermap.correspond((V, F), (W, G), landmarks=[(0,)]), ValueError, "pairs"),
        (lambda: innermap.correspond((V, F), (W, G), landmarks=3), TypeError, "landmarks"),
        (lambda: innermap.correspond(V, F), TypeError, "lacks the mesh 'target'"),
        (lambda: innermap.fit(V, F, W), ValueError, "V_target: has 42 rows"))


def test_goes_in_steps():
    # A ball with a dent that one harmonic map folds; three steps leave less of that.
    V, F = shapes.ball(2)
    dent = np.exp(-8 * ((V[:, :2]) ** 2).sum(1)) * (V[:, 2] > 0)
    moved = V - np.outer(1.5 * dent, [0, 0, 1])
    m = innermap.fit(V, F, moved, one_to_one="on", tolerance=3e-2, max_steps=3)
    assert m.steps > 1
    m.save("steps.ply")
    again = innermap.load("steps.ply")
    X = shapes.inside(500, 0.95)
    X = X[m.contains(X)]
    Y = again(X)
    assert np.array_equal(Y, m(X)) and again.steps == m.steps
    # It still folds somewhere: there several points come to one.
    back, found = m.inverse(Y)
    # Newton's method ends at 1e-9 of the diagonal, which is below 4.
    assert found.mean() > 0.98 and np.abs(m(back[found]) - Y[found]).max() < 4e-9
    assert (np.abs(back - X).max(1) < 1e-8).mean() > 0.95


def test_works_beside_pyopenvdb_and_meshio():
    import meshio
    import pyopenvdb
    V, F = shapes.ball(2)
    mesh = meshio.Mesh(V, [("triangle", F[:100]), ("line", [[0, 1]]), ("triangle", F[100:])])
    m = innermap.fit(mesh, meshio.Mesh(shapes.twisted(V), [("triangle", F)]), **shapes.FEW)
    X = shapes.inside(50)
    assert np.abs(m(X) - innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)(X)).max() < 1e-9
    try:
        innermap.fit(meshio.Mesh(V, [("quad", [[0, 1, 2, 3]])]), V)
    except innermap.DataError as error:
        assert "quad" in str(error)
    else:
        raise AssertionError("no error")
    grids = m.evaluate(resolution=16)
    # Files one way, arrays and a matrix the other.
    grids.write_vdb("grids.vdb")
    read, _ = pyopenvdb.readAll("grids.vdb")
    assert {grid.name for grid in read} == set(grids)
    theirs = next(grid for grid in read if grid.name == "jacobian")
    made = pyopenvdb.FloatGrid()
    made.copyFromArray(grids["jacobian"])
    made.transform = pyopenvdb.createLinearTransform(grids.matrix.T.tolist())
    assert np.allclose(made.transform.indexToWorld((1, 2, 3)), grids.matrix[:3] @ [1, 2, 3, 1])
    box = theirs.evalActiveVoxelBoundingBox()
    assert np.allclose(theirs.transform.indexToWorld(grids_corner(grids, theirs)), grids.bounds[0])
    assert box[0] >= grids_corner(grids, theirs)
    cut = np.zeros(grids.shape, np.float32)
    theirs.copyToArray(cut, ijk=grids_corner(grids, theirs))
    assert np.array_equal(cut, grids["jacobian"])
    V2, F2 = innermap.read_mesh(write("ball.obj", V, F))
    meshio.Mesh(V2, [("triangle", F2)]).write("ball.stl")
    assert len(innermap.read_mesh("ball.stl").triangles) == len(F)


def grids_corner(grids, grid):
    return tuple(round(x) for x in grid.transform.worldToIndex(tuple(grids.bounds[0])))


if __name__ == "__main__":
    cli.run(globals())
