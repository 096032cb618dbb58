#!/usr/bin/env python3
"""transfer-distance: the target's distance field through a map."""

import os
import shutil
import struct

import cli
from cli import fails, icosphere_arrays, innermap, write_obj

FILES = {"source.vdb", "target.vdb", "source.png", "target.png", "report.json"}


def ellipsoid_map():
    """A ball and twice that, shifted, so that distances are twice the source's."""
    vertices, faces = icosphere_arrays(subdivisions=3)
    write_obj("a.obj", vertices, faces)
    write_obj("b.obj", [(2 * x + 5, 2 * y, 2 * z - 1) for x, y, z in vertices], faces)
    innermap("fit", "a.obj", "b.obj", "-o", "map.ply", "--quiet")


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(24)
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


def test_five_files_with_distances_everywhere():
    ellipsoid_map()
    innermap("transfer-distance", "map.ply", "-o", "out", "--resolution", "64")
    assert set(os.listdir("out")) == FILES
    distance = cli.read_json("out/report.json")["distance"]
    # Half a voxel's diagonal, and what flat faces cut off.
    assert abs(distance["largest_in_target"] - 2) < 0.08, distance
    assert abs(distance["largest_through_map"] - 2) < 0.08, distance
    assert abs(distance["largest_in_source"] - 1) < 0.04, distance
    assert distance["outside_fraction"] < 0.01
    assert distance["range"] == [0, distance["largest_in_target"]]
    for name in ("source.png", "target.png"):
        assert min(png_size(f"out/{name}")) > 700
    text = innermap("info", "out/source.vdb", "--metadata").stdout
    assert all(f"{grid}: float" in text for grid in ("distance", "source_distance", "surface"))
    assert "innermap_boundary_error_rms" in text


def test_an_independent_reader_sees_twice_the_sources_distance():
    ellipsoid_map()
    innermap("transfer-distance", "map.ply", "-o", "out", "--resolution", "40", "--quiet")
    cli.independent("""
import pyopenvdb as vdb
own, through = (vdb.read("out/source.vdb", n) for n in ("source_distance", "distance"))
assert own.activeVoxelCount() == through.activeVoxelCount() > 30000
accessor, seen = own.getConstAccessor(), 0
for value in through.iterOnValues():
    assert abs(value.value - 2 * accessor.getValue(value.min)) < 0.01, value
    seen += 1
assert seen == own.activeVoxelCount()
""")


def test_settings():
    ellipsoid_map()
    innermap("transfer-distance", "map.ply", "-o", "out", "--voxel-size", "0.2", "--range", "0,3",
             "--section", "x=0.3")
    report = cli.read_json("out/report.json")
    assert report["grid"]["voxel_size"] == report["grid"]["target_voxel_size"] == 0.2
    assert report["distance"]["range"] == [0, 3]
    shutil.rmtree("out")
    innermap("transfer-distance", "map.ply", "-o", "out", "--dry-run")
    fails(1, "transfer-distance", "missing.ply", "-o", "out", says=["missing.ply"])
    fails(1, "transfer-distance", "a.obj", "-o", "out", says=["a.obj"])
    fails(1, "transfer-distance", "map.ply", "-o", "out", "--range", "2,1", says=["range"])
    fails(1, "transfer-distance", "map.ply", "-o", "out", "--section", "x=2",
          says=["--section"])
    fails(1, "transfer-distance", "map.ply", "-o", "out", "--max-memory", "3M",
          says=["--max-memory"])


cli.run(globals())
