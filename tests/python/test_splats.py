"""Captures of Gaussian splats through maps, against closed forms; files read by tests/python/captures.py."""

from pathlib import Path

import numpy as np

import captures
import cli
import innermap
import shapes

A = np.array([[1.3, 0.4, 0.1], [-0.2, 0.8, 0.3], [0.1, -0.1, 1.1]])
SHIFT = np.array([3.0, -1.0, 0.5])


def rotation():
    q, _ = np.linalg.qr(A)
    return q * np.sign(np.linalg.det(q))


def linear_map(matrix, subdivisions=3):
    V, F = shapes.ball(subdivisions)
    return innermap.fit(V, F, V @ matrix.T + SHIFT, **shapes.FEW)


def pushed(m, capture, **keywords):
    captures.write("cap.ply", capture)
    figures = innermap.push(m, "cap.ply", "pushed.ply", **keywords)
    assert figures["splats"] == len(capture), figures
    return captures.read("pushed.ply")


def check(errors, within):
    for what, error in errors.items():
        assert error < within, (what, errors)


def test_linear_maps_give_closed_forms():
    P = shapes.inside(3000)
    for matrix in (rotation(), A):
        m = linear_map(matrix)
        for degree in (0, 1, 2, 3):
            capture = captures.random_capture(P, degree, seed=degree, kind="<f8")
            out = pushed(m, capture)
            J = np.broadcast_to(matrix, (len(P), 3, 3))
            if degree:
                check(captures.errors(capture, out, P @ matrix.T + SHIFT, J), 1e-6)
            for name in ("nx", "f_dc_1", "opacity"):
                assert np.array_equal(out[name], capture[name]), name


def test_bent_maps_agree_with_their_jacobians():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.bent(V), **shapes.FEW)
    P = shapes.inside(5000)
    at, J = m(P, jacobian=True)
    capture = captures.random_capture(P, kind="<f8")
    out = pushed(m, capture)
    check(captures.errors(capture, out, at, J), 1e-6)
    figures = innermap.pull(m, "pushed.ply", "back.ply")
    assert figures["splats"] == len(P), figures
    back = captures.read("back.ply")
    same = np.broadcast_to(np.eye(3), (len(P), 3, 3))
    check(captures.errors(capture, back, P, same), 1e-4)  # as near as the inverse is
    # Of floats, as captures are: what these tell.
    floats = captures.random_capture(P)
    at, J = m(captures.places(floats), jacobian=True)
    check(captures.errors(floats, pushed(m, floats), at, J), 1e-5)


def test_frames_and_what_is_outside():
    V, F = shapes.ball(3)
    P = np.concatenate([shapes.inside(500), [[3.0, 0, 0]]])
    capture = captures.random_capture(P, 1)
    captures.write("cap.ply", capture)
    figures = innermap.deform((V, F), "cap.ply", [V @ rotation().T, V @ A.T], "out.####.ply", charges=300)
    assert len(figures["frame"]) == 2, figures
    outs = [captures.read(f"out.{n:04d}.ply") for n in figures["frame"]]
    for out, matrix in zip(outs, (rotation(), A)):
        J = np.broadcast_to(matrix, (500, 3, 3))
        check(captures.errors(capture[:500], out, P[:500] @ matrix.T, J), 1e-3)
    m = linear_map(A)
    figures = innermap.push(m, "cap.ply", "near.ply", outside=0.1, fade_to="identity")
    assert figures["points_cut"] == 0 and len(captures.read("near.ply")) == 501, figures


def test_refuses_bad_captures():
    m = linear_map(A)
    innermap.write_mesh("ball.ply", shapes.ball(2))
    good = captures.random_capture(shapes.inside(10))
    bad = good.copy()
    for i in range(4):
        bad[f"rot_{i}"][4] = 0
    captures.write("zero.ply", bad)
    kept = [(n, "<f4") for n in good.dtype.names if n != "f_rest_44"]
    captures.write("few.ply", np.zeros(10, dtype=kept))
    shapes.refuses(
        (lambda: innermap.push(m, "zero.ply", "a.ply"), innermap.FileError, "splat 4"),
        (lambda: innermap.push(m, "few.ply", "a.ply"), innermap.FileError, "44"),
        (lambda: innermap.push(m, "ball.ply", "a.ply", splats="mass"), innermap.SettingError, "splats"))
    assert not Path("a.ply").exists()


if __name__ == "__main__":
    cli.run(globals())
