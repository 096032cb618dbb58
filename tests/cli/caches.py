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
    content = cli.read_file(path)
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


def write_scene(path, arrays, scene):
    """A glTF file and its .bin; arrays: (bytes, type, count) of floats, an accessor each."""
    binary = path.replace(".gltf", ".bin")
    views, at = [], 0
    for data, _, _ in arrays:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(data)})
        at += len(data)
    cli.write_file(binary, b"".join(data for data, _, _ in arrays))
    with open(path, "w", encoding="ascii") as file:
        json.dump({"asset": {"version": "2.0"}, "bufferViews": views,
                   "buffers": [{"byteLength": at, "uri": binary}],
                   "accessors": [{"bufferView": i, "componentType": 5126, "type": kind, "count": count}
                                 for i, (_, kind, count) in enumerate(arrays)], **scene}, file)


def floats(rows):
    return b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)


def write_gltf(path):
    """A ball of split vertices that is moved and grows, from frame 12 to 36 of 24 a second."""
    vertices, faces = cli.icosphere_arrays(3)
    corners = [vertices[i] for f in faces for i in f]
    arrays = [(floats(corners), "VEC3", len(corners)), (floats([(0.5, 1.5)]), "SCALAR", 2),
              (floats([(0, 0, 0), (1, -2, 0.5)]), "VEC3", 2),
              (floats([(1, 1, 1), (1.5, 1.5, 1.5)]), "VEC3", 2)]
    write_scene(path, arrays, {
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"name": "ball", "mesh": 0}],
        "animations": [{"name": "move", "samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 3}],
                        "channels": [{"sampler": i, "target": {"node": 0, "path": moved}}
                                     for i, moved in enumerate(("translation", "scale"))]}]})
    return vertices, faces


def write_morphs(path, rest, faces, frames, order):
    """A glTF file whose mesh has a morph target a frame, shown one after the other at 24 a second.
    Every triangle has vertices of its own, and triangles come in this order."""
    corners = [i for f in order for i in faces[f]]
    steps, count = len(frames), len(corners)
    arrays = [(floats(rest[i] for i in corners), "VEC3", count)]
    for frame in frames:
        moves = ([a - b for a, b in zip(frame[i], rest[i])] for i in corners)
        arrays.append((floats(moves), "VEC3", count))
    arrays.append((floats([(k + 1) / 24] for k in range(steps)), "SCALAR", steps))
    shown = ([float(a == b)] for a in range(steps) for b in range(steps))
    arrays.append((floats(shown), "SCALAR", steps * steps))
    write_scene(path, arrays, {
        "meshes": [{"weights": [0.0] * steps,
                    "primitives": [{"attributes": {"POSITION": 0},
                                    "targets": [{"POSITION": 1 + k} for k in range(steps)]}]}],
        "nodes": [{"mesh": 0}],
        "animations": [{"samplers": [{"input": 1 + steps, "output": 2 + steps, "interpolation": "STEP"}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]})
