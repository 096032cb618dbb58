"""A cow and the man that she was mapped onto, both cut open: each check of the cow's flesh, and each spot of her
hide, where the map takes it.

    innermap map spot.obj homer.obj -o out/cow_man
    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/cow_into_man.py -- OUT.jpg [SAMPLES]
"""
import os
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from mathutils.bvhtree import BVHTree

sys.path.append(str(Path(__file__).parent))
import innermap  # noqa: E402
import studio  # noqa: E402

RUN = Path(os.environ.get("COW_MAN", studio.ROOT / "out/cow_man"))
CHECK = 0.105   # the edge of a cube, in the cow's units
ACROSS = 900    # pixels along the picture of a cut
MIDDLE_OF_COW, NECK_OF_COW = 0.004, -0.19


def checks(P):
    """Colours of the cow's flesh at places in it: hue along the body, light and dark cubes."""
    share = np.clip((P[:, 2] + 0.70) / 1.75, 0, 1)
    odd = np.floor(P / CHECK + 0.25).sum(axis=1) % 2
    base = studio.ramp(0.07 + 0.86 * share)
    return np.where(odd[:, None] > 0, 0.28 * base, 0.10 + 0.90 * base)


def image_of(name, plane, values, low, high):
    """A picture of colours over a rectangle of the plane, as a material for the cut there."""
    image = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=True)
    image.colorspace_settings.name = 'Linear'
    image.pixels = np.concatenate([values, np.ones_like(values[..., :1])], axis=-1).astype(np.float32).ravel()
    made, nodes, links, out = studio.material(name)
    shader = nodes.new('ShaderNodeBsdfPrincipled')
    shader.inputs["Roughness"].default_value = 0.45
    picture, place = nodes.new('ShaderNodeTexImage'), nodes.new('ShaderNodeTexCoord')
    picture.image, picture.extension = image, 'EXTEND'
    parts, both = nodes.new('ShaderNodeSeparateXYZ'), nodes.new('ShaderNodeCombineXYZ')
    links.new(place.outputs["Object"], parts.inputs[0])
    for i, axis in enumerate(plane):
        span = nodes.new('ShaderNodeMapRange')
        span.clamp = False
        span.inputs[1].default_value, span.inputs[2].default_value = low[i], high[i]
        links.new(parts.outputs[axis], span.inputs[0])
        links.new(span.outputs[0], both.inputs[i])
    links.new(both.outputs[0], picture.inputs[0])
    links.new(picture.outputs[0], shader.inputs["Base Color"])
    links.new(shader.outputs[0], out.inputs["Surface"])
    return made


def section(name, V, plane, level, source):
    """The material of the cut where the third axis is `level`; source: places in the cow, NaN outside."""
    third = 3 - sum(plane)
    low, high = V[:, plane].min(axis=0), V[:, plane].max(axis=0)
    n = 260
    u, v = np.meshgrid(np.linspace(low[0], high[0], n), np.linspace(low[1], high[1], n))
    X = np.full((n * n, 3), float(level))
    X[:, plane[0]], X[:, plane[1]] = u.ravel(), v.ravel()
    assert third not in plane
    P = grown(source(X).reshape(n, n, 3))
    at = np.linspace(0, n - 1, ACROSS * 2)
    i = np.minimum(at.astype(int), n - 2)
    t = at - i
    P = (1 - t)[:, None, None] * P[i] + t[:, None, None] * P[i + 1]
    P = (1 - t)[None, :, None] * P[:, i] + t[None, :, None] * P[:, i + 1]
    colours = checks(P.reshape(-1, 3)).reshape(ACROSS, 2, ACROSS, 2, 3).mean(axis=(1, 3))
    return image_of(name, plane, colours, low, high)


def grown(P, rounds=12):
    """NaNs beside known places filled from these, so that a cut has its colour up to the rim."""
    for _ in range(rounds):
        missing = np.isnan(P[..., 0])
        padded = np.pad(P, ((1, 1), (1, 1), (0, 0)), constant_values=np.nan)
        near = np.stack([padded[1 + a:1 + a + P.shape[0], 1 + b:1 + b + P.shape[1]]
                         for a in (-1, 0, 1) for b in (-1, 0, 1)])
        known = ~np.isnan(near[..., :1])
        mean = np.where(known, near, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        P = np.where((missing & known.any(axis=(0, 3)))[..., None], mean, P)
    return np.nan_to_num(P)


def finer(points, faces, rounds=2):
    """Each triangle cut in four; points: several arrays of the same vertices."""
    for _ in range(rounds):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, where = np.unique(edges, axis=0, return_inverse=True)
        m = where.reshape(-1, 3) + len(points[0])
        points = [np.concatenate([p, p[unique].mean(axis=1)]) for p in points]
        a, b, c = faces.T
        faces = np.concatenate([np.stack(t, axis=1) for t in (
            (a, m[:, 0], m[:, 2]), (b, m[:, 1], m[:, 0]), (c, m[:, 2], m[:, 1]), m.T)])
    return points, faces


def hide(P):
    """Colours of the cow's hide, from her texture, at places on it."""
    bpy.ops.wm.obj_import(filepath=str(studio.MODELS / "spot.obj"), forward_axis='Y', up_axis='Z')
    cow = bpy.context.selected_objects[0]
    data = cow.data
    data.calc_loop_triangles()
    corners = np.array([t.loops[:] for t in data.loop_triangles])
    uv = np.array([x.uv[:] for x in data.uv_layers[0].data])
    V = np.array([v.co[:] for v in data.vertices])
    F = np.array([t.vertices[:] for t in data.loop_triangles])
    tree = BVHTree.FromPolygons(V.tolist(), F.tolist())
    image = bpy.data.images.load(str(studio.MODELS / "spot_texture.png"))
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, -1)[..., :3]
    found = [tree.find_nearest(p) for p in P.tolist()]
    at, face = np.array([f[0][:] for f in found]), np.array([f[2] for f in found])
    a, b, c = (V[F[face, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", n, n)
    weights = np.stack([np.einsum("ij,ij->i", np.cross(q - p, at - p), n) / area
                        for p, q in ((b, c), (c, a), (a, b))], axis=1)
    where = np.einsum("ij,ijk->ik", weights, uv[corners[face]])
    x = np.clip((where[:, 0] * width).astype(int), 0, width - 1)
    y = np.clip((where[:, 1] * height).astype(int), 0, height - 1)
    bpy.data.objects.remove(cow)
    return studio.srgb(pixels[y, x])


def main():
    out, samples = studio.arguments(__doc__)
    studio.scene((1440, 800), samples, 0.55)
    S, F = innermap.read_mesh(RUN / "correspondence.source.ply")
    T, _ = innermap.read_mesh(RUN / "correspondence.ply")
    m = innermap.load(RUN / "map.ply")
    (S2, T2), F2 = finer([S, T], F)
    rgb = hide(S2)

    def of_cow(X):
        return np.where(m.contains(X)[:, None], X, np.nan)

    def of_man(X):
        places, found = m.inverse(X)
        return np.where(np.asarray(found)[:, None], places, np.nan)

    skin = studio.painted("hide", 0.45, 0.3)
    # Of the cow one side of the body is taken away, of the man the front of one side.
    cow = studio.mesh("cow", S2, F2, skin, rgb)
    along = section("cow cut", S, [2, 1], MIDDLE_OF_COW, of_cow)
    studio.cut(cow, (MIDDLE_OF_COW, 0, 0), (1, 0, 0), along)
    head = studio.mesh("head", S2, F2, skin, rgb)
    neck = section("neck cut", S, [0, 1], NECK_OF_COW, of_cow)
    studio.cut(head, (MIDDLE_OF_COW, 0, 0), (-1, 0, 0), neck)
    studio.cut(head, (0, 0, NECK_OF_COW), (0, 0, 1), neck)
    for part in (cow, head):
        stand(part, S, 1.74, (-0.72, 0.1), 1.5 * np.pi + 0.36)

    side, front = (T[:, k].min() + share * np.ptp(T[:, k]) for k, share in ((0, 0.5), (2, 0.44)))
    back = studio.mesh("back", T2, F2, skin, rgb)
    studio.cut(back, (0, 0, front), (0, 0, 1), section("front cut", T, [0, 1], front, of_man))
    half = studio.mesh("half", T2, F2, skin, rgb)
    across = section("side cut", T, [2, 1], side, of_man)
    studio.cut(half, (0, 0, front), (0, 0, -1), across)
    studio.cut(half, (side, 0, 0), (-1, 0, 0), across)
    for part in (back, half):
        stand(part, T, 2.05, (0.98, 0), 0.14)
    studio.floor(0)
    studio.camera((0, -8.2, 1.6), (0.06, 0, 1.0), lens=72)
    studio.light((-4, -4, 6), (0, 0, 0.8), 2.5, 300, (1, 0.95, 0.88))
    studio.light((5, -4, 3), (0, 0, 0.8), 4, 90, (0.85, 0.93, 1))
    studio.render(out)


def stand(ob, V, height, at, turn):
    """On the floor, so high, turned about z; models have y up."""
    middle = (V.min(axis=0) + V.max(axis=0)) / 2
    ob.matrix_world = (Matrix.Translation((*at, 0)) @ Matrix.Rotation(turn, 4, 'Z')
                       @ Matrix.Rotation(np.pi / 2, 4, 'X') @ Matrix.Scale(height / np.ptp(V[:, 1]), 4)
                       @ Matrix.Translation((-middle[0], -V[:, 1].min(), -middle[2])))


if __name__ == "__main__":
    main()
