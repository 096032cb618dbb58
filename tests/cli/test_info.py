#!/usr/bin/env python3
"""What innermap info says of files, in words and as JSON; the scales of sections."""

import json
import struct
import zlib

import cli
from cli import cube, fails, innermap

MAP = ["--charges", "200", "--resolution", "24"]


def mapped():
    vertices, faces = cli.icosphere_arrays(2)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("egg.obj", [(1.5 * x, y, z) for x, y, z in vertices], faces)
    innermap("map", "ball.obj", "egg.obj", "-o", "out", *MAP, "-q")


def read(path, *options):
    return json.loads(innermap("info", path, "--json", *options).stdout)


def test_what_all_grids_say_stands_once():
    mapped()
    short = innermap("info", "out/map.vdb").stdout
    assert "  jacobian: float" in short and "innermap_" not in short
    every = innermap("info", "out/map.vdb", "--metadata").stdout
    assert every.index("  jacobian: float") < every.index("in all grids:")
    lines = [line.strip() for line in every.split("\n")]
    for key in ["innermap_source: ball.obj", "innermap_target: egg.obj", "innermap_version: "]:
        assert sum(line.startswith(key) for line in lines) == 1, key
    assert lines.index("in all grids:") < lines.index("innermap_target: egg.obj")
    assert sum(line.startswith("file_voxel_count") for line in lines) >= 2
    told = innermap("info", "out/map.ply").stdout
    assert "  target: egg.obj" in told and "99% within" in told and "rank: " not in told
    assert "rank: " in innermap("info", "out/map.ply", "--metadata").stdout


def test_json_of_each_kind_of_file():
    mapped()
    vdb = read("out/map.vdb")
    assert vdb["kind"] == "vdb"
    grids = {g["name"]: g for g in vdb["grids"]}
    assert {"surface", "map", "jacobian"} <= set(grids)
    assert grids["map"]["type"] == "vec3s" and grids["surface"]["class"] == "level set"
    assert grids["jacobian"]["active_voxels"] > 1000 and len(grids["jacobian"]["box"]) == 2
    assert abs(grids["map"]["voxel_size"][0] - 2 / 24) < 0.01
    assert grids["map"]["metadata"]["innermap_target"] == "egg.obj"
    field = read("out/map.ply")
    assert field["kind"] == "map" and field["charges"] == [200] and field["channels"] == 3
    assert float(field["facts"]["boundary_error_rms"]) < 0.01 or field["facts"]
    mesh = read("ball.obj")
    assert mesh["kind"] == "mesh" and mesh["vertices"] == 162 and mesh["triangles"] == 320
    assert 3.8 < mesh["volume"] < 4.2 and len(mesh["box"]) == 2
    exr = read("out/slices.exr")
    assert exr["kind"] == "exr" and len(exr["parts"]) == 16 and "volume_texture" not in exr
    assert exr["parts"][0]["name"] == "z_0000"


def test_volume_textures_show_tiling_bounds_and_voxel_size():
    cube()
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "20", "--fog", "-q")
    for layout in ["atlas", "parts"]:
        innermap("export", "a.vdb", "-o", "t.exr", "--grids", "density", "--layout", layout, "--tiles",
                 "5x5", "--pad", "1") if layout == "atlas" else \
            innermap("export", "a.vdb", "-o", "t.exr", "--grids", "density", "--layout", layout)
        volume = read("t.exr")["volume_texture"]
        size, box = volume["voxel_size"], volume["world_box"]
        for k in range(3):
            assert abs(box[1][k] - box[0][k] - volume["resolution"][k] * size[k]) < 1e-6
        assert volume["layout"] == layout and volume["slices"] == volume["resolution"][2]
        assert volume["grids"][0]["name"] == "density"
        said = innermap("info", "t.exr").stdout
        assert f"voxels of {size[0]:.6g}, box (" in said and "density: float, fog volume in Y" in said
        if layout == "atlas":
            assert volume["tiles"] == [5, 5] and "atlas of 5 x 5 tiles" in said


def pixels(path):
    """Rows of (red, green, blue) of a PNG of 8 bits."""
    data = cli.read_file(path)[8:]
    packed, width, height, channels = b"", 0, 0, 3
    while data:
        length, kind = struct.unpack(">I4s", data[:8])
        body = data[8:8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack(">II", body[:8])
            channels = {2: 3, 6: 4, 0: 1}[body[9]]
        elif kind == b"IDAT":
            packed += body
        data = data[12 + length:]
    raw, rows, before = zlib.decompress(packed), [], bytes(width * channels)
    for y in range(height):
        line = bytearray(raw[y * (width * channels + 1) + 1:(y + 1) * (width * channels + 1)])
        way = raw[y * (width * channels + 1)]
        for i, value in enumerate(line):
            left = line[i - channels] if i >= channels else 0
            up, corner = before[i], before[i - channels] if i >= channels else 0
            p = left + up - corner
            paeth = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            line[i] = (value + [0, left, up, (left + up) // 2, paeth][way]) & 255
        rows.append([tuple(line[i:i + 3]) for i in range(0, len(line), channels)])
        before = bytes(line)
    return rows


def test_scales_and_colormaps():
    mapped()
    section = ["slice", "out/map.vdb", "--grid", "jacobian", "--pixels", "64"]
    innermap(*section, "--picture", "a.png", "--report", "r.json")
    lower, upper = cli.read_json("r.json")["section"]["range"]
    assert upper >= 1.49 and abs(lower * upper - 1) < 1e-6  # 1 has the middle colour
    innermap(*section, "--picture", "b.png", "--scale", "linear", "--report", "r.json")
    lower, upper = cli.read_json("r.json")["section"]["range"]
    assert lower > 1.4 and upper < 1.6
    seen = set()
    for name in ["red-blue", "viridis", "cividis", "inferno", "gray"]:
        innermap(*section, "--picture", "c.png", "--colormap", name)
        seen.add(tuple(map(tuple, pixels("c.png"))))
    assert len(seen) == 5
    fails(2, *section, "--picture", "c.png", "--colormap", "rainbow", says=["viridis"])
    fails(1, *section, "--picture", "c.png", "--scale", "log", "--range", "-1,1")


def test_folds_have_a_colour_of_their_own():
    vertices, faces = cli.icosphere_arrays(2)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("turned.obj", [(-x, y, z) for x, y, z in vertices], faces)
    innermap("map", "ball.obj", "turned.obj", "-o", "out", "--one-to-one", "off", "--best-effort",
             "--repair", "off", *MAP, "-q")
    innermap("slice", "out/map.vdb", "--grid", "jacobian", "--picture", "a.png", "--pixels", "64")
    colours = [c for row in pixels("a.png") for c in row]
    folded = sum(r > 180 and g < 40 and b > 170 for r, g, b in colours)
    assert folded > 1000, folded


cli.run(globals())
