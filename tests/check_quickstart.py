#!/usr/bin/python3
"""Checks what samples/quickstart wrote, with readers that are not innermap's: OpenVDB's and
OpenImageIO's Python modules.

    check_quickstart.py FOLDER SOURCE.obj TARGET.obj
"""
import json
import math
import os
import sys

import numpy as np
import OpenImageIO as oiio
import pyopenvdb

GRIDS = {"surface": float, "density": float, "map": tuple, "jacobian": float,
         "harmonic_energy": float, "deformation_energy": float}


def vertices(path):
    with open(path, encoding="utf-8") as file:
        return np.array([[float(x) for x in line.split()[1:4]] for line in file
                         if line.startswith("v ")])


def check_report(path, source):
    """The two geckos are clean and closed and have a good map: a report that says otherwise is
    wrong, or the defaults are."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    mesh = report["source"]
    assert mesh["vertices"] == len(source), mesh
    assert mesh["boundary_loops"] == 0 and mesh["caps"] == 0 and mesh["genus"] == 0, mesh
    error = report["boundary_error"]
    assert error["samples"] >= 20000, error
    assert 0 < error["rms"] <= error["p99"] <= error["max"], error
    assert error["rms"] < 3e-3, error  # a tenth of the toes' thickness
    assert report["jacobian"]["folded_fraction"] < 0.01, report["jacobian"]
    return report


def check_volume(path, report, source, target):
    grids = {name: pyopenvdb.read(path, name) for name in GRIDS}
    for name, grid in grids.items():
        kind = tuple if isinstance(grid.background, tuple) else float
        assert kind is GRIDS[name], f"{name}: {type(grid)}"
        assert grid.activeVoxelCount() > 10000, f"{name}: {grid.activeVoxelCount()} voxels"
        assert grid.transform.voxelSize() == grids["surface"].transform.voxelSize(), name
    assert grids["surface"].gridClass == "level set", grids["surface"].gridClass
    assert grids["density"].gridClass == "fog volume", grids["density"].gridClass

    size = grids["map"].transform.voxelSize()[0]
    assert math.isclose(size, report["grid"]["voxel_size"], rel_tol=1e-6), size
    fog = sum(item.value * item.count for item in grids["density"].iterOnValues()) * size ** 3
    assert abs(fog / report["source"]["volume"] - 1) < 0.05, fog

    # The map carries each vertex of the source to that of the target, as far as the nearest voxel
    # can tell: it is at most sqrt(3) / 2 voxels off, stretched by the map.
    access = grids["map"].getConstAccessor()
    places = grids["map"].transform.worldToIndex
    stretch = 2.5
    for p, q in zip(source[::10], target[::10]):
        value, active = access.probeValue(tuple(int(round(x)) for x in places(tuple(p))))
        assert active, f"map has no value at vertex {p}"
        miss = np.linalg.norm(np.array(value) - q)
        assert miss < stretch * size * math.sqrt(3) / 2, f"{p} goes to {value}, not {q}"


def check_slices(path):
    image = oiio.ImageInput.open(path)
    assert image, oiio.geterror()
    parts = 0
    while image.seek_subimage(parts, 0):
        names = image.spec().channelnames
        for name in ("map.X", "map.Y", "map.Z", "jacobian.V", "deformation_energy.V"):
            assert name in names, f"part {parts}: {names}"
        values = image.read_image("float")
        assert values is not None and np.isfinite(values).all(), f"part {parts}"
        parts += 1
    image.close()
    assert parts == 16, f"{parts} parts"


def check_picture(path):
    image = oiio.ImageInput.open(path)
    assert image, oiio.geterror()
    values = image.read_image("uint8")
    image.close()
    colours = np.unique(values.reshape(-1, values.shape[-1])[:, :3], axis=0).astype(int)
    assert values.shape[0] >= 256 and values.shape[1] >= 256, values.shape
    assert (colours[:, 2] > colours[:, 0] + 60).any(), "no blue in the picture"
    assert (colours[:, 0] > colours[:, 2] + 60).any(), "no red in the picture"


def main():
    folder, source, target = sys.argv[1], vertices(sys.argv[2]), vertices(sys.argv[3])
    report = check_report(os.path.join(folder, "report.json"), source)
    check_volume(os.path.join(folder, "map.vdb"), report, source, target)
    check_slices(os.path.join(folder, "slices.exr"))
    check_picture(os.path.join(folder, "section.png"))
    print("All that the quickstart wrote is as it should be.")


if __name__ == "__main__":
    main()
