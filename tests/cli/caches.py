"""Animations in one file, written and read as their formats are described."""

import json
import os
import struct

import cli
from frames import ball_frames, twisted

TIMES = {1: 0.1, 2: 0.2, 3: 0.3, 4: 0.4}


def as_float(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def write_mdd(path, frames, fps=24):
    points = len(frames[0])
    with open(path, "wb") as file:
        file.write(struct.pack(">2i", len(frames), points))
        file.write(struct.pack(f">{len(frames)}f", *(i / fps for i in range(len(frames)))))
        for frame in frames:
            file.write(struct.pack(f">{3 * points}f", *(c for p in frame for c in p)))


def write_pc2(path, frames, start=1.0, step=1.0):
    points = len(frames[0])
    with open(path, "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, points, start, step, len(frames)))
        for frame in frames:
            file.write(struct.pack(f"<{3 * points}f", *(c for p in frame for c in p)))


def read_pc2(path):
    with open(path, "rb") as file:
        content = file.read()
    _, _, points, start, step, frames = struct.unpack("<12siiffi", content[:32])
    assert len(content) == 32 + 12 * points * frames
    flat = struct.unpack(f"<{3 * points * frames}f", content[32:])
    places = [flat[i:i + 3] for i in range(0, len(flat), 3)]
    return start, step, [places[i:i + points] for i in range(0, len(places), points)]


def cached_frames(motion=twisted):
    """Files frames/f.0001.obj..., and the same numbers in walk.mdd and walk.pc2."""
    vertices, faces = cli.icosphere_arrays(3)
    frames = [[tuple(map(as_float, motion(v, t))) for v in vertices] for t in TIMES.values()]
    ball_frames(motion, {})
    os.makedirs("frames")
    for number, frame in zip(TIMES, frames):
        cli.write_obj(f"frames/f.{number:04d}.obj", frame, faces)
    write_mdd("walk.mdd", frames)
    write_pc2("walk.pc2", frames, start=101)
    return frames


def write_gltf(path):
    """A ball of split vertices that is moved and grows, from frame 12 to 36 of 24 a second."""
    vertices, faces = cli.icosphere_arrays(3)
    corners = [vertices[i] for f in faces for i in f]
    data = struct.pack(f"<{3 * len(corners)}f", *(c for p in corners for c in p))
    keys = struct.pack("<2f", 0.5, 1.5), struct.pack("<6f", 0, 0, 0, 1, -2, 0.5), \
        struct.pack("<6f", 1, 1, 1, 1.5, 1.5, 1.5)
    parts, views, at = [data, *keys], [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    kinds = [("VEC3", len(corners)), ("SCALAR", 2), ("VEC3", 2), ("VEC3", 2)]
    with open(path.replace(".gltf", ".bin"), "wb") as file:
        file.write(b"".join(parts))
    scene = {
        "asset": {"version": "2.0"}, "bufferViews": views,
        "buffers": [{"byteLength": at, "uri": path.replace(".gltf", ".bin")}],
        "accessors": [{"bufferView": i, "componentType": 5126, "count": n, "type": kind}
                      for i, (kind, n) in enumerate(kinds)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"name": "ball", "mesh": 0}],
        "animations": [{"name": "move", "samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 3}],
                        "channels": [{"sampler": i, "target": {"node": 0, "path": path}}
                                     for i, path in enumerate(("translation", "scale"))]}]}
    with open(path, "w", encoding="ascii") as file:
        json.dump(scene, file)
    return vertices, faces


def write_morphs(path, rest, faces, frames, order):
    """A glTF file whose mesh has a morph target a frame, shown one after the other at 24 a second.
    Every triangle has vertices of its own, and triangles come in this order."""
    corners = [i for f in order for i in faces[f]]
    steps, count = len(frames), len(corners)
    parts = [b"".join(struct.pack("<3f", *rest[i]) for i in corners)]
    for frame in frames:
        parts.append(b"".join(struct.pack("<3f", *(a - b for a, b in zip(frame[i], rest[i]))) for i in corners))
    parts.append(struct.pack(f"<{steps}f", *((k + 1) / 24 for k in range(steps))))
    parts.append(struct.pack(f"<{steps * steps}f", *(float(a == b) for a in range(steps) for b in range(steps))))
    kinds = [("VEC3", count)] * (1 + steps) + [("SCALAR", steps), ("SCALAR", steps * steps)]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    with open(path.replace(".gltf", ".bin"), "wb") as file:
        file.write(b"".join(parts))
    scene = {
        "asset": {"version": "2.0"}, "bufferViews": views,
        "buffers": [{"byteLength": at, "uri": path.replace(".gltf", ".bin")}],
        "accessors": [{"bufferView": i, "componentType": 5126, "count": n, "type": kind}
                      for i, (kind, n) in enumerate(kinds)],
        "meshes": [{"weights": [0.0] * steps,
                    "primitives": [{"attributes": {"POSITION": 0},
                                    "targets": [{"POSITION": 1 + k} for k in range(steps)]}]}],
        "nodes": [{"mesh": 0}],
        "animations": [{"samplers": [{"input": 1 + steps, "output": 2 + steps, "interpolation": "STEP"}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]}
    with open(path, "w", encoding="ascii") as file:
        json.dump(scene, file)
