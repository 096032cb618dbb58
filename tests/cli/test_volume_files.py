#!/usr/bin/env python3
"""export and import of other programs' volume files, as those programs' own readers see them."""

import cli
from cli import fails, independent, innermap

# A turned, stretched lattice away from the origin; world = (i, j, k, 1) times the matrix.
MATRIX = [[0, 0.5, 0, 0], [-0.25, 0, 0, 0], [0, 0, 2, 0], [10, -20, 30, 1]]
MAKE = f"""
import sys, numpy, pyopenvdb as vdb
matrix = {MATRIX}
rng = numpy.random.default_rng(7)
grids = []
for kind, name in (("FloatGrid", "density"), ("Vec3SGrid", "v"), ("FloatGrid", "heat")):
    make = getattr(vdb, kind, None)
    if make is None:
        continue
    shape = (7, 5, 4)
    values = rng.random(shape + (3,)) - 2 if name == "v" else rng.random(shape) + 1
    grid = make()
    grid.name = name
    grid.copyFromArray(values, ijk=(-3, 2, 6))
    grid.transform = vdb.createLinearTransform(matrix)
    grids.append(grid)
    numpy.save(name + ".npy", values)
vdb.write("g.vdb", grids=grids)
print(" ".join(grid.name for grid in grids))
"""


def grids():
    """g.vdb, and NAME.npy with the values of its voxels from (-3, 2, 6) on; the names."""
    return independent(MAKE, module="pyopenvdb").split()


def test_vtk_reads_values_names_and_places():
    names = grids()
    told = innermap("export", "g.vdb", "-o", "g.vti", "--report", "r.json").stdout
    assert "7 x 5 x 4" in told and "density" in told, told
    report = cli.read_json("r.json")["texture"]
    assert report["channels"] == names and report["resolution"] == [7, 5, 4], report
    independent("""
import sys, numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.util.numpy_support import vtk_to_numpy
reader = vtkXMLImageDataReader()
reader.SetFileName("g.vti")
reader.Update()
image = reader.GetOutput()
assert image.GetDimensions() == (7, 5, 4), image.GetDimensions()
matrix = numpy.array(eval(sys.argv[1]))
for name in sys.argv[2:]:
    expected = numpy.load(name + ".npy")
    array = vtk_to_numpy(image.GetPointData().GetArray(name))
    for i in range(7):
        for j in range(5):
            for k in range(4):
                point = image.ComputePointId((i, j, k))
                assert (array[point] == expected[i, j, k].astype(array.dtype)).all(), (name, i, j, k)
                world = numpy.array([i - 3, j + 2, k + 6, 1.0]) @ matrix
                assert numpy.abs(image.GetPoint(point) - world[:3]).max() < 1e-9, (i, j, k)
""", MATRIX, *names, module="vtkmodules")
    fails(1, "export", "g.vdb", "-o", "h.vti", "--half", says=["half", ".vti"])
    fails(2, "export", "g.vdb", "-o", "g.png", says=["g.png", ".vti", ".nvdb"])
    innermap("export", "g.vdb", "-o", "small.vti", "--grids", "density", "--resolution", "3")


DDS = """
import sys, numpy
data = open(sys.argv[1], "rb").read()
word = numpy.frombuffer(data[:148], "<u4")
assert data[:4] == b"DDS " and word[1] == 124 and data[84:88] == b"DX10" and word[19] == 32
assert word[2] & 0x801007 == 0x801007 and word[20] == 4
assert word[28] == 0x200000 and word[33] == 4 and word[35] == 1
formats = {54: ("<f2", 1), 41: ("<f4", 1), 34: ("<f2", 2), 16: ("<f4", 2), 10: ("<f2", 4),
           2: ("<f4", 4)}
kind, channels = formats[word[32]]
height, width, depth = word[3], word[4], word[6]
assert word[5] == width * channels * int(kind[2])
pixels = numpy.frombuffer(data[148:], kind).reshape(depth, height, width, channels)
"""


def test_dds_is_as_its_description_says():
    if "v" not in grids():
        raise cli.Skip("pyopenvdb has no vectors")
    innermap("export", "g.vdb", "-o", "y.dds", "--grids", "density")
    independent(DDS + """
expected = numpy.load("density.npy").astype("f4")
assert pixels.shape == (4, 5, 7, 1), pixels.shape
assert (pixels[..., 0] == expected.transpose(2, 1, 0)).all()
""", "y.dds")
    innermap("export", "g.vdb", "-o", "ac.dds", "--grids", "density,v", "--half", "--rows", "up",
             "--axis", "x")
    independent(DDS + """
# Slices along x, columns along z, rows along y from the largest.
density, v = (numpy.load(n + ".npy") for n in ("density", "v"))
assert pixels.shape == (7, 5, 4, 4) and kind == "<f2", pixels.shape
expected = numpy.concatenate([v, density[..., None]], -1)[:, ::-1]
assert numpy.abs(pixels - expected).max() < 2 / 2048
assert numpy.abs(pixels - expected).max() > 0
""", "ac.dds")
    innermap("export", "g.vdb", "-o", "c.dds", "--grids", "v", "--power-of-two")
    independent(DDS + """
assert pixels.shape == (4, 8, 8, 4) and (pixels[..., 3] == 1).all(), pixels.shape
""", "c.dds")
    fails(1, "export", "g.vdb", "-o", "a.dds", says=["5", "--grids"])


cli.run(globals())
