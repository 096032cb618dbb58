"""Points that follow poses with all kept that poses share, frames with numbers, lattices."""

import numpy as np

import cli
import innermap
import shapes

FEW = {"charges": 200}


def test_gives_what_deform_gives():
    V, F = shapes.ball(3)
    X = np.concatenate([shapes.inside(300), [[0, 0, 1.1], [0, 0, 3.0]]])
    frames = np.array([shapes.twisted(V), shapes.bent(V)])
    for outside in {}, {"outside": 0.1}, {"outside": 0.1, "fade_to": "fitted"}:
        places, found = innermap.deform((V, F), X, frames, **outside, **FEW)
        deformer = innermap.Deformer((V, F), X, **outside, **FEW)
        assert np.array_equal(deformer.found, found)
        assert list(found[-2:]) == [bool(outside), "fade_to" in outside]
        for i in 1, 0:  # a pose does not depend on those before
            got = deformer(frames[i])
            assert np.array_equal(got, places[i], equal_nan=True)
            assert np.array_equal(np.isnan(got[:, 0]), ~found)
    assert np.abs(got[:300] - shapes.twisted(X[:300])).max() < 1e-2
    assert np.array_equal(deformer((frames[1], F)), deformer(frames[1]))


def test_fades_to_the_motion_of_each_pose():
    V, F = shapes.ball(2)
    deformer = innermap.Deformer((V, F), [[0, 0, 5.0]], outside=0.1, fade_to="fitted", charges=50)
    for way in 0, 1, -2:
        assert np.allclose(deformer(V + [way, 0, 0]), [[way, 0, 5]], atol=1e-9)


def test_measures_as_sequence_does():
    V, F = shapes.ball(3)
    deformer = innermap.Deformer((V, F), V[:0], **FEW)
    assert deformer(V).shape == (0, 3)
    figures = deformer.measure(shapes.twisted(V))
    table = innermap.sequence((V, F), [shapes.twisted(V)], resolution=16, **FEW)
    assert all(figures[k] == table[k][0] for k in ("boundary_rms", "boundary_max", "volume"))


def test_deformer_refuses():
    V, F = shapes.ball(2)
    deformer = innermap.Deformer((V, F), V[:3], charges=50)
    shapes.refuses(
        (lambda: deformer(V[:-1]), innermap.DataError, "frame"),
        (lambda: deformer(np.zeros_like(V)), innermap.DataError, "frame"),
        (lambda: deformer(V * np.nan), innermap.DataError, "frame"),
        (lambda: innermap.Deformer((V, F), V[:, :2]), innermap.DataError, "X"),
        (lambda: innermap.Deformer((V, F), V, outside=2), innermap.SettingError, "outside"),
        (lambda: innermap.Deformer((V, F), V, chages=2), TypeError, "charges"))


def smoke():
    n = 20
    matrix = np.diag([1.6 / n, 1.6 / n, 1.6 / n, 1])
    matrix[:3, 3] = -0.8 + 0.8 / n
    return innermap.grids({"density": np.ones((n, n, n), "f4")}, matrix)


def test_frames_have_the_numbers_given():
    V, F = shapes.ball(2)
    frames = [V, V + [0.1, 0, 0], V + [0.3, 0, 0]]
    figures = innermap.deform((V, F), smoke(), frames, "s.####.vdb", numbers=[7, 8, 10], charges=50,
                              velocity=True, fps=1)
    assert list(figures["frame"]) == [7, 8, 10]
    for number in 7, 8, 10:
        v = innermap.read_vdb(f"s.{number:04d}.vdb")["velocity"]
        assert np.abs(v[np.abs(v[..., 0]) > 0] - [0.1, 0, 0]).max() < 1e-5
    table = innermap.sequence((V, F), frames[:2], numbers=[3, 5], only="5", resolution=16, charges=50)
    assert list(table["frame"]) == [5]
    posed = innermap.read_vdb("s.0007.vdb")
    shapes.refuses(
        (lambda: innermap.deform((V, F), posed, frames, velocity=True), innermap.DataError,
         "already has a grid 'velocity'; leave out velocity or choose the others by grids"),
        (lambda: innermap.deform((V, F), V, frames, only="5-9"), innermap.SettingError,
         "only: '5-9' has none of the frames; there are 3 from 0 to 2"),
        (lambda: innermap.sequence((V, F), frames, resolution=2000, max_memory="2GB"),
         MemoryError, "a sequence with 8000 charges"),
        (lambda: innermap.deform((V, F), V, frames, numbers=[1, 2]), innermap.DataError, "numbers"),
        (lambda: innermap.deform((V, F), V, frames, numbers=[1, 2, 2]), innermap.DataError, "ascend"),
        (lambda: innermap.deform((V, F), V, frames, numbers=[-1, 2, 3]), innermap.DataError,
         "numbers"))


def test_velocity_goes_on_as_far_as_the_shutter_is_open():
    V, F = shapes.ball(2)
    frames = [V, V + [0.8, 0, 0]]

    def reach(**shutter):
        out = innermap.deform((V, F), smoke(), frames, velocity=True, charges=50, **shutter)[0]
        v = out["velocity"][..., 0]
        assert np.abs(v[v != 0] - 0.8 * 24).max() < 1e-3
        return (out.matrix[0, 0] * np.ptp(np.nonzero(v)[0]) - 2) / 2

    voxel = 1.6 / 20
    skin = reach(shutter=0)
    assert 0 <= skin < 3 * voxel
    assert abs(reach() - skin - 0.4) <= voxel * 1.01
    assert abs(reach(shutter=1) - skin - 0.8) <= voxel * 1.01


def test_lattice_has_blenders_order():
    lower, upper = np.array([1.0, 2.0, 3.0]), np.array([2.0, 2.5, 5.0])
    X, (u, v, w), cell = innermap.lattice((lower, upper), resolution=13)
    assert (u, v, w) == (8, 6, 13) and abs(cell - 0.2) < 1e-12 and len(X) == u * v * w
    at = X.reshape(w, v, u, 3)
    assert np.allclose(at[1, 2, 3] - at[0, 0, 0], [3 * cell, 2 * cell, cell])
    assert np.allclose(X.mean(0), (lower + upper) / 2)
    assert np.all(X.min(0) <= lower - cell + 1e-9) and np.all(X.max(0) >= upper + cell - 1e-9)
    assert np.allclose(innermap.lattice(([0, 0, 0], [1, 0, 0]), resolution=4)[1], (4, 3, 3))
    shapes.refuses(
        (lambda: innermap.lattice((upper, lower)), innermap.DataError, "bounds"),
        (lambda: innermap.lattice((lower, lower)), innermap.DataError, "bounds"),
        (lambda: innermap.lattice((lower, upper), resolution=2), innermap.SettingError,
         "resolution"))


if __name__ == "__main__":
    cli.run(globals())
