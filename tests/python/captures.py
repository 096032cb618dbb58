"""Captures of Gaussian splats, read, written and evaluated by what their format says and no more."""

import numpy as np

CHANNELS = 3


def names(degree):
    rest = CHANNELS * ((degree + 1) ** 2 - 1)
    return (["x", "y", "z", "nx", "ny", "nz"] + [f"f_dc_{i}" for i in range(CHANNELS)] +
            [f"f_rest_{i}" for i in range(rest)] + ["opacity"] + [f"scale_{i}" for i in range(3)] +
            [f"rot_{i}" for i in range(4)])


def random_capture(places, degree=3, seed=1, kind="<f4"):
    """Splats of all shapes at the places."""
    random, n = np.random.default_rng(seed), len(places)
    out = np.zeros(n, dtype=[(name, kind) for name in names(degree)])
    for axis, name in enumerate("xyz"):
        out[name] = places[:, axis]
    for name in names(degree)[6:-7]:
        out[name] = 0.3 * random.normal(size=n)
    for i in range(3):
        out[f"scale_{i}"] = random.uniform(-7, -3, n)
    for i in range(4):
        out[f"rot_{i}"] = random.normal(size=n)
    out["opacity"] = random.normal(size=n) - 1
    return out


def write(path, capture):
    words = {"<f4": "float", "<f8": "double"}
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(capture)}"]
    lines += [f"property {words[capture.dtype[n].str]} {n}" for n in capture.dtype.names]
    with open(path, "wb") as file:
        file.write(("\n".join(lines + ["end_header"]) + "\n").encode() + capture.tobytes())


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    header, _, body = data.partition(b"end_header\n")
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines[:2]
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    words = {"float": "<f4", "double": "<f8"}
    kinds = [(line.split()[2], words[line.split()[1]]) for line in lines if line.startswith("prop")]
    capture = np.frombuffer(body, dtype=kinds)
    assert len(capture) == count, (len(capture), count)
    return capture


def columns(capture, stem, count):
    return np.stack([capture[f"{stem}_{i}"].astype(float) for i in range(count)], axis=1)


def places(capture):
    return np.stack([capture[name].astype(float) for name in "xyz"], axis=1)


def covariances(capture):
    """R diag(exp(scale))^2 R^T with the rotation of w, x, y, z, made a unit."""
    q = columns(capture, "rot", 4)
    w, x, y, z = (q / np.linalg.norm(q, axis=1)[:, None]).T
    R = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                  2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                  2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                 axis=1).reshape(-1, 3, 3)
    squares = np.exp(2 * columns(capture, "scale", 3))
    return np.einsum("nik,nk,njk->nij", R, squares, R)


def basis(d):
    """The harmonics of degrees 0 to 3 at unit directions (..., 3), as the reference evaluates them."""
    x, y, z = np.moveaxis(d, -1, 0)
    xx, yy, zz = x * x, y * y, z * z
    return np.stack([
        0.28209479177387814 * np.ones_like(x),
        -0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x,
        1.0925484305920792 * x * y, -1.0925484305920792 * y * z,
        0.31539156525252005 * (2 * zz - xx - yy), -1.0925484305920792 * x * z,
        0.5462742152960396 * (xx - yy),
        -0.5900435899266435 * y * (3 * xx - yy), 2.890611442640554 * x * y * z,
        -0.4570457994644658 * y * (4 * zz - xx - yy),
        0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
        -0.4570457994644658 * x * (4 * zz - xx - yy), 1.445305721320277 * z * (xx - yy),
        -0.5900435899266435 * x * (xx - 3 * yy)], axis=-1)


def colours(capture, directions):
    """(n, m, 3) of splats seen along directions (m, 3), or (n, m, 3), each splat's own."""
    rest = sum(name.startswith("f_rest_") for name in capture.dtype.names)
    count = 1 + rest // CHANNELS
    k = np.concatenate([columns(capture, "f_dc", CHANNELS)[:, :, None],
                        columns(capture, "f_rest", rest).reshape(-1, CHANNELS, count - 1)], axis=2)
    values = basis(directions)[..., :count]
    return np.einsum("nck,...mk->nmc" if values.ndim == 2 else "nck,nmk->nmc", k, values) + 0.5


def turns(J):
    """The orthogonal factor of the polar decomposition of each."""
    U, _, V = np.linalg.svd(J)
    return U @ V


def directions(count=100, seed=3):
    d = np.random.default_rng(seed).normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1)[:, None]


def errors(before, after, at, J):
    """How far a carried capture is from places, covariances and colours that it should have."""
    expected = np.einsum("nik,nkl,njl->nij", J, covariances(before), J)
    size = np.abs(expected).max(axis=(1, 2))
    d = directions()
    turned = np.einsum("nij,mj->nmi", turns(J), d)
    off = []
    for begin in range(0, len(before), 20000):  # for memory
        part = slice(begin, begin + 20000)
        off.append(np.abs(colours(after[part], turned[part]) - colours(before[part], d)).max())
    return {"places": np.abs(places(after) - at).max(),
            "covariances": (np.abs(covariances(after) - expected).max(axis=(1, 2)) / size).max(),
            "colours": max(off)}
