#!/usr/bin/env python3
"""innermap harmonic and weights: fields from values and fluxes on a surface."""

import json
import math
import os

import cli
from cli import innermap

SHELL = 24  # around


def write_capsule(path, around=SHELL, up=8):
    """A half shell between two half spheres, open side up: groups outer, inner and rim."""
    vertices, faces = [], {"outer": [], "inner": [], "rim": []}

    def half_sphere(radius, turned, name):
        rows = [[len(vertices)]]
        vertices.append((0, 0, -radius))
        for i in range(1, up + 1):
            rows.append([])
            for j in range(around):
                theta, phi = 0.5 * math.pi * i / up, 2 * math.pi * j / around
                rows[-1].append(len(vertices))
                vertices.append((radius * math.sin(theta) * math.cos(phi),
                                 radius * math.sin(theta) * math.sin(phi),
                                 -radius * math.cos(theta)))
        for i in range(up):
            for j in range(around):
                k = (j + 1) % around
                quad = [rows[i][j % len(rows[i])], rows[i][k % len(rows[i])],
                        rows[i + 1][k], rows[i + 1][j]]
                quad = list(dict.fromkeys(quad))
                faces[name].append(quad[::-1] if turned else quad)
        return rows[-1]

    outer = half_sphere(1, False, "outer")
    inner = half_sphere(0.5, True, "inner")
    for j in range(around):
        k = (j + 1) % around
        faces["rim"].append([outer[j], outer[k], inner[k], inner[j]])
    with open(path, "w", encoding="utf-8") as file:
        for v in vertices:
            file.write("v {} {} {}\n".format(*v))
        for name, group in faces.items():
            file.write(f"g {name}\n")
            for face in group:
                file.write("f " + " ".join(str(v + 1) for v in face) + "\n")
        file.write("g marks\np 1\n")
    return vertices


def report_of(*arguments, **options):
    innermap(*arguments, "--report", "r.json", **options)
    with open("r.json", encoding="utf-8") as file:
        return json.load(file)


def test_depth_between_two_groups():
    write_capsule("shell.obj")
    report = report_of("harmonic", "shell.obj", "-o", "depth.vdb", "--fix", "inner=0,outer=1",
                       "--tolerance", "1e-2", "--resolution", "32", "--field", "depth.ply")
    assert report["tolerance"]["met"] and report["boundary_error"]["p99"] <= 1e-2
    assert report["boundary_error"]["max"] <= report["boundary_error"]["bound"] < 0.5
    # The rim: a ring of 1 and 0.5 beside half spheres.
    ring, spheres = 0.75, 2 * (1 + 0.25)
    assert abs(report["field"]["free_share"] - ring / (ring + spheres)) < 0.02
    text = innermap("info", "depth.vdb").stdout
    for name in ["surface", "density", "value", "value_gradient", "value_direction",
                 "value_magnitude"]:
        assert f"  {name}: " in text, text
    assert os.path.getsize("depth.ply") > 1000


def test_groups_that_touch_are_joined():
    write_capsule("shell.obj")
    text = cli.read_file("shell.obj").decode()
    cli.write_file("tiled.obj", text.replace("g rim", "g inner"))
    report = report_of("weights", "tiled.obj", "-o", "w.vdb", "--groups", "inner,outer",
                       "--resolution", "24")
    assert report["tolerance"]["met"], report
    assert report["notes"], report
    text = innermap("info", "w.vdb").stdout
    assert "  inner: float" in text and "  outer: float" in text


def test_values_of_vertices():
    vertices = write_capsule("shell.obj")
    with open("table.csv", "w", encoding="utf-8") as file:
        file.write("vertex,height,double\n")
        for i, v in enumerate(vertices):
            file.write(f"{i},{v[2]},{2 * v[2]}\n")
    report = report_of("harmonic", "shell.obj", "-o", "h.vdb", "--table", "table.csv",
                       "--resolution", "24", "--grids", "value,gradient")
    # Linear data are met exactly.
    assert report["boundary_error"]["max"] < 1e-9 and report["field"]["free_share"] == 0
    text = innermap("info", "h.vdb").stdout
    assert "  height: float" in text and "  double_gradient: vec3s" in text
    assert "direction" not in text


def test_properties_and_colours():
    ply = ["ply", "format ascii 1.0", "element vertex 4", "property float x", "property float y",
           "property float z", "property uchar red", "property uchar green", "property uchar blue",
           "property float heat", "element face 4", "property list uchar int vertex_indices",
           "end_header", "0 0 0 255 0 0 0", "1 0 0 0 255 0 1", "0 1 0 0 0 255 2",
           "0 0 1 255 255 255 3", "3 0 2 1", "3 0 1 3", "3 1 2 3", "3 0 3 2", ""]
    cli.write_file("tet.ply", "\n".join(ply))
    for option, name in [(["--property", "heat"], "heat"), (["--vertex-colours"], "green")]:
        innermap("harmonic", "tet.ply", "-o", "t.vdb", *option, "--resolution", "16", "--grids",
                 "value")
        assert f"  {name}: float" in innermap("info", "t.vdb").stdout


def test_what_is_refused():
    write_capsule("shell.obj")
    for code, arguments, word in [
            (1, ["--fix", "inner=0,nose=1"], "nose"),
            (2, ["--fix", "inner"], "GROUP=VALUE"),
            (1, ["--fix", "marks=1"], "ball"),
            (2, ["--fix", "inner=0:1,outer=1"], "outer"),
            (1, ["--fix", "inner=0,outer=1", "--flux", "inner=1,outer=1"], "flux"),
            (2, ["--fix", "inner=0,outer=1", "--channels", "a,b"], "--channels"),
            (2, ["--fix", "inner=0,outer=1", "--grids", "curl"], "curl"),
            (1, ["--property", "heat"], "propert"),
            (1, ["--vertex-colours"], "colours"),
            (2, [], "--fix")]:
        cli.fails(code, "harmonic", "shell.obj", "-o", "x.vdb", *arguments, says=[word])
    cli.fails(1, "weights", "shell.obj", "-o", "x.vdb", "--groups", "inner")
    cli.no_leftovers("shell.obj")


if __name__ == "__main__":
    cli.run(globals())
