#!/usr/bin/env python3
"""export and import: volume textures in EXR, there and back, and as other programs see them."""

import json
import os
import shutil
import subprocess

import cli
from cli import fails, icosphere, independent, innermap, no_leftovers


def ball_grid(resolution=40, *more):
    icosphere(subdivisions=3)
    innermap("voxelize", "ball.obj", "-o", "ball.vdb", "--resolution", resolution, "--fog",
             "--quiet", *more)


def told(path):
    """Of each grid its name, type, class, voxels and places; not its metadata."""
    grids = json.loads(innermap("info", path, "--json").stdout)["grids"]
    return [{k: v for k, v in grid.items() if k != "metadata"} for grid in grids]


def test_every_layout_comes_back():
    """Values: unit tests, and tests/python/test_volumes.py."""
    ball_grid()
    given = told("ball.vdb")
    for layout, name, first in [("atlas", "a.exr", "a.exr"), ("parts", "p.exr", "p.exr"),
                                ("slices", "s/x.####.exr", "s/x.0000.exr")]:
        os.makedirs("s", exist_ok=True)
        done = innermap("export", "ball.vdb", "-o", name, "--layout", layout, "--report", "r.json")
        report = cli.read_json("r.json")["texture"]
        assert report["layout"] == layout and report["channels"] == ["R", "G"], report
        assert report["clamped"] == 0 and str(report["slices"]) in done.stdout
        assert report["files"] == (report["slices"] if layout == "slices" else 1)
        innermap("import", first, "-o", "back.vdb")
        assert told("back.vdb") == given and len(given) == 2, (told("back.vdb"), given)
    innermap("import", "s/x.%04d.exr", "-o", "again.vdb", "--grids", "density")
    assert "surface" not in innermap("info", "again.vdb").stdout
    innermap("export", "ball.vdb", "-o", "h.exr", "--half", "--axis", "x", "--rows", "up",
             "--power-of-two")
    innermap("import", "h.exr", "-o", "back.vdb")
    assert [g["name"] for g in told("back.vdb")] == [g["name"] for g in given]
    assert os.path.getsize("h.exr") < os.path.getsize("a.exr")


def test_independent_readers_find_channels_and_attributes():
    ball_grid(32)
    innermap("export", "ball.vdb", "-o", "a.exr", "--grids", "density", "--resolution", "16",
             "--cube", "--half", "--active")
    told = independent("""
import sys, OpenImageIO as oiio, numpy
image = oiio.ImageInput.open(sys.argv[1])
spec = image.spec()
assert (spec.width, spec.height) == (64, 64), (spec.width, spec.height)
assert list(spec.channelnames) == ["Y", "density.active"], spec.channelnames
assert str(spec.format) == "half", spec.format
names = {a.name: a.value for a in spec.extra_attribs}
assert names["volumeLayout"] == "atlas" and names["volumeAxis"] == "z"
assert tuple(names["volumeTiles"]) == (4, 4)
assert tuple(names["volumeResolution"]) == (16, 16, 16)
assert names["volumeSliceCount"] == 16 and names["volumeRowOrder"] == "down"
assert names["grid0.name"] == "density" and names["grid0.class"] == "fog volume"
assert names["grid0.type"] == "float" and names["grid0.channel"] == "Y"
pixels = image.read_image(oiio.FLOAT)
# Tile 8, the third row's first, is the middle slice: a disc.
tile = pixels[32:48, 0:16, 0]
assert tile[8, 8] == 1 and tile[0, 0] == 0 and pixels[0, 0, 0] == 0
print(tile.sum())
""", "a.exr")
    assert abs(float(told) / (3.14159 * 8 * 8) - 1) < 0.1, told
    innermap("export", "ball.vdb", "-o", "p.exr", "--layout", "parts")
    independent("""
import sys, OpenImageIO as oiio
image = oiio.ImageInput.open(sys.argv[1])
parts = 0
while image.seek_subimage(parts, 0):
    spec = image.spec()
    assert list(spec.channelnames) == ["R", "G"]
    assert spec.getattribute("volumeSliceIndex") == parts
    parts += 1
assert parts == spec.getattribute("volumeSliceCount"), parts
""", "p.exr")
    if shutil.which("exrinfo"):
        # Its exit code says nothing: now and then it is not 0 for a file that it has read.
        said = subprocess.run(["exrinfo", "-v", "a.exr"], capture_output=True, text=True,
                              check=False).stdout
        for word in ("indexToWorld", "textureToWorld", "volumeWorldMin", "density.active"):
            assert word in said, word
    if shutil.which("oiiotool"):
        subprocess.run(["oiiotool", "a.exr", "--ch", "Y", "-o", "y.png"], check=True,
                       capture_output=True)


def test_what_other_programs_write_is_read_with_options():
    ball_grid(32)
    innermap("export", "ball.vdb", "-o", "a.exr", "--grids", "density", "--report", "r.json")
    told = cli.read_json("r.json")["texture"]
    independent("""
import sys, OpenImageIO as oiio
pixels = oiio.ImageInput.open("a.exr").read_image(oiio.FLOAT)
spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 1, oiio.FLOAT)
spec.channelnames = ["R"]
out = oiio.ImageOutput.create("plain.exr")
out.open("plain.exr", spec)
out.write_image(pixels)
out.close()
spec.tile_width = spec.tile_height = 16
out.open("tiled.exr", spec)
out.write_image(pixels)
out.close()
""")
    fails(1, "import", "plain.exr", "-o", "b.vdb", says=["plain.exr", "volumeTiles", "--tiles"])
    options = ["--tiles", "{:.0f}x{:.0f}".format(*told["tiles"])]
    fails(1, "import", "plain.exr", "-o", "b.vdb", *options, says=["indexToWorld", "--voxel-size"])
    options += ["--voxel-size", "0.0625", "--lower-corner=-1,-1,-1"]
    fails(1, "import", "plain.exr", "-o", "b.vdb", *options, says=["gridCount", "--grids", "R"])
    options += ["--grids", "density", "--class", "fog", "--slices", told["slices"]]
    fails(1, "import", "plain.exr", "-o", "b.vdb", "--tiles", "7x1", says=["--tiles", "7x1"])
    fails(2, "import", "plain.exr", "-o", "b.vdb", "--tiles", "7", says=["--tiles"])
    fails(2, "import", "plain.exr", "-o", "b.vdb", "--lower-corner", "0,0,0",
          says=["--voxel-size"])
    for name in ("plain.exr", "tiled.exr"):
        done = innermap("import", name, "-o", "b.vdb", *options)
        assert "density: float" in done.stdout
        text = innermap("info", "b.vdb", "--metadata").stdout
        assert "fog volume" in text and "voxel size 0.0625" in text, text


def test_overflow_is_said():
    icosphere(subdivisions=2, radius=1e6)
    innermap("voxelize", "ball.obj", "-o", "far.vdb", "--resolution", "16", "--quiet")
    done = innermap("export", "far.vdb", "-o", "h.exr", "--half", "--report", "r.json")
    assert "--half" in done.stderr
    assert cli.read_json("r.json")["texture"]["clamped"] > 0


def test_wrong_settings_and_grids():
    ball_grid(24)
    fails(1, "export", "ball.vdb", "-o", "a.exr", "--grids", "curl", says=["curl", "density"])
    fails(1, "export", "missing.vdb", "-o", "a.exr", says=["missing.vdb"])
    fails(1, "export", "ball.vdb", "-o", "no/such/a.exr", says=["a.exr"])
    fails(2, "export", "ball.vdb", "-o", "a.exr", "--layout", "ring", says=["--layout"])
    fails(2, "export", "ball.vdb", "-o", "a.exr", "--tiles", "3", says=["--tiles"])
    for more in ([], ["--dry-run"]):
        fails(1, "export", "ball.vdb", "-o", "a.exr", "--tiles", "2x2", *more, says=["tiles"])
        fails(1, "export", "ball.vdb", "-o", "a.exr", "--resolution", "9000", *more,
              says=["--resolution"])
    innermap("export", "ball.vdb", "-o", "a.exr")
    fails(1, "import", "a.exr", "-o", "b.vdb", "--grids", "curl", says=["curl", "density"])
    fails(1, "import", "missing.exr", "-o", "b.vdb", says=["missing.exr"])
    fails(1, "import", "x.####.exr", "-o", "b.vdb", says=["x.####.exr"])
    fails(1, "import", "a.exr", "-o", "no/such/b.vdb", says=["b.vdb"])
    fails(1, "import", "a.exr", "-o", "b.vdb", "--max-memory", "1k",
          says=["a.exr", "--max-memory"])
    innermap("export", "ball.vdb", "-o", "d.exr", "--dry-run")
    innermap("import", "a.exr", "-o", "d.vdb", "--dry-run")
    no_leftovers("ball.obj", "ball.vdb", "a.exr")


cli.run(globals())
