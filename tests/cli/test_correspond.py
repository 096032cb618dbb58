#!/usr/bin/env python3
"""One surface on another: correspond, sphere, and map between meshes that were never related."""

import math
import os
import struct

from cli import (MODELS, Skip, dry_run, fails, icosphere, icosphere_arrays, innermap, nightly, no_leftovers,
                 read_file, read_json, read_obj, run, torus, write_file, write_obj)

TYPES = {"double": ("d", 8), "float": ("f", 4), "int": ("i", 4), "uint": ("I", 4), "uchar": ("B", 1)}


def read_ply(path):
    """A binary little endian PLY file: vertex rows as dictionaries, and faces."""
    data = read_file(path)
    head, body = data.split(b"end_header\n", 1)
    names, formats, vertices, faces = [], "<", 0, 0
    element = None
    for line in head.decode().split("\n"):
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            element, vertices = "vertex", int(words[2])
        elif words[:2] == ["element", "face"]:
            element, faces = "face", int(words[2])
        elif words[:1] == ["property"] and element == "vertex":
            names.append(words[2])
            formats += TYPES[words[1]][0]
    size = struct.calcsize(formats)
    rows = [dict(zip(names, struct.unpack_from(formats, body, i * size))) for i in range(vertices)]
    at, triangles = vertices * size, []
    for _ in range(faces):
        triangles.append(struct.unpack_from("<3i", body, at + 1))
        at += 13
    assert at == len(body), path
    return rows, triangles


def position(row):
    return (row["x"], row["y"], row["z"])


def distance(p, q):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(p, q)))


def blob(path, subdivisions=3, factors=(1, 1, 1), bump=0.0, shift=(0, 0, 0)):
    """A ball with other proportions and a bump, so that no two places look alike."""
    vertices, faces = icosphere_arrays(subdivisions)
    moved = []
    for p in vertices:
        grown = 1 + bump * math.exp(4 * (p[0] - 1)) + 0.5 * bump * math.exp(6 * (p[1] - 1))
        moved.append(tuple(s + grown * f * x for s, f, x in zip(shift, factors, p)))
    return write_obj(path, moved, faces)


def joined(path, *parts):
    """One file of several (vertices, faces, turned inside out)."""
    vertices, faces = [], []
    for points, triangles, turned in parts:
        start = len(vertices)
        vertices += points
        faces += [tuple(start + i for i in (reversed(f) if turned else f)) for f in triangles]
    return write_obj(path, vertices, faces)


def check_on_target(rows, target):
    """Each vertex is where its triangle and barycentric coordinates say."""
    vertices, faces = read_obj(target)
    for row in rows:
        weights = (row["b0"], row["b1"], row["b2"])
        assert abs(sum(weights) - 1) < 1e-12 and min(weights) >= 0, row
        corners = [vertices[i] for i in faces[row["triangle"]]]
        place = [sum(w * c[k] for w, c in zip(weights, corners)) for k in range(3)]
        assert distance(place, position(row)) < 1e-9, (row, place)


def corresponded(a, b, *options):
    innermap("correspond", a, b, "-o", "out.ply", "--report", "report.json", "--quiet", *options)
    return read_json("report.json")


def check_quality(quality, energy_sum, stretch99):
    assert quality["flips"] == 0, quality
    assert abs(quality["degree"] - 1) < 1e-9, quality
    assert 4 <= quality["energy_forward"] and 4 <= quality["energy_backward"], quality
    assert quality["energy_sum"] <= energy_sum, quality
    assert 1 <= quality["stretch"]["median"] <= quality["stretch"]["p99"], quality
    assert quality["stretch"]["p99"] <= stretch99, quality
    assert quality["inverted_share"] <= 1e-3, quality


def test_one_blob_on_another():
    blob("a.obj", 3, bump=0.8)
    blob("b.obj", 4, (1.2, 0.9, 1), 0.8, (5, 6, 7))
    report = corresponded("a.obj", "b.obj", "--picture", "picture.png")
    rows, faces = read_ply("out.ply")
    assert faces == read_obj("a.obj")[1]
    check_on_target(rows, "b.obj")
    quality = report["correspondence"]
    check_quality(quality, 10, 3)
    assert quality["deviation"]["max"] < 0.02, quality
    assert quality["target_self_intersections"] == 0, quality
    assert report["source"]["vertices"] == 642 and report["target"]["vertices"] == 2562, report
    assert {"read", "lay out", "measure", "write"} <= set(report["seconds"]), report["seconds"]
    with open("picture.png", "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
    no_leftovers("a.obj", "b.obj", "out.ply", "report.json", "picture.png")


def test_the_output_is_a_target_for_everything():
    blob("a.obj", 2, bump=0.8)
    blob("b.obj", 3, (1.2, 0.9, 1), 0.8)
    corresponded("a.obj", "b.obj")
    innermap("fit", "a.obj", "out.ply", "-o", "map.ply", "--charges", "300", "--quiet")
    innermap("check", "out.ply", "--quiet")


def test_landmarks_are_met():
    blob("a.obj", 3, bump=0.8)
    blob("b.obj", 4, (1.2, 0.9, 1), 0.8)
    source, target = read_obj("a.obj")[0], read_obj("b.obj")[0]
    extreme = lambda points, axis, sign: max(range(len(points)),
                                             key=lambda i: sign * points[i][axis])
    pairs = [(extreme(source, axis, sign), extreme(target, axis, sign))
             for axis, sign in [(0, 1), (1, 1), (2, 1), (2, -1), (1, -1)]]
    with open("pairs.txt", "w", encoding="ascii") as file:
        file.write("# tips, by vertices and by points\n\n")
        file.write("{} {}\n".format(*pairs[0]))
        file.write("v{}, v{}   # the second tip\n".format(*pairs[1]))
        file.write("v{} {:.17g} {:.17g} {:.17g}\n".format(pairs[2][0], *target[pairs[2][1]]))
        file.write("{:.17g} {:.17g} {:.17g} v{}\n".format(*source[pairs[3][0]], pairs[3][1]))
        file.write("{:.17g},{:.17g},{:.17g}; {:.17g},{:.17g},{:.17g}\n".format(
            *source[pairs[4][0]], *target[pairs[4][1]]))
    report = corresponded("a.obj", "b.obj", "--landmarks", "pairs.txt")
    rows = read_ply("out.ply")[0]
    for a, b in pairs:
        assert distance(position(rows[a]), target[b]) < 1e-9, (a, b)
    quality = report["correspondence"]
    assert quality["landmarks"] == 5 and quality["landmark_error"] < 1e-9, quality
    check_quality(quality, 14, 5)


def test_points_between_vertices_are_told():
    blob("a.obj", 1, bump=0.8)
    blob("b.obj", 3, (1.2, 0.9, 1), 0.8)
    vertices, faces = read_obj("a.obj")
    middle = [sum(vertices[i][k] for i in faces[7]) / 3 for k in range(3)]
    target = read_obj("b.obj")[0][5]
    write_file("pairs.txt", " ".join(f"{x:.17g}" for x in (*middle, *target)) + "\n")
    innermap("correspond", "a.obj", "b.obj", "-o", "out.ply", "--landmarks", "pairs.txt",
             "--report", "report.json")
    report = read_json("report.json")
    assert any("line 1" in text for text in report["warnings"]), report


def test_bad_landmarks():
    icosphere("a.obj")
    icosphere("b.obj", subdivisions=3)
    cases = [("1 2\n3\n", ["line 2", "1 numbers"]), ("162 1\n", ["line 1", "162", "a.obj"])]
    for text, says in cases:
        write_file("pairs.txt", text)
        fails(1, "correspond", "a.obj", "b.obj", "-o", "out.ply", "--landmarks", "pairs.txt",
              says=["pairs.txt", *says])
    fails(1, "correspond", "a.obj", "b.obj", "-o", "out.ply", "--landmarks", "no.txt",
          says=["no.txt"])


def test_subdividing_writes_both():
    blob("a.obj", 1, bump=0.8)
    blob("b.obj", 4, (1.2, 0.9, 1), 0.8)
    report = corresponded("a.obj", "b.obj", "--subdivide", "0.005")
    rows, faces = read_ply("out.ply")
    source, source_faces = read_ply("out.source.ply")
    assert len(rows) == len(source) > 42 and faces == source_faces
    for row, vertex in zip(source, read_obj("a.obj")[0]):
        assert distance(position(row), vertex) < 1e-12
    check_on_target(rows, "b.obj")
    quality = report["correspondence"]
    assert quality["subdivided"] and quality["deviation"]["max"] <= 0.005, quality
    assert quality["inverted_share"] <= 1e-3, quality
    innermap("fit", "out.source.ply", "out.ply", "-o", "map.ply", "--charges", "300", "--quiet")
    corresponded("a.obj", "b.obj", "--subdivide", "0.01", "--source-out", "a2.ply")
    assert os.path.exists("a2.ply")


def test_shells_are_paired_by_nesting():
    ball, hollow = icosphere_arrays(3), icosphere_arrays(2, 0.4)
    joined("a.obj", (*ball, False), (*hollow, True))
    other = [tuple(3 * x for x in p) for p in hollow[0]], hollow[1]
    inner = [tuple(2 * x for x in p) for p in hollow[0]], hollow[1]
    joined("b.obj", (*inner, True), (*other, False))
    report = corresponded("a.obj", "b.obj")
    rows = read_ply("out.ply")[0]
    radius = [distance(position(row), (0, 0, 0)) for row in rows]
    assert min(radius[:642]) > 1.0 and max(radius[642:]) < 0.9, (min(radius[:642]), max(radius[642:]))
    check_quality(report["correspondence"], 9, 2)
    check_on_target(rows, "b.obj")
    fails(1, "correspond", "a.obj", icosphere("c.obj"), "-o", "no.ply")


def test_genus_one():
    torus("a.obj", 24, 12)
    torus("b.obj", 40, 18, 1.5, 0.4)
    report = corresponded("a.obj", "b.obj")
    check_quality(report["correspondence"], 12, 4)
    check_on_target(read_ply("out.ply")[0], "b.obj")
    line = fails(1, "correspond", "a.obj", icosphere("c.obj"), "-o", "no.ply", says=["genus 1", "0"])
    assert "a.obj" in line and "c.obj" in line, line
    fails(1, "sphere", "a.obj", "-o", "no.ply", says=["a.obj", "1 handle"])


def test_two_handles_through_outer_surfaces():
    for name, minor, apart, scale in (("a.obj", 0.35, 2.3, 1), ("b.obj", 0.45, 2.5, 1.4)):
        points, faces = read_obj(torus("torus.obj", 40, 20, 1, minor))
        place = lambda shift: [(scale * (x + shift), scale * y, scale * z) for x, y, z in points]
        joined(name, (place(0), faces, False), (place(apart), faces, False))
    report = corresponded("a.obj", "b.obj", "--surface-resolution", "32")
    assert report["source"]["genus"] == 2 and report["target"]["genus"] == 2, report
    check_quality(report["correspondence"], 12, 4)
    fails(1, "correspond", "a.obj", "torus.obj", "-o", "no.ply", "--surface-resolution", "32",
          says=["genus 2", "1"])


def test_sphere():
    blob("a.obj", 3, (3, 1, 0.5), 0.8)
    innermap("sphere", "a.obj", "-o", "out.ply", "--report", "report.json")
    rows, faces = read_ply("out.ply")
    assert faces == read_obj("a.obj")[1]
    for row in rows:
        assert abs(distance(position(row), (0, 0, 0)) - 1) < 1e-12
    sphere = read_json("report.json")["sphere"]
    assert sphere["flips"] == 0 and abs(sphere["degree"] - 1) < 1e-9, sphere
    assert sphere["area_ratio_log10"] > -2, sphere
    fails(2, "sphere", "a.obj", "-o", "out.obj", says=["--output", ".ply"])


def test_holes_of_open_meshes_are_closed():
    vertices, faces = icosphere_arrays(3)
    write_obj("open.obj", vertices, faces[1:40] + faces[42:])
    blob("b.obj", 3, (1.2, 0.9, 1), 0.8)
    report = corresponded("open.obj", "b.obj")
    rows, out = read_ply("out.ply")
    assert len(rows) == 642 and len(out) == len(faces) - 3  # no cap in the file
    check_on_target(rows, "b.obj")
    assert any("capped" in note for note in report["notes"]), report["notes"]
    assert len(report["source"]["cap_places"]["x"]) == report["source"]["caps"] == 3, report["source"]
    assert "cap_places" not in report["target"], report["target"]
    # And as a target: what lands on a cap has the closest triangle of the file.
    corresponded("b.obj", "open.obj")
    for row in read_ply("out.ply")[0]:
        assert 0 <= row["triangle"] < len(faces) - 3, row


def test_a_surface_of_its_own_stands_in():
    # Two balls that overlap: their union is mapped.
    ball = icosphere_arrays(3)
    other = [(x + 1, y + 0.2, z) for x, y, z in ball[0]], ball[1]
    joined("a.obj", (*ball, False), (*other, False))
    icosphere("b.obj", subdivisions=3)
    report = corresponded("a.obj", "b.obj", "--surface-resolution", "24")
    rows, faces = read_ply("out.ply")
    assert len(rows) == 2 * 642 and faces == read_obj("a.obj")[1]
    check_on_target(rows, "b.obj")
    quality = report["correspondence"]
    outer = quality["source_outer_surface"]
    assert outer["taken"] and outer["handles"] == 0 and outer["apart_p99"] < 0.02, quality
    assert not quality["target_outer_surface"]["taken"], quality
    assert any("a.obj" in note for note in report["notes"]), report["notes"]
    # Vertices on the outside are spread over all of b.
    points = [position(row) for row in rows]
    for axis in range(3):
        assert max(p[axis] for p in points) > 0.9 and min(p[axis] for p in points) < -0.9
    report = corresponded("b.obj", "a.obj", "--surface-resolution", "24")
    assert report["correspondence"]["target_outer_surface"]["taken"], report
    for row in read_ply("out.ply")[0]:
        assert 0 <= row["triangle"] < 2 * len(ball[1]), row


def test_bad_input():
    vertices, faces = icosphere_arrays(2)
    icosphere("ball.obj")
    write_obj("fin.obj", vertices + [(2, 2, 2)], faces + [(faces[9][0], faces[9][1], len(vertices))])
    write_obj("plane.obj", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])
    cases = [("no.obj", ["no.obj"]), ("plane.obj", ["plane.obj", "no inside"])]
    for bad, says in cases:
        fails(1, "correspond", bad, "ball.obj", "-o", "out.ply", says=says)
        fails(1, "correspond", "ball.obj", bad, "-o", "out.ply", says=says)
    # An edge of three triangles: the outer surface stands in, and why is told.
    innermap("sphere", "fin.obj", "-o", "out.ply", "--report", "report.json")
    edge = "-".join(map(str, sorted(faces[9][:2])))
    assert any("fin.obj" in n and edge in n for n in read_json("report.json")["notes"])
    fails(2, "correspond", "ball.obj", "-o", "out.ply", says=["TARGET"])
    fails(2, "correspond", "ball.obj", "ball.obj", "-o", "out.obj", says=["--output", ".ply"])
    fails(1, "correspond", "ball.obj", "ball.obj", "-o", "/nowhere/out.ply", says=["/nowhere"])
    fails(1, "correspond", "ball.obj", "ball.obj", "-o", "out.ply", "--candidates", "0",
          says=["--candidates"])
    fails(1, "correspond", "ball.obj", "ball.obj", "-o", "out.ply", "--subdivide", "2",
          says=["--subdivide"])
    fails(1, "correspond", "ball.obj", "ball.obj", "-o", "out.ply", "--max-memory", "10M",
          says=["10 MB"])


def test_a_dry_run_refuses_what_the_run_refuses():
    """Of solids that cannot be laid onto each other, or are thinner than the voxels."""
    vertices, faces = icosphere_arrays(2)
    write_obj("ball.obj", vertices, faces)
    torus("ring.obj")
    write_obj("two.obj", vertices + [(x + 5, y, z) for x, y, z in vertices],
              faces + [tuple(v + len(vertices) for v in face) for face in faces])
    write_obj("flat.obj", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    write_obj("plate.obj", [(x, y, 1e-3 * z) for x, y, z in vertices], faces)
    write_obj("bent.obj", [(x, y, 1e-3 * z + 0.1 * x * x) for x, y, z in vertices], faces)
    for a, b, why in [("ball.obj", "ring.obj", "genus"), ("two.obj", "ball.obj", "2 closed surfaces"),
                      ("ball.obj", "flat.obj", "no inside"),
                      ("plate.obj", "bent.obj", "thinner than the voxels")]:
        jobs = [["map", a, b, "-o", "out", "--resolution", "16"]]
        if a != "plate.obj":
            jobs.append(["correspond", a, b, "-o", "out.ply"])
        for job in jobs:
            said = fails(1, *job, says=[why])
            assert fails(1, *job, "--dry-run", says=[why]) == said


def test_a_dry_run_refuses_the_memory_that_the_run_refuses():
    blob("a.obj", 3, bump=0.8)
    blob("b.obj", 2, (1.2, 0.9, 1), 0.8)
    job = ["map", "a.obj", "b.obj", "-o", "out", "--resolution", "96"]
    claim = dry_run(*job).memory
    less, enough = (["--max-memory", f"{bytes / 1e3:.0f}k"] for bytes in (0.93 * claim, claim + 8e6))
    fails(1, *job, *less, "--dry-run", says=["--max-memory"])
    fails(1, *job, *less, says=["--max-memory"])
    dry_run(*job, *enough)
    innermap(*job, *enough)


def test_dry_runs_write_nothing():
    icosphere("a.obj")
    icosphere("b.obj", subdivisions=3)
    need = dry_run("correspond", "a.obj", "b.obj", "-o", "out.ply")
    assert "162" in need.text and need.seconds, need
    dry_run("map", "a.obj", "b.obj", "-o", "out")
    dry_run("sphere", "a.obj", "-o", "out.ply")
    no_leftovers("a.obj", "b.obj")


def test_map_lays_one_onto_the_other_by_itself():
    blob("a.obj", 3, bump=0.8)
    blob("b.obj", 4, (1.2, 0.9, 1), 0.8)
    innermap("map", "a.obj", "b.obj", "-o", "out", "--charges", "400", "--resolution", "32")
    expected = ["correspondence.ply", "correspondence.png", "map.ply", "map.vdb", "report.json",
                "section.png", "slices.exr"]
    assert [f for f in sorted(os.listdir("out")) if f != "correspondence.source.ply"] == expected
    report = read_json("out/report.json")
    check_quality(report["correspondence"], 10, 3)
    assert report["boundary_error"]["rms"] < 0.01, report["boundary_error"]

    # The same again from the file.
    source = "a.obj"
    if os.path.exists("out/correspondence.source.ply"):
        source = "out/correspondence.source.ply"
    options = ["--charges", "400", "--resolution", "32", "--quiet"]
    innermap("map", source, "--correspond", "out/correspondence.ply", "-o", "again", *options)
    again = read_json("again/report.json")
    assert abs(again["boundary_error"]["rms"] - report["boundary_error"]["rms"]) < 1e-9, again
    innermap("map", source, "b.obj", "--correspond", "out/correspondence.ply", "-o", "third",
             *options)
    blob("far.obj", 3, shift=(9, 9, 9))
    fails(1, "map", source, "far.obj", "--correspond", "out/correspondence.ply", "-o", "fourth",
          says=["correspondence.ply", "far.obj"])
    icosphere("other.obj", subdivisions=1)
    fails(1, "map", "other.obj", "--correspond", "out/correspondence.ply", "-o", "fourth",
          says=[".source.ply"])
    fails(2, "map", "a.obj", "-o", "fourth", says=["TARGET"])


def doll(path, subdivisions):
    """A head, two arms and two legs; the same in front and behind, left and right."""
    limbs = (((0, 1, 0), 0.5), ((0.95, 0.3, 0), 0.8), ((-0.95, 0.3, 0), 0.8), ((0.4, -0.9, 0), 1.1),
             ((-0.4, -0.9, 0), 1.1))
    vertices, faces = icosphere_arrays(subdivisions)
    moved = []
    for p in vertices:
        grown = 1 + sum(length * math.exp(14 * (sum(x * w for x, w in zip(p, way)) / math.hypot(*way) - 1))
                        for way, length in limbs)
        moved.append((grown * p[0], grown * p[1], 0.6 * grown * p[2]))
    return write_obj(path, moved, faces)


def test_left_stays_left_unless_told():
    doll("a.obj", 2)
    doll("b.obj", 3)
    arm = max(range(len(read_obj("a.obj")[0])), key=lambda v: read_obj("a.obj")[0][v][0])
    report = corresponded("a.obj", "b.obj", "--picture", "picture.png")
    laid = report["correspondence"]
    assert read_ply("out.ply")[0][arm]["x"] > 1, "the left arm is not on the left"
    assert laid["way"] == 1 and laid["other_way"]["way"] >= 2, laid
    # As good by symmetry; the note says so, and a picture shows it.
    assert laid["other_way"]["score"][1] <= 1.1 * laid["other_way"]["score"][0], laid
    assert laid["other_way"]["turn"][0] < 30, laid
    assert os.path.exists("picture.other.png")
    ways = laid["considered"]["way"]
    turned = [t for t, w in zip(laid["considered"]["turn"], ways) if w == laid["other_way"]["way"]]
    assert ways.count(1) > 0 and turned, laid
    for options in (["--mirror"], ["--choose", str(laid["other_way"]["way"])]):
        report = corresponded("a.obj", "b.obj", "--no-refine", *options)
        assert report["correspondence"]["way"] == laid["other_way"]["way"], (options, report)
        assert read_ply("out.ply")[0][arm]["x"] < -1, options
    fails(1, "correspond", "a.obj", "b.obj", "-o", "no.ply", "--no-refine", "--choose", "60")


def test_refining_is_turned_off():
    doll("a.obj", 2)
    doll("b.obj", 3)
    refined, rough = (corresponded("a.obj", "b.obj", *o) for o in ([], ["--no-refine"]))
    assert rough["correspondence"]["energy_sum"] > refined["correspondence"]["energy_sum"]
    assert rough["settings"]["no_refine"] and not refined["settings"]["no_refine"]


@nightly
def test_real_models():
    if not (MODELS / "spot.obj").exists():
        raise Skip(f"no models in {MODELS}")
    report = corresponded(MODELS / "spot.obj", MODELS / "homer.obj", "--subdivide", "0.005")
    # Flat triangles across what is thin crossed in 3 pairs; split further, they do not.
    assert report["correspondence"]["image_self_intersections"] == 0
    quality = report["correspondence"]
    # Chosen by the inside. By the surfaces alone there are lesser energies, upside down.
    check_quality(quality, 14, 4.5)
    assert quality["stretch"]["max"] <= 10, quality
    scores = quality["considered"]["score"]
    assert len(scores) > 10 and scores == sorted(scores), scores
    rows = read_ply("out.ply")[0]
    check_on_target(rows, MODELS / "homer.obj")
    # The horns and ears come to lie on the head.
    with open(MODELS / "spot.obj", encoding="utf8") as file:
        up = [float(line.split()[2]) for line in file if line.startswith("v ")]
    heights = sorted(row["y"] for row in rows)
    top = sorted(range(len(up)), key=up.__getitem__)[-len(up) // 50:]
    assert min(rows[v]["y"] for v in top) > heights[len(heights) // 2], "the head is not on the head"


run(globals())
