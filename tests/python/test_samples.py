"""The samples in Python run, and say what they should."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import cli

SAMPLES = Path(os.environ["INNERMAP_ROOT"]) / "samples" / "python"


def run(name):
    done = subprocess.run([sys.executable, SAMPLES / f"{name}.py", "picture.png"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    import matplotlib.image
    picture = matplotlib.image.imread("picture.png")
    committed = matplotlib.image.imread(SAMPLES / f"{name}.png")
    assert picture.shape == committed.shape, "make the committed picture again"
    # Thumbnails alike: fonts differ a little from machine to machine.
    step = 20
    height, width = (n // step * step for n in picture.shape[:2])
    small = [p[:height, :width, :3].reshape(height // step, step, width // step, step, 3).mean((1, 3))
             for p in (picture, committed)]
    assert np.abs(small[0] - small[1]).max() < 0.25, "make the committed picture again"
    assert picture[..., :3].std() > 0.05
    return done.stdout


def test_pose():
    assert "100.0% of them back" in run("pose")


def test_field():
    assert "99% of the patches within" in run("field")


def test_proof_cells():
    assert " 0 undecided, 0 folded" in run("proof_cells")


def test_splats():
    assert "24000 splats, 0 too far outside" in run("splats")


def test_volume_texture():
    assert "channels A, R, G, B" in run("volume_texture")


def test_ventricle():
    assert "height: " in run("ventricle")


def test_ventricles_fibres_turn_from_60_to_minus_60_degrees():
    spec = importlib.util.spec_from_file_location("ventricle", SAMPLES / "ventricle.py")
    ventricle = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(ventricle)
    import innermap
    V, F, parts = ventricle.shell()
    depth = innermap.harmonic(V, F, fix=[(parts["inside"], 0), (parts["outside"], 1)],
                              tolerance=1e-2)
    apex = parts["outside"][V[F[parts["outside"]]].mean(axis=1)[:, 2] < -7.4]
    height = innermap.harmonic(V, F, fix=[(apex, 0), (parts["base"], 1)], tolerance=1e-2)
    around = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    for wanted, angle in ((0.02, 57.6), (0.25, 30), (0.5, 0), (0.75, -30), (0.98, -57.6)):
        X = ventricle.layer(depth, wanted, around, np.full(30, 0.4))
        direction = ventricle.fibres(depth, height, X)[0]
        assert np.allclose(np.linalg.norm(direction, axis=1), 1)
        # Along the circle of latitude, and along the ellipse from apex to base, in the wall.
        circle = np.stack([-np.sin(around), np.cos(around), 0 * around], axis=1)
        across, deep = ventricle.ACROSS + 0.5, ventricle.DEEP + 0.5
        up = np.stack([across * np.sin(0.4) * np.cos(around), across * np.sin(0.4) * np.sin(around),
                       np.full(30, deep * np.cos(0.4))], axis=1)
        up /= np.linalg.norm(up, axis=1)[:, None]
        found = np.degrees(np.arctan2(np.sum(direction * up, axis=1),
                                      np.sum(direction * circle, axis=1)))
        assert np.abs(found - angle).max() < 3, (wanted, found)
        assert np.abs(np.sum(direction * np.cross(circle, up), axis=1)).max() < 0.1


if __name__ == "__main__":
    cli.run(globals())
