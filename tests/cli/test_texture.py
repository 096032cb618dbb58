#!/usr/bin/env python3
"""innermap texture: solids whose continued texture is known, seams, images, and bad input.

Grids are read by pyopenvdb; what needs it is skipped where it is not installed.
"""

import json
import math
import os

import cli
from cli import MODELS, fails, icosphere_arrays, innermap, no_leftovers
from scenes import MAJOR, MINOR, around, unrolled_ring, write_mesh, write_png


# Prints, for each active voxel of a grid inside the solid or not: place, value, signed distance.
READER = """
import sys, json, pyopenvdb
path, name = sys.argv[1:3]
grid, surface = pyopenvdb.read(path, name), pyopenvdb.read(path, "surface")
distance = surface.getConstAccessor()
for item in grid.citerOnValues():
    for x in range(item.min[0], item.max[0] + 1):
        for y in range(item.min[1], item.max[1] + 1):
            for z in range(item.min[2], item.max[2] + 1):
                place = grid.transform.indexToWorld((x, y, z))
                print(json.dumps([place, item.value, distance.getValue((x, y, z))]))
"""


def voxels(path, name):
    """[(place, value, signed distance)] of a grid's active voxels."""
    return [json.loads(line) for line in cli.independent(READER, path, name).splitlines()]


def linear(encoded):
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def planar_ball(path="ball.obj", subdivisions=3, bare=()):
    """A ball of radius 1 whose coordinates are those of space: u = (x + 1) / 2, v = (y + 1) / 2."""
    vertices, faces = icosphere_arrays(subdivisions)
    uvs = [((x + 1) / 2, (y + 1) / 2) for x, y, _ in vertices]
    return write_mesh(path, vertices, faces, uvs,
                      [None if i in bare else f for i, f in enumerate(faces)])


def ramp(u, v):
    return u, v, 0.25


def texture(*arguments, **options):
    innermap("texture", *arguments, "--report", "r.json", **options)
    return cli.read_json("r.json")


def test_linear_coordinates_stay_linear_inside():
    planar_ball()
    write_png("ramp.png", (64, 64), ramp)
    report = texture("ball.obj", "ramp.png", "-o", "t.vdb", "--resolution", "32")
    assert report["seams"]["edges"] == 0 and report["seams"]["charts"] == 1
    assert report["seams"]["voxel_share"] == 0
    assert report["surface"]["fit_error_max"] < 1e-4
    assert report["texture"]["colour_space"] == "sRGB"
    assert os.listdir(".").count("t.vdb") == 1
    voxel = report["grid"]["voxel_size"]
    found = voxels("t.vdb", "uv")
    assert len(found) == report["grid"]["active_voxels"]
    inside = 0
    for place, value, distance in found:
        assert distance <= 2.001 * voxel and value[2] == 0
        p = place
        if distance >= 0:  # the closest point of a ball, but for its facets
            length = math.sqrt(sum(x * x for x in place))
            p = [x / length for x in place]
        else:
            inside += 1
        allowed = 1e-4 if distance < 0 else 0.02
        assert abs(value[0] - (p[0] + 1) / 2) < allowed, (place, value, distance)
        assert abs(value[1] - (p[1] + 1) / 2) < allowed, (place, value, distance)
    assert inside == report["grid"]["interior_voxels"] > 10000
    for place, value, distance in voxels("t.vdb", "Cd"):
        if distance < -voxel:
            u, v = (place[0] + 1) / 2, (place[1] + 1) / 2
            assert abs(value[0] - linear(u)) < 0.02, (place, value)
            assert abs(value[1] - linear(v)) < 0.02, (place, value)
            assert abs(value[2] - linear(0.25)) < 0.01, (place, value)


def test_colours_continued_are_harmonic():
    """Linear colours on the surface of a ball that are linear in space stay so inside."""
    planar_ball()
    write_png("ramp.png", (64, 64), ramp)
    for mode in ["colour", "color"]:
        report = texture("ball.obj", "ramp.png", "-o", "t.vdb", "--resolution", "32", "--mode",
                         mode, "--colour-space", "linear", "--wrap", "clamp")
    assert report["surface"]["fit_error_max"] < 0.03
    for place, value, distance in voxels("t.vdb", "Cd"):
        if distance < 0:  # eight bits are steps of 0.004
            assert abs(value[0] - (place[0] + 1) / 2) < 0.015, (place, value, distance)
            assert abs(value[1] - (place[1] + 1) / 2) < 0.015, (place, value, distance)
            assert abs(value[2] - 0.25) < 0.005, (place, value, distance)
    assert {"Cd", "uv", "surface", "density"} <= set(
        word.strip(":") for word in innermap("info", "t.vdb").stdout.split())


def test_a_seam_is_told_and_no_mode_mixes_its_sides_at_the_surface():
    unrolled_ring()
    write_png("around.png", (256, 128), around)
    length = 2 * math.pi * MINOR + 2 * math.pi * (MAJOR + MINOR)
    errors = {}
    for way in [["--mode", "uv"], ["--mode", "uv", "--seams", "blend"], ["--mode", "colour"]]:
        report = texture("ring.obj", "around.png", "-o", "t.vdb", "--resolution", "64", *way)
        seams = report["seams"]
        assert seams["charts"] == 1 and seams["edges"] == 64 + 32
        assert abs(seams["length"] / length - 1) < 0.01
        assert 0.01 < seams["voxel_share"] < 0.2
        # Strips of two voxels on each side.
        strip = 4 * report["grid"]["voxel_size"] * length / (4 * math.pi ** 2 * MAJOR * MINOR)
        assert abs(seams["area_share"] / strip - 1) < 0.15, (seams, strip)
        assert seams["colour_difference_max"] < 0.05
        errors[way[-1]] = report["surface"]
        if way[-1] == "blend":
            assert 2 <= seams["pieces"] <= 8 and seams["groups"] == seams["pieces"]
    assert errors["blend"]["colour_error_at_seams_p99"] < 0.08, errors
    assert errors["colour"]["colour_error_at_seams_max"] < 0.015, errors
    # Below the seam, coordinates kept as they are sweep through the image.
    assert errors["uv"]["colour_error_at_seams_rms"] > \
        2 * errors["blend"]["colour_error_at_seams_rms"], errors


def test_blended_charts_are_their_colours_in_the_depth_too():
    """Two halves of a ball with the same colour from different places of the image: any mixture of
    charts is that colour, but coordinates between the charts are not."""
    vertices, faces = icosphere_arrays(3)
    uvs, uv_faces = [], []
    for face in faces:
        upper = sum(vertices[i][2] for i in face) > 0
        uv_faces.append(tuple(range(len(uvs), len(uvs) + 3)))
        uvs += [(0.05 + 0.1 * (vertices[i][0] + 1) / 2 + (0.8 if upper else 0),
                 0.5 + 0.2 * vertices[i][1]) for i in face]
    write_mesh("ball.obj", vertices, faces, uvs, uv_faces)
    write_png("ends.png", (64, 16), lambda u, v: (1, 0, 0) if u < 0.25 or u > 0.75 else (0, 0, 1))
    texture("ball.obj", "ends.png", "-o", "blend.vdb", "--resolution", "32", "--seams", "blend")
    for place, value, distance in voxels("blend.vdb", "Cd"):
        assert abs(value[0] - 1) < 1e-3 and value[2] < 1e-3, (place, value, distance)
    texture("ball.obj", "ends.png", "-o", "keep.vdb", "--resolution", "32")
    assert any(value[2] > 0.9 for _, value, _ in voxels("keep.vdb", "Cd"))


def test_vertex_colours_are_continued():
    vertices, faces = icosphere_arrays(3)
    with open("ball.obj", "w", encoding="ascii") as file:
        for x, y, z in vertices:
            file.write(f"v {x:.9g} {y:.9g} {z:.9g} {(x + 1) / 2:.9g} {(y + 1) / 2:.9g} 0.5\n")
        for f in faces:
            file.write("f " + " ".join(str(i + 1) for i in f) + "\n")
    texture("ball.obj", "-o", "t.vdb", "--resolution", "32")
    info = innermap("info", "t.vdb", "--metadata").stdout
    assert "Cd: vec3s" in info and "uv" not in info
    for place, value, distance in voxels("t.vdb", "Cd"):
        if distance < 0:
            assert abs(value[0] - (place[0] + 1) / 2) < 1e-3, (place, value)
            assert abs(value[2] - 0.5) < 1e-5, (place, value)
    texture("ball.obj", "-o", "s.vdb", "--resolution", "16", "--colour-space", "srgb")
    assert all(abs(v[2] - linear(0.5)) < 1e-4 for _, v, _ in voxels("s.vdb", "Cd"))
    fails(2, "texture", "ball.obj", "-o", "x.vdb", "--seams", "blend", says=["IMAGE"])


def test_faces_without_coordinates_and_caps_take_the_nearest():
    planar_ball(bare=range(0, 40))
    write_png("ramp.png", (64, 64), ramp)
    report = texture("ball.obj", "ramp.png", "-o", "t.vdb", "--resolution", "24")
    assert report["notes"] or report["warnings"], report
    vertices, faces = icosphere_arrays(3)
    uvs = [((x + 1) / 2, (y + 1) / 2) for x, y, _ in vertices]
    faces = [f for f in faces if min(vertices[i][2] for i in f) < 0.9]  # a hole, capped
    write_mesh("open.obj", vertices, faces, uvs, faces)
    texture("open.obj", "ramp.png", "-o", "o.vdb", "--resolution", "24")
    for place, value, _ in voxels("o.vdb", "uv"):
        assert -0.01 < value[0] < 1.01 and -0.01 < value[1] < 1.01, (place, value)


def test_wrap_names_and_metadata():
    vertices, faces = icosphere_arrays(2)
    uvs = [(3 + (x + 1) / 2, (y + 1) / 2 - 5) for x, y, _ in vertices]
    write_mesh("ball.obj", vertices, faces, uvs, faces)
    write_png("ramp.png", (32, 32), lambda u, v: (0.2 + 0.6 * u, 0.5, 0.5))
    means = {}
    for wrap in ["repeat", "clamp", "black", "mirror"]:
        texture("ball.obj", "ramp.png", "-o", "t.vdb", "--resolution", "16", "--wrap", wrap,
                "--names", "blender")
        info = innermap("info", "t.vdb", "--metadata").stdout
        assert "color: vec3s" in info and "Cd" not in info
        for key in ["innermap_texture", "innermap_texture_mode", "innermap_sources"]:
            assert key in info, info
        if not means:
            voxels("t.vdb", "color")  # skips where the reader is missing
        reds = [value[0] for _, value, _ in voxels("t.vdb", "color")]
        means[wrap] = sum(reds) / len(reds)
    assert means["black"] == 0
    assert abs(means["clamp"] - linear(0.2 + 0.6 * 31.5 / 32)) < 0.02, means
    assert abs(means["repeat"] - means["mirror"]) < 0.02, means  # u of 3 to 4: turned round
    assert 0.15 < means["repeat"] < 0.35, means


def test_udim_tiles():
    vertices, faces = icosphere_arrays(2)
    uvs, uv_faces = [], []
    for face in faces:  # the upper half in tile 1002, the lower in 1011
        upper = sum(vertices[i][2] for i in face) > 0
        uv_faces.append(tuple(range(len(uvs), len(uvs) + 3)))
        uvs += [((x + 1) / 2 * 0.9 + 0.05 + upper, (y + 1) / 2 * 0.9 + 0.05 + (not upper))
                for x, y, _ in (vertices[i] for i in face)]
    write_mesh("ball.obj", vertices, faces, uvs, uv_faces)
    write_png("skin.1002.png", (16, 16), lambda u, v: (1, 0, 0))
    fails(1, "texture", "ball.obj", "skin.<UDIM>.png", "-o", "t.vdb", says=["skin.1011.png"])
    write_png("skin.1011.png", (16, 16), lambda u, v: (0, 0, 1))
    report = texture("ball.obj", "skin.<UDIM>.png", "-o", "t.vdb", "--resolution", "16", "--seams",
                     "blend")
    assert report["texture"]["image_tiles"] == 2
    for (_, _, z), value, distance in voxels("t.vdb", "Cd"):
        assert abs(value[0] + value[2] - 1) < 1e-3 and value[1] < 1e-3
        if abs(z) > 0.3 and distance > 0:
            assert value[0 if z > 0 else 2] > 0.99, (z, value)


def test_images_that_are_none():
    """Other bad files: the unit test ImageFile.BadFiles."""
    planar_ball()
    cli.write_file("lying.ppm", b"P6\n2000000000 2000000000\n255\n" + bytes(99))
    for name in ("lying.ppm", "ball.obj", "missing.png"):
        fails(1, "texture", "ball.obj", name, "-o", "t.vdb", says=[name], timeout=60)


def test_meshes_that_have_no_texture():
    write_png("good.png", (16, 16), ramp)
    cli.icosphere("bare.obj")
    fails(1, "texture", "bare.obj", "good.png", "-o", "t.vdb",
          says=["bare.obj"])
    fails(1, "texture", "bare.obj", "-o", "t.vdb", says=["bare.obj"])
    vertices, faces = icosphere_arrays(1)
    write_mesh("far.obj", vertices, faces, [(1e30 * x, y) for x, y, _ in vertices], faces)
    fails(1, "texture", "far.obj", "good.png", "-o", "t.vdb", says=["far.obj"])
    fails(1, "texture", "missing.obj", "good.png", "-o", "t.vdb", says=["missing.obj"])


def test_options_that_make_no_sense():
    planar_ball(subdivisions=1)
    write_png("good.png", (16, 16), ramp)
    for arguments, says in [(["--seams", "blend", "--mode", "colour"], ["--seams blend"]),
                            (["--mode", "rgb"], ["--mode"]), (["--wrap", "tile"], ["--wrap"]),
                            (["--colour-space", "aces"], ["--colour-space"])]:
        fails(2, "texture", "ball.obj", "good.png", "-o", "t.vdb", *arguments, says=says)
    fails(1, "texture", "ball.obj", "good.png", "-o", "t.vdb", "--charges", "3", says=["--charges"])
    fails(1, "texture", "ball.obj", "good.png", "-o", "no/t.vdb", says=["no/t.vdb"])
    fails(1, "texture", "ball.obj", "good.png", "-o", "t.vdb", "--max-memory", "5M", says=["5 MB"])
    text = innermap("texture", "ball.obj", "good.png", "-o", "t.vdb", "--dry-run").stdout
    assert "t.vdb" in text
    no_leftovers("ball.obj", "good.png")


def test_spot_shows_no_seam_in_colour_mode():
    mesh, image = MODELS / "spot.obj", MODELS / "spot_texture.png"
    if not mesh.exists():
        raise cli.Skip("shared/models is not there")
    report = texture(mesh, image, "-o", "spot.vdb", "--mode", "colour", "--resolution", "96")
    seams, surface = report["seams"], report["surface"]
    assert seams["charts"] == 13 and abs(seams["length"] - 12.97) < 0.01
    # Within two voxels of the seams the surface is met as well as elsewhere.
    assert surface["colour_error_at_seams_rms"] < 1.2 * surface["colour_error_rms"], surface
    assert surface["colour_error_at_seams_p99"] < 1.2 * surface["colour_error_p99"], surface
    assert surface["colour_error_rms"] < 0.06, surface
    for axis in "xyz":
        innermap("slice", "spot.vdb", "--picture", f"{axis}.png", "--colour", "--axis", axis)
        with open(f"{axis}.png", "rb") as file:
            assert file.read(8) == b"\x89PNG\r\n\x1a\n"


cli.run(globals())
