#!/usr/bin/env python3
"""Every command writes the same bytes, whatever the number of threads."""

import os

import cli
from cli import innermap
from scenes import around, dent, kinked, unrolled_ring, write_png

# Each from the inputs and what those before it wrote: a kink at which charges are refined, a dent that
# folds, a texture that meets itself along seams.
JOBS = [
    "fit ball.obj kinked.obj -o m.ply --tolerance 3e-4 --interpolation linear",
    "map ball.obj kinked.obj -o out --charges 400 --resolution 32",
    "voxelize ball.obj -o in.vdb --resolution 40 --fog",
    "slice in.vdb -o s.exr --picture s.png",
    "export in.vdb -o texture.exr --resolution 50",
    "push m.ply in.vdb -o pushed.vdb --density",
    "push m.ply small.obj -o moved.obj",
    "pull m.ply pushed.vdb -o back.vdb",
    "transfer-distance m.ply -o distances --resolution 24",
    "check two.obj --outer outer.ply --surface-resolution 16",
    "correspond small.obj egg.obj -o laid.ply --candidates 1 --picture laid.png",
    "correspond torus.obj fat.obj -o around.ply",
    "hexahedralize small.obj -o hexahedra.vtu --blocks 3 --pieces 1",
    "texture ring.obj image.png -o uv.vdb --resolution 24 --seams blend",
    "texture ring.obj image.png -o colour.vdb --resolution 24 --mode colour",
    "tetrahedralize ball.obj -o cells.vtu --resolution 12",
    "fit ball.obj dented.obj -o fold.ply --charges 600",
    "remesh fold.ply cells.vtu -o carried.vtu",
]


def contents():
    """The bytes of each file, but for reports, which have times."""
    files = [os.path.join(folder, name) for folder, _, names in os.walk(".") for name in names]
    found = {}
    for path in files:
        found[path] = cli.read_file(path)
    return {path: data for path, data in found.items() if not path.endswith(".json")}


def test_all_commands_write_the_same():
    vertices, faces = cli.icosphere_arrays(4)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("kinked.obj", [kinked(p) for p in vertices], faces)
    cli.write_obj("dented.obj", [dent(p) for p in vertices], faces)
    cli.write_obj("two.obj", vertices + [(x + 1, y, z) for x, y, z in vertices],
                  faces + [tuple(v + len(vertices) for v in f) for f in faces])
    cli.icosphere("small.obj")
    cli.torus("torus.obj", 24, 12)
    cli.torus("fat.obj", 40, 18, 1.5, 0.4)
    unrolled_ring(n=24, m=12)
    write_png("image.png", (64, 32), around)
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("egg.obj", [(1.2 * x, 0.9 * y, z + 0.3 * x * x) for x, y, z in vertices], faces)
    seen = {}
    for job in JOBS:
        for threads in (1, 3):
            innermap(*job.split(), "--threads", threads, "--quiet")
            seen[threads] = contents()
        assert seen[1].keys() == seen[3].keys(), job
        different = [path for path in seen[1] if seen[1][path] != seen[3][path]]
        assert not different, (job, different)


cli.run(globals())
