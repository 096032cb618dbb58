"""Arrays, volume textures, textures, level sets, distances and studies: as the program has them."""

import csv

import numpy as np

import cli
import innermap
import shapes


def test_keeps_arrays_in_a_vdb_file():
    generator = np.random.default_rng(1)
    matrix = np.diag([0.5, 0.5, 0.5, 1])
    matrix[:3, 3] = 1, 2, 3
    arrays = {"smoke": generator.random((5, 6, 7)).astype(np.float32) + 1,
              "wind": generator.normal(size=(5, 6, 7, 3)).astype(np.float32),
              "label": generator.integers(1, 9, (5, 6, 7)).astype(np.int32)}
    for array in arrays.values():
        array.flags.writeable = False  # as of files that are mapped into memory
    grids = innermap.grids(arrays, matrix, fogs="smoke")
    grids.write_vdb("arrays.vdb")
    again = innermap.read_vdb("arrays.vdb")
    assert np.array_equal(again.matrix, matrix) and again.shape == (5, 6, 7)
    for name, array in arrays.items():
        assert again[name].dtype == array.dtype and np.array_equal(again[name], array), name
    assert "fog volume" in cli.innermap("info", "arrays.vdb").stdout
    assert list(innermap.read_vdb("arrays.vdb", names=["wind"])) == ["wind"]
    unsigned = np.full((2, 2, 2), 2 ** 32 - 1, np.uint32)
    assert (innermap.grids({"a": unsigned}, matrix)["a"] == 2 ** 32 - 1).all()
    shapes.refuses(
        (lambda: innermap.grids(arrays, matrix, background="no number"), TypeError, "background"),
        (lambda: innermap.grids(arrays, matrix, background=[1, 2]), TypeError, "background"),
        (lambda: innermap.grids(arrays, matrix, background=1e20), ValueError, "background"),
        (lambda: innermap.grids({"a": unsigned.astype(np.uint64)}, matrix), TypeError, "uint64"),
        (lambda: innermap.voxelize(*shapes.ball(2), max_memory="1MB"), MemoryError, "1 MB"))
    # Every second slice of a larger array, and one in Fortran's order.
    wide = generator.random((6, 8, 10))
    for array in (wide[::2], np.asfortranarray(wide)):
        assert np.array_equal(innermap.grids({"a": array}, matrix, background=-1)["a"], array)


def test_goes_through_volume_textures_and_back():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    grids = m.evaluate(resolution=24)
    for layout, path in (("atlas", "atlas.exr"), ("parts", "parts.exr"),
                         ("slices", "slice.####.exr")):
        made = innermap.write_volume_texture(path, grids, layout=layout)
        assert made["resolution"] == grids.shape
        again = innermap.read_volume_texture(path)
        assert np.allclose(again.matrix, grids.matrix)
        assert again.totals["layout"] == layout
        for name in ("density", "map"):
            assert np.array_equal(again[name], grids[name]), (layout, name)
    m.write_vdb("map.vdb", resolution=24)
    cli.innermap("export", "map.vdb", "-o", "program.exr", "--axis", "z")
    assert np.array_equal(innermap.read_volume_texture("program.exr")["map"],
                          innermap.read_volume_texture("atlas.exr")["map"])
    cli.innermap("import", "atlas.exr", "-o", "back.vdb")
    assert np.array_equal(innermap.read_vdb("back.vdb")["density"],
                          innermap.read_volume_texture("atlas.exr")["density"])


def test_voxelizes_as_the_program_does():
    V, F = shapes.ball(3)
    innermap.write_mesh("ball.obj", V, F)
    grids = innermap.voxelize(V, F, resolution=32, fog=True)
    cli.innermap("voxelize", "ball.obj", "-o", "program.vdb", "--resolution", "32", "--fog")
    program = innermap.read_vdb("program.vdb")
    for name in ("surface", "density"):
        assert np.array_equal(grids[name], program[name])
    size = grids.voxel_size
    assert abs(grids["density"].sum() * size ** 3 / grids.totals["mesh_volume"] - 1) < 1e-2


def test_cuts_and_draws():
    V, F = shapes.ball(3)
    grids = innermap.voxelize(V, F, resolution=24, fog=True)
    made = innermap.write_slices("slices.exr", grids, slices=4, axis="x")
    assert made["slices"] == 4
    assert "density.V" in cli.innermap("info", "slices.exr").stdout
    shown = innermap.write_section("section.png", grids, grid="density", range=(0, 1))
    assert shown["grid"] == "density" and abs(shown["position"]) < 0.1
    assert open("section.png", "rb").read(4) == b"\x89PNG"


def test_transfers_the_distance():
    V, F = shapes.ball(3)
    m = innermap.fit(V, F, 2 * V, **shapes.FEW)
    source, target = innermap.transfer_distance(m, resolution=32)
    assert list(source) == ["surface", "distance", "source_distance"]
    inside = source["surface"] < -source.voxel_size
    assert np.abs(source["distance"] - 2 * source["source_distance"])[inside].max() < 0.02
    assert abs(target["distance"].max() - 2) < 0.15


def test_continues_vertex_colours():
    V, F = shapes.ball(3)
    colours = 0.5 + 0.5 * V
    grids = innermap.solid_texture((V, F), colours=colours, resolution=24, charges=400)
    places = np.argwhere(grids["surface"] < -grids.voxel_size)
    found = grids["Cd"][tuple(places.T)]
    world = places @ grids.matrix[:3, :3].T + grids.matrix[:3, 3]
    assert np.abs(found - (0.5 + 0.5 * world)).max() < 0.01  # linear colours are harmonic
    assert grids.totals["fit_error"].p99 < 0.01


def test_continues_an_image_as_the_program_does():
    V, F = shapes.ball(3)
    with open("uv.obj", "w") as file:
        for v in V:
            file.write("v %.9g %.9g %.9g\nvt %.9g %.9g\n" % (*v, *(0.5 + 0.4 * v[:2])))
        for f in F + 1:
            file.write("f %d/%d %d/%d %d/%d\n" % tuple(np.repeat(f, 2)))
    cli.write_file("image.ppm", b"P6 4 4 255\n" + bytes(range(48)))
    grids = innermap.solid_texture("uv.obj", "image.ppm", resolution=20, charges=300)
    cli.innermap("texture", "uv.obj", "image.ppm", "-o", "program.vdb", "--resolution", "20",
                 "--charges", "300")
    program = innermap.read_vdb("program.vdb")
    assert list(grids) == list(program)
    assert np.array_equal(grids["Cd"], program["Cd"])


def test_studies_as_the_program_does():
    V, F = shapes.ball(2)
    W = shapes.twisted(V)
    innermap.write_mesh("rest.obj", V, F)
    innermap.write_mesh("pose.obj", W, F)
    table, findings = innermap.study(V, F, W, charges=[50, 100], points=[3], distances=[0.1],
                                     radius_ratios=[], base_charges=50, base_distance=0.1,
                                     grid="none", resolution=16, folder="kept")
    cli.innermap("study", "rest.obj", "pose.obj", "-o", "program", "--charges", "50,100",
                 "--points", "3", "--distances", "0.1", "--radius-ratios", "none",
                 "--base-charges", "50", "--base-distance", "0.1", "--grid", "none",
                 "--resolution", "16")
    rows = list(csv.DictReader(open("program/study.csv")))
    assert len(rows) == len(table["rms"]) > 1
    for name in ("sources", "points", "c_error", "rms", "p99", "harmonic_energy", "folded"):
        assert np.allclose(table[name], [float(r[name]) for r in rows], rtol=1e-4, atol=1e-9), name
    assert findings["statements"] and "--charges" in findings["best"]


if __name__ == "__main__":
    cli.run(globals())
