#!/usr/bin/env python3
"""export and import of other programs' volume files, as those programs' own readers see them."""

import json
import os
import re
import shutil
import subprocess

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
    return independent(MAKE).split()


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
""", MATRIX, *names)
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


def test_nibabel_reads_values_and_places():
    names = grids()
    for name in names:
        for ending in (".nii", ".nii.gz"):
            innermap("export", "g.vdb", "-o", name + ending, "--grids", name)
        independent("""
import sys, numpy, nibabel
matrix = numpy.array(eval(sys.argv[1]))
matrix = numpy.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [-3, 2, 6, 1]]) @ matrix
for ending in (".nii", ".nii.gz"):
    image = nibabel.load(sys.argv[2] + ending)
    expected = numpy.load(sys.argv[2] + ".npy").astype("f4")
    values = numpy.asanyarray(image.dataobj)
    if values.ndim == 5:
        assert values.shape[3:] == (1, 3) and image.header["intent_code"] == 1007
        values = values[:, :, :, 0]
    assert values.dtype == "f4" and (values == expected).all(), sys.argv[2]
    for affine, code in (image.get_sform(coded=True), image.get_qform(coded=True)):
        assert code == 1 and numpy.abs(affine - matrix.T).max() < 1e-5, (affine, matrix.T)
    assert image.header.get_xyzt_units()[0] == "mm"
""", MATRIX, name)
        innermap("import", name + ".nii.gz", "-o", "back.vdb")
        independent("""
import sys, numpy, pyopenvdb as vdb
grid = vdb.read("back.vdb", sys.argv[1])
expected = numpy.load(sys.argv[1] + ".npy").astype("f4")
values = numpy.zeros_like(expected)
grid.copyToArray(values, ijk=(0, 0, 0))
assert (values == expected).all()
there = vdb.read("g.vdb", sys.argv[1]).transform.indexToWorld((-3 + 1, 2 + 2, 6 + 3))
assert numpy.abs(numpy.subtract(grid.transform.indexToWorld((1, 2, 3)), there)).max() < 1e-5
""", name)
    fails(1, "export", "g.vdb", "-o", "all.nii", says=["3", "--grids", "density"])


# What nibabel writes: FILE, and FILE.npy of x, y, z and the value at each voxel that is not 0.
SCANS = """
import numpy, nibabel
rng = numpy.random.default_rng(3)
turn = numpy.linalg.qr(rng.standard_normal((3, 3)))[0]
affine = numpy.eye(4)
affine[:3, :3] = turn * (1.5, 2, 0.75)
affine[:3, 3] = 12, -40, 7
labels = rng.choice([0, 1, 614454277], (9, 11, 13)).astype("i4")
grey = rng.random((9, 11, 13)) * 100

def save(name, image):
    nibabel.save(image, name)
    values = numpy.asanyarray(nibabel.load(name).dataobj)
    at = numpy.argwhere(values)
    world = nibabel.affines.apply_affine(image.affine, at)
    numpy.save(name, numpy.column_stack([world, at, values[tuple(at.T)]]))

image = nibabel.Nifti1Image(labels, affine)
image.set_sform(affine, 2)
save("labels.nii.gz", image)
image = nibabel.Nifti1Image(labels, None)
image.set_qform(affine, 1)
image.set_sform(None, 0)
save("quaternion.nii", image)
image = nibabel.Nifti2Image(labels.astype(">i4"), affine)
image.header.set_data_dtype(">i4")
save("second.nii", image)
big = nibabel.Nifti1Header(endianness=">")
big.set_data_dtype("f4")
save("big.nii", nibabel.Nifti1Image(grey, affine, big))
image = nibabel.Nifti1Image(grey, affine)
image.header.set_data_dtype("u1")
image.header.set_slope_inter(0.5, -3)
nibabel.save(image, "scaled.nii")
image = nibabel.load("scaled.nii")
save("scaled.nii.gz", image)
lost = nibabel.Nifti1Image(labels, None)
lost.header["pixdim"][1:4] = 2, 3, 4
lost.set_sform(None, 0)
lost.set_qform(None, 0)
nibabel.save(lost, "lost.nii")
nibabel.save(nibabel.Nifti1Image(numpy.zeros((3, 3, 3, 5), "f4"), affine), "time.nii")
nibabel.save(nibabel.Nifti1Image(numpy.zeros((3, 3, 3), "c8"), affine), "complex.nii")
"""

SAME_SCAN = """
import sys, numpy, pyopenvdb as vdb
name, kind, tolerance = sys.argv[1:4]
grid = vdb.readAll("s.vdb")[0][0]
assert grid.valueTypeName == kind, grid.valueTypeName
rows = numpy.load(name + ".npy")
accessor = grid.getConstAccessor()
assert grid.activeVoxelCount() == len(rows), (name, grid.activeVoxelCount(), len(rows))
for x, y, z, i, j, k, value in rows[::7]:
    at = tuple(map(int, (i, j, k)))
    assert abs(accessor.getValue(at) - value) <= float(tolerance), (at, value)
    assert numpy.abs(numpy.subtract(grid.transform.indexToWorld(at), (x, y, z))).max() < 2e-5
"""


def test_scans_are_read_where_they_lie():
    independent(SCANS)
    for name, kind, tolerance in (("big.nii", "float", 1e-5), ("scaled.nii.gz", "float", 1e-5)):
        innermap("import", name, "-o", "s.vdb", "--grids", "scan")
        independent(SAME_SCAN, name, kind, tolerance)
    for name in ("labels.nii.gz", "quaternion.nii", "second.nii"):
        innermap("import", name, "-o", "s.vdb", "--grids", "label", "--report", "r.json")
        assert cli.read_json("r.json")["texture"]["grids"] == ["label"]
        assert "int32" in innermap("info", "s.vdb").stdout
        # pyopenvdb has no whole numbers: nibabel says whether what is written again is the same.
        innermap("export", "s.vdb", "-o", "again.nii")
        independent("""
import sys, numpy, nibabel
image = nibabel.load("again.nii")
values = numpy.asanyarray(image.dataobj)
rows = numpy.load(sys.argv[1] + ".npy")
assert values.dtype.kind == "i" and (values != 0).sum() == len(rows)
first = rows[:, 3:6].min(0)
at = (rows[:, 3:6] - first).astype(int)
assert (values[tuple(at.T)] == rows[:, 6]).all()
assert numpy.abs(nibabel.affines.apply_affine(image.affine, at) - rows[:, :3]).max() < 1e-4
""", name)
    fails(1, "import", "lost.nii", "-o", "l.vdb", says=["lost.nii", "sform", "--as-voxels"])
    innermap("import", "lost.nii", "-o", "l.vdb", "--as-voxels")
    assert "2" in innermap("info", "l.vdb").stdout
    fails(1, "import", "time.nii", "-o", "t.vdb", says=["time.nii", "5 volumes"])
    fails(1, "import", "complex.nii", "-o", "t.vdb", says=["complex.nii", "32"])
    fails(1, "import", "labels.nii.gz", "-o", "t.vdb", "--voxel-size", "2", says=["voxel"])


def usd_of(name, **told):
    """The text of a .usda file, which has the lines `told`, and which the checker of hosts accepts."""
    text = cli.read_file(name).decode()
    assert text.startswith("#usda 1.0\n"), text
    for key, value in told.items():
        assert f"    {key} = {value}\n" in text, (key, text)
    checker = cli.ROOT.parent / "shared" / "hosts" / "usda_check.py"
    if checker.exists():
        subprocess.run([cli.PYTHON, checker, name], check=True, capture_output=True)
    else:
        print("not checked by ../shared/hosts/usda_check.py, which is not there")
    return text


def test_a_displacement_field_leads_back():
    """As ANTs takes it: for each place of the target where to look in the source, LPS."""
    vertices, faces = cli.icosphere_arrays(4)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("bent.obj", [(2 + x + 0.3 * z * z, 1.2 * y, z - 3 + 0.1 * y) for x, y, z in vertices], faces)
    innermap("fit", "ball.obj", "bent.obj", "-o", "map.ply", "--quiet")
    innermap("evaluate", "map.ply", "-o", "back.nii.gz", "--inverse", "--resolution", "48", "--report", "r.json",
             "--quiet")
    assert cli.read_json("r.json")["inverse"]["inverted_fraction"] > 0.999
    independent("""
import nibabel, numpy
image = nibabel.load("back.nii.gz")
values = numpy.asarray(image.dataobj)
assert image.header.get_intent()[0] == "vector" and values.shape[3:] == (1, 3), values.shape
field = values[:, :, :, 0] * [-1, -1, 1]  # LPS to RAS
rng = numpy.random.default_rng(3)
p = rng.normal(size=(1000, 3))
p *= 0.93 * rng.random((1000, 1)) ** (1 / 3) / numpy.linalg.norm(p, axis=1, keepdims=True)
# What the map does to points inside: the program's own word.
numpy.savetxt("points.obj", p, fmt="v %.17g %.17g %.17g")
numpy.save("points.npy", p)
numpy.save("affine.npy", image.affine)
numpy.save("field.npy", field)
""")
    innermap("push", "map.ply", "points.obj", "-o", "images.obj", "--quiet")
    independent("""
import numpy
p, field, affine = (numpy.load(name + ".npy") for name in ("points", "field", "affine"))
q = numpy.array([[float(x) for x in line.split()[1:4]] for line in open("images.obj") if line.startswith("v ")])
assert len(q) == len(p)
i = (numpy.c_[q, numpy.ones(len(q))] @ numpy.linalg.inv(affine).T)[:, :3]
low = numpy.floor(i).astype(int)
t = i - low
back = 0
for k in numpy.ndindex(2, 2, 2):
    weight = numpy.prod(numpy.where(k, t, 1 - t), axis=1)
    back = back + weight[:, None] * field[tuple((low + k).T)]
voxel = numpy.abs(affine[:3, :3]).sum(0).max()
error = numpy.linalg.norm(q + back - p, axis=1).max()
assert error < 0.05 * voxel, (error, voxel)
""")
    fails(2, "evaluate", "map.ply", "-o", "map.nii", says=["--inverse"])
    for option in (["--repair", "off"], ["--lame-mu", "1"], ["--warn-folded", "0.5"]):
        fails(2, "evaluate", "map.ply", "-o", "x.vdb", "--inverse", *option, says=[option[0], "--inverse"])
    assert "time: about" in innermap("evaluate", "map.ply", "-o", "x.vdb", "--inverse", "--dry-run").stdout
    innermap("evaluate", "map.ply", "-o", "back.vdb", "--inverse", "--resolution", "24", "--quiet")
    told = innermap("info", "back.vdb").stdout
    assert "surface" in told and "displacement" in told, told


def test_usd_refers_to_files():
    names = grids()
    innermap("export", "g.vdb", "-o", "a-b.usda", "--up", "z", "--unit-scale", "0.01")
    text = usd_of("a-b.usda", defaultPrim='"a_b"', upAxis='"Z"', metersPerUnit="0.01")
    for name in names:
        assert f"rel field:{name} = </a_b/{name}>" in text and f'fieldName = "{name}"' in text, text
    assert text.count("asset filePath = @./g.vdb@") == len(names) and "TimeCode =" not in text
    # The box of voxels (-3, 2, 6) to (3, 6, 9) by their outer faces.
    corners = [[sum(p * m for p, m in zip((i, j, k, 1), column)) for column in zip(*MATRIX)]
               for i in (-3.5, 3.5) for j in (1.5, 6.5) for k in (5.5, 9.5)]
    box = [tuple(limit(c[a] for c in corners) for a in range(3)) for limit in (min, max)]
    found = re.search(r"extent = \[\((.*)\), \((.*)\)\]", text)
    for corner, numbers in zip(box, found.groups()):
        assert max(abs(a - float(b)) for a, b in zip(corner, numbers.split(","))) < 1e-4, (box, text)
    os.makedirs("frames")
    for number in (9, 10, 12):
        shutil.copy("g.vdb", f"frames/s.{number:04}.vdb")
    innermap("export", "frames/s.####.vdb", "-o", "s.usda", "--grids", "density", "--fps", "25")
    text = usd_of("s.usda", startTimeCode="9", endTimeCode="12", timeCodesPerSecond="25")
    assert "10: @./frames/s.0010.vdb@" in text and "field:v" not in text
    assert len(re.findall(r"@\./frames/", text)) == 3
    fails(1, "export", "g.vdb", "-o", "n.usda", "--grids", "none", says=["none"])


LABELS = """
import sys, numpy, nibabel
# Voxels of 1 x 2 x 3 mm, x mirrored as scanners have it; two boxes, a voxel of a third label.
affine = numpy.diag([-1.0, 2, 3, 1])
affine[:3, 3] = 10, -20, 5
labels = numpy.zeros((20, 16, 12), numpy.uint8)
labels[2:8, 3:9, 2:8] = 2
labels[10:18, 3:13, 2:10] = 5
image = nibabel.Nifti1Image(labels, affine)
nibabel.save(image, "scan.nii.gz")
nibabel.save(nibabel.Nifti1Image(numpy.random.default_rng(1).random((24, 24, 24)).astype("f4"), affine), "grey.nii")
"""


def test_labels_of_a_scan_are_solids():
    independent(LABELS)
    innermap("voxelize", "scan.nii.gz", "-o", "each.vdb", "--each-label", "--fog", "--report", "r.json", "--quiet")
    grids = {g["name"]: g for g in told("each.vdb")["grids"]}
    assert set(grids) == {"surface_2", "density_2", "surface_5", "density_5"}, grids
    for label, size in ((2, (6, 12, 18)), (5, (8, 20, 24))):
        grid = grids[f"surface_{label}"]
        assert grid["class"] == "level set" and grid["metadata"]["innermap_label"] == str(label), grid
        assert abs(grid["voxel_size"][0] - 1) < 1e-6, grid
        # The box with a band of three voxels to each side.
        box = [b - a + 1 for a, b in zip(*grid["box"])]
        assert all(s + 4 <= n <= s + 8 for n, s in zip(box, size)), (box, size)
    innermap("voxelize", "scan.nii.gz", "-o", "five.vdb", "--labels", "5", "--report", "r.json", "--quiet")
    volume = cli.read_json("r.json")["source"]["volume"]
    assert 0.93 < volume / (8 * 20 * 24) <= 1 + 1e-6, volume
    innermap("voxelize", "scan.nii.gz", "-o", "all.vdb", "--voxel-size", "2", "--report", "r.json", "--quiet")
    volume = cli.read_json("r.json")["source"]["volume"]
    assert 0.93 < volume / (8 * 20 * 24 + 6 * 12 * 18) <= 1 + 1e-6, volume
    assert [g["name"] for g in told("all.vdb")["grids"]] == ["surface"]
    assert "2 labels" in innermap("voxelize", "scan.nii.gz", "-o", "x.vdb", "--each-label", "--dry-run").stdout
    fails(1, "voxelize", "scan.nii.gz", "-o", "x.vdb", "--labels", "3", says=["3", "2, 5"])
    fails(2, "voxelize", "scan.nii.gz", "-o", "x.vdb", "--labels", "a", says=["--labels"])
    fails(1, "voxelize", "grey.nii", "-o", "x.vdb", says=["no label"])
    cli.cube()
    fails(2, "voxelize", "cube.obj", "-o", "x.vdb", "--labels", "3", says=["--labels"])


def told(path):
    return json.loads(innermap("info", path, "--json").stdout)


def test_info_of_every_format():
    names = grids()
    innermap("export", "g.vdb", "-o", "g.nvdb")
    innermap("export", "g.vdb", "-o", "g.vti")
    innermap("export", "g.vdb", "-o", "g.usda", "--up", "z")
    innermap("export", "g.vdb", "-o", "g.dds", "--grids", "density", "--half")
    innermap("export", "g.vdb", "-o", "g.nii.gz", "--grids", "density")
    corners = [[sum(p * m for p, m in zip((i, j, k, 1), column)) for column in zip(*MATRIX)]
               for i in (-3.5, 3.5) for j in (1.5, 6.5) for k in (5.5, 9.5)]
    box = [[limit(c[a] for c in corners) for a in range(3)] for limit in (min, max)]
    for file, kind in (("g.nvdb", "NanoVDB"), ("g.vti", "VTK image data"), ("g.nii.gz", "NIfTI"), ("g.dds", "DDS"),
                       ("g.usda", "USD")):
        info = told(file)
        assert info["format"] == kind and info["kind"] == "volume", info
        assert kind in innermap("info", file).stdout
        first = info["grids"][0]
        if kind != "USD":
            assert first["resolution"] == [7, 5, 4], info
        if kind not in ("USD", "DDS"):
            assert sorted(first["voxel_size"]) == [0.25, 0.5, 2], first
        if kind in ("VTK image data", "NIfTI"):
            assert max(abs(a - b) for p, q in zip(first["world_box"], box) for a, b in zip(p, q)) < 1e-4, (first, box)
        if kind in ("NanoVDB", "VTK image data", "USD"):
            assert [g["name"] for g in info["grids"]] == names, info
    assert told("g.nvdb")["grids"][0]["active_voxels"] == 140
    assert told("g.dds")["grids"][0]["type"] == "R16F"
    assert told("g.usda")["grids"][0]["files"] == ["./g.vdb"] and told("g.usda")["upAxis"] == '"Z"'
    for file in ("g.nvdb", "g.vti", "g.dds", "g.nii.gz", "g.usda"):
        content = cli.read_file(file)
        for size in (0, 3, 60, 200, len(content) // 2):
            cli.write_file("cut." + file.split(".", 1)[1], content[:size])
            done = subprocess.run([cli.PROGRAM, "info", "cut." + file.split(".", 1)[1]], capture_output=True,
                                  check=False)
            assert done.returncode in (0, 1), (file, size, done)


cli.run(globals())
