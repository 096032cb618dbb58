"""What tests/faults/run runs: every command that writes, on small inputs."""

import shutil
import struct
import sys
import zlib
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "cli"))
import cli  # pylint: disable=wrong-import-position

# Arguments, with I/ for the inputs and O/ for where outputs go.
COMMANDS = {
    "map": ["map", "I/ball.obj", "I/egg.obj", "-o", "O/out", "--resolution", "16"],
    "map-strangers": ["map", "I/ball.obj", "I/cube.obj", "-o", "O/out", "--resolution", "12",
                      "--charges", "300"],
    "fit": ["fit", "I/ball.obj", "I/egg.obj", "-o", "O/m.ply", "--charges", "300", "--best-effort",
            "--report", "O/r.json"],
    "evaluate": ["evaluate", "I/map.ply", "-o", "O/m.vdb", "--resolution", "30"],
    "correspond": ["correspond", "I/round.obj", "I/oval.obj", "-o", "O/c.ply", "--picture",
                   "O/c.png"],
    "sphere": ["sphere", "I/ball.obj", "-o", "O/s.ply"],
    "sequence": ["sequence", "I/ball.obj", "I/frames", "-o", "O/q", "--resolution", "16",
                 "--charges", "200"],
    "sequence-grids": ["sequence", "I/ball.obj", "I/frames", "-o", "O/q", "--resolution", "12",
                       "--charges", "200", "--grids"],
    "deform": ["deform", "I/ball.obj", "I/small.obj", "I/frames", "-o", "O/f/b.####.obj",
               "--charges", "200"],
    "deform-grids": ["deform", "I/ball.obj", "I/small.vdb", "I/frames", "-o", "O/f/b.####.vdb",
                     "--charges", "200", "--resolution", "20"],
    "texture": ["texture", "I/ball.ply", "-o", "O/t.vdb", "--resolution", "24"],
    "texture-image": ["texture", "I/quad.obj", "I/image.png", "-o", "O/t.vdb", "--resolution",
                      "24"],
    "push": ["push", "I/map.ply", "I/map.vdb", "-o", "O/p.vdb", "--grids", "density",
             "--resolution", "20"],
    "push-mesh": ["push", "I/map.ply", "I/small.obj", "-o", "O/p.obj"],
    "push-cells": ["push", "I/map.ply", "I/ball.vtu", "-o", "O/p.msh"],
    "pull": ["pull", "I/map.ply", "I/egg.obj", "-o", "O/p.obj"],
    "pull-grids": ["pull", "I/map.ply", "I/small.vdb", "-o", "O/p.vdb", "--resolution", "20"],
    "transfer-distance": ["transfer-distance", "I/map.ply", "-o", "O/d", "--resolution", "20"],
    "check": ["check", "I/ball.obj", "--report", "O/r.json"],
    "voxelize": ["voxelize", "I/ball.obj", "-o", "O/a.vdb", "--resolution", "40", "--fog"],
    "tetrahedralize": ["tetrahedralize", "I/ball.obj", "-o", "O/t.vtu", "--resolution", "8",
                       "--picture", "O/t.png"],
    "polycube": ["polycube", "I/round.obj", "-o", "O/c.obj", "--blocks", "3"],
    "hexahedralize": ["hexahedralize", "I/round.obj", "-o", "O/h.vtu", "--blocks", "3", "--pieces",
                      "1", "--polycube", "O/c.obj", "--in-blocks", "O/b.msh"],
    "remesh": ["remesh", "I/map.ply", "I/ball.vtu", "-o", "O/r.mesh", "--coarse", "0"],
    "compare-fem": ["compare-fem", "I/round.obj", "--functions", "-o", "O/fem", "--resolutions",
                    "6,8", "--charges", "50,100", "--samples", "200"],
    "slice": ["slice", "I/map.vdb", "-o", "O/s.exr", "--picture", "O/s.png"],
    "export": ["export", "I/map.vdb", "-o", "O/e.####.exr", "--layout", "slices", "--grids",
               "jacobian"],
    "export-tiles": ["export", "I/map.vdb", "-o", "O/e.exr", "--grids", "density"],
    "import": ["import", "I/map.exr", "-o", "O/i.vdb"],
    "verify": ["verify", "I/map.ply", "--sample", "4", "--report", "O/r.json"],
    "info": ["info", "I/map.vdb", "--report", "O/r.json"],
    "harmonic": ["harmonic", "I/groups.obj", "-o", "O/h.vdb", "--field", "O/h.ply", "--fix",
                 "top=1,bottom=0", "--resolution", "16", "--tolerance", "0.02", "--best-effort"],
    "weights": ["weights", "I/groups.obj", "-o", "O/w.vdb", "--groups", "top,bottom", "--resolution",
                "12", "--tolerance", "0.1", "--best-effort", "--report", "O/r.json"],
    "study": ["study", "I/round.obj", "I/oval.obj", "-o", "O/study", "--charges", "20,40",
              "--points", "2,3", "--distances", "0.1,0.2", "--radius-ratios", "1.5",
              "--base-charges", "30", "--base-points", "2"],
    "report": ["report", "I/made", "-o", "O/page.html"],
    "map-html": ["map", "I/ball.obj", "I/egg.obj", "-o", "O/out", "--resolution", "12", "--html"],
    "push-html": ["push", "I/map.ply", "I/small.obj", "-o", "O/p.obj", "--html=O/page.html"],
}
# Whose files come together.
FOLDERS = ("map", "map-strangers", "transfer-distance", "sequence", "export", "compare-fem", "study",
           "map-html")
# What a command keeps of its work as it goes on, for the next run.
KEPT = {"study": "study/runs/"}


def write_png(path, size=16):
    rows = b"".join(b"\0" + bytes(v for x in range(size) for v in (16 * x, 16 * y, 99))
                    for y in range(size))

    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2,
                                                                    0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_coloured(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n")
        file.write("".join(f"property double {c}\n" for c in "xyz"))
        file.write("".join(f"property uchar {c}\n" for c in ("red", "green", "blue")))
        file.write(f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        for v in vertices:
            file.write("{} {} {} {} 0 99\n".format(*v, int(100 + 100 * v[0])))
        for f in faces:
            file.write("3 {} {} {}\n".format(*f))


def write_textured(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        for x, y, z in vertices:
            file.write(f"v {x} {y} {z}\nvt {0.5 + 0.4 * x} {0.5 + 0.4 * y}\n")
        for f in faces:
            file.write("f " + " ".join(f"{i + 1}/{i + 1}" for i in f) + "\n")


def write_groups(path, vertices, faces):
    """The caps are groups, between them is the rest."""
    def group(face):
        z = sum(vertices[i][2] for i in face) / 3
        return "top" if z > 0.7 else "bottom" if z < -0.7 else "rest"
    with open(path, "w", encoding="ascii") as file:
        file.write("".join("v {} {} {}\n".format(*v) for v in vertices))
        for name in ("top", "bottom", "rest"):
            file.write(f"g {name}\n")
            file.write("".join("f {} {} {}\n".format(*(i + 1 for i in f)) for f in faces
                               if group(f) == name))


def make_inputs(folder):
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj(folder / "ball.obj", vertices, faces)
    egg = [(1.3 * x, y + 0.1 * x * x, z) for x, y, z in vertices]
    cli.write_obj(folder / "egg.obj", egg, faces)
    cli.write_obj(folder / "small.obj", [tuple(0.5 * c for c in v) for v in vertices], faces)
    coarse, coarse_faces = cli.icosphere_arrays(2)
    cli.write_obj(folder / "round.obj", coarse, coarse_faces)
    cli.write_obj(folder / "oval.obj", [(1.3 * x, y + 0.1 * x * x, z) for x, y, z in coarse],
                  coarse_faces)
    write_groups(folder / "groups.obj", vertices, faces)
    cli.cube(folder / "cube.obj")
    (folder / "frames").mkdir()
    cli.write_obj(folder / "frames/f.0001.obj", egg, faces)
    cli.write_obj(folder / "frames/f.0002.obj", [(x, 1.2 * y, z) for x, y, z in vertices], faces)
    write_coloured(folder / "ball.ply", vertices, faces)
    write_textured(folder / "quad.obj", vertices, faces)
    write_png(folder / "image.png")
    cli.innermap("map", folder / "ball.obj", folder / "egg.obj", "-o", folder / "made",
                 "--resolution", "16", "-q")
    for name in ("map.ply", "map.vdb"):
        shutil.copy(folder / "made" / name, folder / name)
    cli.innermap("export", folder / "map.vdb", "-o", folder / "map.exr", "-q")
    cli.innermap("voxelize", folder / "small.obj", "-o", folder / "small.vdb", "--resolution", "20",
                 "--fog", "-q")
    cli.innermap("tetrahedralize", folder / "ball.obj", "-o", folder / "ball.vtu", "--resolution",
                 "8", "-q")
