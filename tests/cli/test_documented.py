#!/usr/bin/env python3
"""The commands of README.md and docs/ as they stand there: each is accepted and runs, with small
stand-ins for the files that it names."""

import gzip
import re
import shlex
import shutil
import struct
from pathlib import Path

import cli
from cli import ROOT, innermap, nightly
from scenes import write_splats

BLOCK = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
LONG = {"study", "compare-fem", "hexahedralize", "harmonic"}  # have tests of their own
GENERATED = {"commands.md", "benchmarks.md"}
TASKS = {"recipes.md", "tutorial.md"}  # whole, in test_recipes.py


def documented():
    """(page, arguments) of each command, without those that stand for any (SOURCE, FOLDER)."""
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        if page.name in GENERATED | TASKS:
            continue
        for block in BLOCK.findall(page.read_text(encoding="utf-8")):
            for line in block.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                if words[:1] == ["innermap"] and not any(w.isupper() for w in words):
                    yield page.name, words[1:]


def write_ball(path, groups=(), bend=0.0, thin=1.0):
    """A ball with texture coordinates, its faces in groups along z."""
    vertices, faces = cli.icosphere_arrays(3)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        for x, y, z in vertices:
            file.write(f"v {thin * (x + bend * z * z)} {thin * y} {z}\nvt {(x + 1) / 2} {(z + 1) / 2}\n")
        by_group = {}
        for face in faces:
            z = sum(vertices[v][2] for v in face) / 3
            name = groups[min(len(groups) - 1, int((z + 1) / 2 * len(groups)))] if groups else "all"
            by_group.setdefault(name, []).append(face)
        for name, some in by_group.items():
            file.write(f"g {name}\n")
            for face in some:
                file.write("f " + " ".join(f"{v + 1}/{v + 1}" for v in face) + "\n")


def write_scan(path):
    """Points with a velocity."""
    vertices = cli.icosphere_arrays(1)[0]
    names = ["x", "y", "z", "velocity_x", "velocity_y", "velocity_z"]
    rows = [f"{0.3 * x} {0.3 * y} {0.3 * z} {y} {z} {x}" for x, y, z in vertices]
    Path(path).write_text("\n".join(
        ["ply", "format ascii 1.0", f"element vertex {len(rows)}",
         *(f"property float {name}" for name in names), "end_header", *rows, ""]))


def write_muscle(path):
    """A tetrahedron with fibres."""
    Path(path).write_text("""<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 0.3 0 0 0 0.3 0 0 0 0.3</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>
<CellData><DataArray type="Float64" Name="fibre" NumberOfComponents="3" format="ascii">0 0 1</DataArray>
</CellData></Piece></UnstructuredGrid></VTKFile>
""")


def write_labels(path):
    """A scan of 8 x 8 x 8 voxels, two cubes of which are the organs 2 and 5; by NIfTI-1's header."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 8, 8, 8, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 2, 8)  # bytes
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<3f", header, 108, 352, 1, 0)
    struct.pack_into("<h", header, 254, 1)
    struct.pack_into("<12f", header, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
    header[344:348] = b"n+1\0"
    voxels = [2 if x < 4 else 5 if x > 4 and y > 2 else 0 for z in range(8) for y in range(8) for x in range(8)]
    Path(path).write_bytes(gzip.compress(bytes(header) + bytes(voxels)))


def stand_ins(whole):
    Path("samples").symlink_to(ROOT / "samples")
    for path in ["homer.obj", "spot.obj"]:
        write_ball(path, thin=0.3)
    for path in ["rest.obj", "cow.obj", "horse-poses/reference.obj", "horse-gallop/reference.obj"]:
        write_ball(path)
    for path in ["pose.obj", "man.obj", "bent.obj", "horse-poses/pose-02.obj"]:
        write_ball(path, bend=0.1)
    for number in (1, 2):
        for path in ["frames/f.{}.obj", "walk.{}.obj", "horse-gallop/frame.{}.obj"]:
            write_ball(path.format(number), bend=0.05 * number)
    write_ball("heart.obj", ["endo", "epi"])
    write_ball("body.obj", ["head", "arms", "legs"])
    vertices, faces = cli.icosphere_arrays(1)
    for path in ["bones.obj", "posed.obj", "hair.obj"]:
        cli.write_obj(path, [(0.3 * x, 0.3 * y, 0.3 * z) for x, y, z in vertices], faces)
    innermap("deform", "rest.obj", "rest.obj", "walk.*.obj", "-o", "walk.pc2", "--charges", "100")
    innermap("fit", "rest.obj", "pose.obj", "-o", "map.ply")
    Path("homer_spot").mkdir()
    innermap("fit", "homer.obj", "spot.obj", "-o", "homer_spot/map.ply")
    innermap("correspond", "cow.obj", "man.obj", "-o", "cow_on_man.ply", "--surface-resolution", "16",
             "--picture", "spot_texture.png")
    write_scan("scan.ply")
    write_muscle("muscle.vtu")
    for path in ["capture.ply", "mist.ply", "posed.ply"]:
        write_splats(path, [{"x": 0.3, "scale_0": -3, "rot_0": 1}])
    innermap("evaluate", "map.ply", "-o", "smoke.vdb", "--resolution", "24")
    shutil.copy("smoke.vdb", "posed.vdb")
    innermap("export", "smoke.vdb", "-o", "scan.nii.gz", "--grids", "density")
    innermap("import", "scan.nii.gz", "-o", "scan.vdb")
    write_labels("labels.nii.gz")
    shutil.copy("scan.vdb", "posed_scan.vdb")
    Path("out").mkdir()
    shutil.copy("smoke.vdb", "out/smoke.0001.vdb")
    innermap("texture", "spot.obj", "spot_texture.png", "-o", "spot.vdb", "--resolution", "16")
    innermap("export", "smoke.vdb", "-o", "smoke.exr", "--grids", "density", "--resolution", "16", "--cube")
    innermap("tetrahedralize", "homer.obj", "-o", "homer.vtu", "--resolution", "12")
    innermap("remesh", "homer_spot/map.ply", "homer.vtu", "-o", "spot.vtu")
    innermap("map", "rest.obj", "pose.obj", "-o", "out", "--resolution", "16")
    # To join: as docs/farm.md calls it, or the parts would be another run's.
    innermap("sequence", "rest.obj", "frames/*.obj", "-o", "energies", "--share", "1/1")
    # Otherwise the page's own commands make it, larger.
    if not whole:
        innermap("evaluate", "map.ply", "-o", "map.vdb", "--resolution", "24", "--share", "1/1")


def each_command(whole):
    stand_ins(whole)
    commands = list(documented())
    assert len(commands) > 35, len(commands)
    for page, words in commands:
        try:
            said = innermap(*words, "--dry-run").stdout
            if whole and words[0] not in LONG:
                innermap(*words)
        except AssertionError as error:
            raise AssertionError(f"{page}: innermap {' '.join(words)}: {error}") from error
        assert said.strip(), (page, words)


def test_commands_of_the_pages_are_accepted():
    each_command(whole=False)


@nightly
def test_commands_of_the_pages_run():
    each_command(whole=True)


cli.run(globals())
