#!/usr/bin/python3
"""A capture of Gaussian splats, bent by the map of the surface that it shows; with a small renderer.

    samples/python/splats.py [PICTURE]     default: out/splats.png

The capture is made here: flat splats on an ellipsoid of checkers, whose colours depend on the view. The
renderer is the reference's in a few lines of numpy (Zwicker et al., "EWA splatting", 2002; Kerbl et
al., 2023): covariances are projected, splats are sorted and blended from the front.
"""
import sys
import tempfile
from pathlib import Path

import innermap
import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

SAMPLES = Path(__file__).resolve().parent.parent
COUNT, WIDTH, HEIGHT = 24000, 460, 270
LETTERS = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 15)
C0, C1 = 0.28209479177387814, 0.4886025119029199
NAMES = (["x", "y", "z", "nx", "ny", "nz"] + [f"f_dc_{i}" for i in range(3)] +
         [f"f_rest_{i}" for i in range(9)] + ["opacity"] + [f"scale_{i}" for i in range(3)] +
         [f"rot_{i}" for i in range(4)])


def bent(V):
    """About the z axis, by up to 115 degrees to either side."""
    angle, radius = 0.8 * V[:, 0], 1.25 - V[:, 1]
    return np.stack([radius * np.sin(angle), 1.25 - radius * np.cos(angle), V[:, 2]], axis=1)


def on_surface(V, F, random):
    """Points spread over a surface, its normals there, and the area of each."""
    a, b, c = V[F[:, 0]], V[F[:, 1]], V[F[:, 2]]
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1) / 2
    which = random.choice(len(F), COUNT, p=areas / areas.sum())
    u, v = random.random((2, COUNT, 1))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    P = a[which] + u * (b - a)[which] + v * (c - a)[which]
    return P, normals[which] / (2 * areas[which, None]), areas.sum() / COUNT


def capture(V, F):
    P, N, area = on_surface(V, F, np.random.default_rng(1))
    out = np.zeros(COUNT, dtype=[(name, "<f4") for name in NAMES])
    out["x"], out["y"], out["z"] = P.T
    around = np.arctan2(P[:, 2], P[:, 1])
    odd = (np.floor(3 * P[:, 0]) + np.floor(around * 5 / np.pi)) % 2 == 0
    colours = np.where(odd[:, None], [0.93, 0.72, 0.30], [0.10, 0.42, 0.50])
    for i in range(3):
        out[f"f_dc_{i}"] = (colours[:, i] - 0.62) / C0
        # Brighter where it faces whoever looks: -0.3 n . d.
        for k, part in enumerate((-N[:, 1], N[:, 2], -N[:, 0])):
            out[f"f_rest_{3 * i + k}"] = -0.3 / C1 * part
    out["opacity"] = 2.5
    out["scale_0"] = out["scale_1"] = np.log(0.9 * np.sqrt(area))
    out["scale_2"] = np.log(0.05 * np.sqrt(area))
    # From z to the normal.
    q = np.stack([1 + N[:, 2], -N[:, 1], N[:, 0], 0 * N[:, 0]], axis=1)
    q[q[:, 0] < 1e-6] = [0, 1, 0, 0]
    for i in range(4):
        out[f"rot_{i}"] = q[:, i]
    return out


def write(path, splats):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(splats)}"]
    header += [f"property float {name}" for name in splats.dtype.names] + ["end_header", ""]
    path.write_bytes("\n".join(header).encode() + splats.tobytes())


def read(path):
    header, _, body = path.read_bytes().partition(b"end_header\n")
    names = [line.split()[2] for line in header.decode().splitlines() if line.startswith("prop")]
    return np.frombuffer(body, dtype=[(name, "<f4") for name in names])


def columns(splats, names):
    return np.stack([splats[name].astype(float) for name in names], axis=1)


def covariances(splats):
    q = columns(splats, [f"rot_{i}" for i in range(4)])
    w, x, y, z = (q / np.linalg.norm(q, axis=1)[:, None]).T
    R = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                  2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                  2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
    M = R.reshape(-1, 3, 3) * np.exp(columns(splats, [f"scale_{i}" for i in range(3)]))[:, None]
    return M @ M.transpose(0, 2, 1)


def colours_from(splats, camera):
    d = columns(splats, "xyz") - camera
    x, y, z = (d / np.linalg.norm(d, axis=1)[:, None]).T
    rest = columns(splats, [f"f_rest_{i}" for i in range(9)]).reshape(-1, 3, 3)
    basis = C1 * np.stack([-y, z, -x], axis=1)
    base = C0 * columns(splats, [f"f_dc_{i}" for i in range(3)]) + 0.5
    return np.clip(base + np.einsum("nck,nk->nc", rest, basis), 0, 1)


def render(splats, camera, target):
    """A picture (HEIGHT, WIDTH, 3) on white."""
    forward = (target - camera) / np.linalg.norm(target - camera)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    W = np.stack([right, np.cross(forward, right), forward])  # x to the right, y down
    p, focal = (columns(splats, "xyz") - camera) @ W.T, 1.5 * WIDTH
    x, y, z = p.T
    # The derivative of the projection.
    zero = 0 * z
    J = focal * np.stack([1 / z, zero, -x / z**2, zero, 1 / z, -y / z**2], axis=1).reshape(-1, 2, 3)
    T = J @ W
    S = T @ covariances(splats) @ T.transpose(0, 2, 1) + 0.3 * np.eye(2)  # a pixel's own width
    inverse, reach = np.linalg.inv(S), 3 * np.sqrt(np.linalg.eigvalsh(S)[:, 1])
    u, v = focal * x / z + WIDTH / 2, focal * y / z + HEIGHT / 2
    alpha = 1 / (1 + np.exp(-splats["opacity"].astype(float)))
    colours = colours_from(splats, camera)
    picture, left = np.zeros((HEIGHT, WIDTH, 3)), np.ones((HEIGHT, WIDTH, 1))
    for i in np.argsort(z):
        rows = slice(max(0, int(v[i] - reach[i])), max(0, int(v[i] + reach[i]) + 2))
        cols = slice(max(0, int(u[i] - reach[i])), max(0, int(u[i] + reach[i]) + 2))
        light = left[rows, cols]
        if light.size == 0:
            continue
        dy = np.arange(rows.start, rows.start + light.shape[0])[:, None] - v[i]
        dx = np.arange(cols.start, cols.start + light.shape[1])[None] - u[i]
        a, b, c = inverse[i][0, 0], inverse[i][0, 1], inverse[i][1, 1]
        covers = alpha[i] * np.exp(-0.5 * (a * dx * dx + c * dy * dy) - b * dx * dy)
        covers = np.minimum(0.99, np.where(covers < 1 / 255, 0, covers))[:, :, None]
        picture[rows, cols] += light * covers * colours[i]
        light *= 1 - covers
    return picture + left


def main():
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "out/splats.png")
    picture.parent.mkdir(parents=True, exist_ok=True)
    V, F = innermap.read_mesh(SAMPLES / "sphere.obj")
    V = V / np.abs(V).max() * [2.5, 0.6, 0.6]
    m = innermap.fit(V, F, bent(V), tolerance=1e-2)
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder) / "before.ply", Path(folder) / "after.ply"
        write(before, capture(V, F))
        figures = innermap.push(m, before, after, outside=0.02)
        straight, curved = read(before), read(after)
    print(f"{figures['splats']} splats, {figures['points_cut']} too far outside")
    centres = straight.copy()
    for name in "xyz":
        centres[name] = curved[name]
    shown = [(straight, "a capture", [0, 0, 0]), (centres, "its centres bent alone", [0, 0.3, 0]),
             (curved, "its splats bent", [0, 0.3, 0])]
    sheet = Image.new("RGB", (3 * WIDTH, HEIGHT + 26), "white")
    for k, (splats, title, target) in enumerate(shown):
        target = np.array(target)
        image = render(splats, target + [1.5, 2.6, 8.0], target)
        sheet.paste(Image.fromarray((255 * np.clip(image, 0, 1)).astype(np.uint8)), (k * WIDTH, 26))
        ImageDraw.Draw(sheet).text((k * WIDTH + 20, 6), title, fill="black", font=LETTERS)
    sheet.save(picture, optimize=True)
    print(f"splats: {picture}")


if __name__ == "__main__":
    main()
