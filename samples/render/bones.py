"""A gecko's skeleton, modelled at rest, and where one map takes it in a step of the gecko.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/bones.py -- OUT.jpg [SAMPLES]
"""
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
import innermap  # noqa: E402
import make_gecko as gecko  # noqa: E402
import studio  # noqa: E402

AROUND = 14


def tube(path, radii, flat=1.0):
    """Points and quadrilaterals about a path; flat: the height of its section over its width."""
    path, radii = np.asarray(path, float), np.asarray(radii, float)
    ahead = np.gradient(path, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    up = np.array([0, 0, 1.0]) if abs(ahead[:, 2]).max() < 0.9 else np.array([1.0, 0, 0])
    side = np.cross(ahead, up)
    side /= np.linalg.norm(side, axis=1)[:, None]
    over = np.cross(side, ahead)
    a = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    ring = np.cos(a)[None, :, None] * side[:, None] + flat * np.sin(a)[None, :, None] * over[:, None]
    points = (path[:, None] + radii[:, None, None] * ring).reshape(-1, 3)
    faces = [(AROUND * i + j, AROUND * i + (j + 1) % AROUND, AROUND * (i + 1) + (j + 1) % AROUND,
              AROUND * (i + 1) + j) for i in range(len(path) - 1) for j in range(AROUND)]
    return points, faces


def long_bone(a, b, radius, gap=0.0):
    """A shaft with a knob at each end."""
    a, b = np.asarray(a[:3], float), np.asarray(b[:3], float)
    a, b = a + gap * (b - a), b - gap * (b - a)
    t = np.linspace(0, 1, 28)
    knob = np.exp(-(t / 0.13) ** 2) + np.exp(-((1 - t) / 0.13) ** 2)
    ends = np.sqrt(np.clip(np.minimum(t, 1 - t) / 0.05, 0, 1))
    return tube(a + t[:, None] * (b - a), radius * (0.5 + 0.55 * knob) * np.maximum(ends, 0.02))


def vertebra(at, ahead, radius):
    """A spool, a spine above and a process on each side."""
    side = np.array([ahead[1], -ahead[0], 0])
    half = 0.42 * 0.056 * ahead
    yield long_bone(at - half, at + half, 0.40 * radius)
    for way, size in ((np.array([0, 0, 1.0]), 0.85), (side, 0.95), (-side, 0.95)):
        t = np.linspace(0, 1, 8)[:, None]
        yield tube(at + t * size * radius * way - 0.4 * t * half, 0.15 * radius * (1.02 - t[:, 0] ** 2) + 1e-4)


def rib(at, room, side):
    """From the spine out, round the side and down, within the body."""
    a = np.linspace(0.12, 0.80, 24) * np.pi
    path = at + 0.70 * room * np.stack([side * np.sin(a), -0.35 * (1 - np.cos(a)),
                                        gecko.FLAT * np.cos(a) * 0.95], axis=1)
    return tube(path, 0.0105 * np.sqrt(np.clip(1.02 - np.linspace(0, 1, 24) ** 4, 0, 1)))


def skull(spine):
    """The head's outline, drawn in, and jaws."""
    head = spine[(spine[:, 1] > 0.60)]
    path, room = head[:, :3] + [0, 0, 0.02], head[:, 3]
    t = np.linspace(0, 1, len(head))
    yield tube(path, 0.56 * room * np.sqrt(np.clip(np.minimum(t / 0.3, (1.02 - t) / 0.25), 0.01, 1)), 0.55)
    for side in (1, -1):
        jaw = head[head[:, 1] > 0.64]
        yield tube(jaw[:, :3] + np.stack([side * 0.62 * jaw[:, 3], 0 * t[:len(jaw)], -0.35 * jaw[:, 3]], axis=1),
                   0.017 * np.ones(len(jaw)))


def sockets():
    """Of the eyes: balls, to be dark, that stand out of the skull a little."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 25)[:-1], np.linspace(0, np.pi, 13))
    ball = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1).reshape(-1, 3)
    quads = np.array([(24 * i + j, 24 * i + (j + 1) % 24, 24 * i + 24 + (j + 1) % 24, 24 * i + 24 + j)
                      for i in range(12) for j in range(24)])
    at = gecko.EYE[:3] * [0.62, 1, 0.72]
    points = [0.042 * ball * [1, 1.25, 0.8] + at * [side, 1, 1] for side in (1, -1)]
    return np.concatenate(points), np.concatenate([quads, quads + len(ball)]).tolist()


def skeleton():
    spine = gecko.refined(gecko.SPINE, 24)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(spine[:, :3], axis=0), axis=1))])
    parts = list(skull(spine))
    for s in np.arange(0.36, along[-1] - 0.04, 0.056):
        at = np.array([np.interp(s, along, spine[:, k]) for k in range(4)])
        later = np.array([np.interp(s + 0.01, along, spine[:, k]) for k in range(3)])
        ahead = (later - at[:3]) / np.linalg.norm(later - at[:3])
        parts += list(vertebra(at[:3], ahead, min(0.085, 0.55 * at[3])))
        if -0.22 < at[1] < 0.36:
            parts += [rib(at[:3], at[3], side) for side in (1, -1)]
    for side in (1, -1):
        mirror = np.array([side, 1, 1, 1])
        for kind, leg in (("fore", gecko.FORE), ("hind", gecko.HIND)):
            leg = leg * mirror
            parts.append(long_bone(leg[0] * [0.3, 1, 1, 1], leg[0] + 0.12 * (leg[1] - leg[0]), 0.034))
            parts.append(long_bone(leg[0] + 0.14 * (leg[1] - leg[0]), leg[1], 0.036, 0.03))
            out = np.array([leg[2, 1] - leg[1, 1], leg[1, 0] - leg[2, 0], 0, 0])
            out = 0.017 * out / np.linalg.norm(out)
            parts += [long_bone(leg[1] + k * out, leg[2] + k * out, 0.018, 0.06) for k in (1, -1)]
            for a, b in gecko.toes_of(kind):
                a, b = a * mirror, b * mirror
                root = leg[2] + 0.35 * (a - leg[2])
                for p, q in ((0.02, 0.42), (0.46, 0.74), (0.78, 1.0)):
                    parts.append(long_bone(root + p * (b - root), root + q * (b - root), 0.0155))
    points, faces, count = [], [], 0
    for some, quads in parts:
        points.append(some)
        faces += [tuple(v + count for v in quad) for quad in quads]
        count += len(some)
    return np.concatenate(points), faces


def main():
    out, samples = studio.arguments(__doc__)
    studio.scene((1200, 800), samples, 0.45)
    rest, triangles = innermap.read_mesh(studio.ROOT / "samples/gecko.obj")
    step, _ = innermap.read_mesh(studio.ROOT / "samples/gecko_step.obj")
    m = innermap.fit(rest, triangles, step)
    ivory = studio.plain("ivory", (0.88, 0.80, 0.64), 0.45)
    dark = studio.plain("dark", (0.05, 0.06, 0.06), 0.6)
    skin = studio.glass("skin", (0.25, 0.62, 0.60), 0.10, 0.85, 1.7)
    for x, body in ((-0.86, rest), (0.86, step)):
        studio.mesh("skin", body, triangles, skin, at=(x, 0, 0)).visible_shadow = False
    for (points, faces), made in ((skeleton(), ivory), (sockets(), dark)):
        print(f"{100 * m.contains(points).mean():.1f}% of {len(points)} points are inside")
        moved, found = innermap.push(m, points, outside=0.03)
        assert found.all()
        studio.mesh("inside", points, faces, made, at=(-0.86, 0, 0))
        studio.mesh("inside", moved, faces, made, at=(0.86, 0, 0))
    studio.mesh("floor", [(-40, -40, -0.24), (40, -40, -0.24), (40, 40, -0.24), (-40, 40, -0.24)],
                [(0, 1, 2, 3)], studio.plain("paper", (0.055, 0.085, 0.11), 0.8))
    studio.camera((0, -2.2, 6.4), (0, -0.13, -0.05), lens=60)
    studio.light((-3, 2.5, 5), (0, 0, 0), 2, 330, (1, 0.95, 0.88))
    studio.light((4, -3, 4), (0, 0, 0), 4, 150, (0.8, 0.92, 1))
    studio.render(out, 0.05)


if __name__ == "__main__":
    main()
