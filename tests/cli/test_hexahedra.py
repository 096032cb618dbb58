#!/usr/bin/python3
"""Command-line tests of innermap polycube and hexahedralize."""

import os

from cli import (MODELS, Skip, alone, fails, icosphere_arrays, innermap, nightly, no_leftovers,
                 read_json, read_obj, run, torus, write_obj)


def read_hexahedra(path):
    """(cells, volume, cells inverted at a corner, least scaled Jacobian) as VTK has them."""
    try:
        import vtk  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise Skip("python3-vtk9 is not installed") from error
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(reader.GetOutput())
    quality.SetHexQualityMeasureToScaledJacobian()
    quality.Update()
    least = quality.GetOutput().GetCellData().GetArray("Quality").GetRange()[0]
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(reader.GetOutput())
    sizes.Update()
    volumes = sizes.GetOutput().GetCellData().GetArray("Volume")
    cells = reader.GetOutput().GetNumberOfCells()
    assert all(reader.GetOutput().GetCellType(c) == 12 for c in range(cells))
    return cells, sum(volumes.GetValue(c) for c in range(cells)), least


def test_torus_is_filled():
    torus("ring.obj", n=48, m=20)
    innermap("hexahedralize", "ring.obj", "-o", "ring.vtu", "--blocks", 12, "--pieces", 1, "--picture",
             "cut.png", "--polycube", "cubes.ply", "--polycube-picture", "cubes.png", "--in-blocks",
             "blocks.vtu", "--report", "report.json")
    report = read_json("report.json")
    assert report["polycube"]["handles"] == 1
    assert report["hexahedra"]["proven"] and report["hexahedra"]["after"]["inverted"] == 0
    assert report["hexahedra"]["before"]["inverted"] >= 0
    assert report["cells"]["scaled_jacobian"]["mean"] > 0.75
    assert report["boundary"]["from_surface"]["rms"] < 5e-3
    for stage in ("polycube", "boundary map", "map", "shape", "measure", "write", "picture"):
        assert stage in report["seconds"], stage
    for picture in ("cut.png", "cubes.png"):
        assert os.path.getsize(picture) > 5000
    cells, volume, least = read_hexahedra("ring.vtu")
    assert cells == report["cells"]["hexahedra"]
    assert abs(least - report["cells"]["scaled_jacobian"]["least"]) < 1e-5
    assert abs(volume - 2 * 3.14159265**2 * 0.16) < 0.05 * volume, volume
    cells, volume, _ = read_hexahedra("blocks.vtu")
    assert cells == report["cells"]["hexahedra"]
    edge = report["polycube"]["edge"]
    assert abs(volume - report["polycube"]["blocks"] * edge**3) < 1e-6 * volume
    no_leftovers("ring.obj", "ring.vtu", "cut.png", "cubes.ply", "cubes.png", "blocks.vtu",
                 "report.json")


def test_polycube_can_be_mapped():
    torus("ring.obj", n=48, m=20)
    innermap("polycube", "ring.obj", "-o", "cubes.obj", "--blocks", 10, "--pieces", 3, "--report",
             "report.json")
    check = innermap("check", "cubes.obj", "--report", "check.json").stdout
    assert read_json("check.json")["source"]["genus"] == 1, check
    report = read_json("report.json")["polycube"]
    assert report["across"] == 10 and 0 < report["missed"] < 0.2
    vertices = read_obj("cubes.obj")[0]
    assert len(vertices) == report["vertices"]
    # They stand on the lattice of a third of a block.
    for axis in range(3):
        low = min(v[axis] for v in vertices)
        for v in vertices:
            steps = (v[axis] - low) / report["edge"] * 3
            assert abs(steps - round(steps)) < 1e-6


def test_bad_input_is_refused():
    vertices, faces = icosphere_arrays(2)
    write_obj("ball.obj", vertices, faces)
    far = [(x + 3, y, z) for x, y, z in vertices]
    shifted = [tuple(i + len(vertices) for i in f) for f in faces]
    write_obj("two.obj", vertices + far, faces + shifted)
    for command, out in (("polycube", "out.obj"), ("hexahedralize", "out.vtu")):
        fails(1, command, "two.obj", "-o", out, says=["two.obj", "2 bodies"])
        fails(1, command, "ball.obj", "-o", out, "--max-memory", "1M", says=["1 MB"])
        fails(2, command, "ball.obj", "-o", "out.stl", says=["out.stl"])
        fails(1, command, "ball.obj", "-o", out, "--blocks", 65, says=["--blocks"])
    fails(1, "hexahedralize", "ball.obj", "-o", "out.vtu", "--pieces", 17, says=["--pieces"])
    torus("ring.obj")
    fails(1, "polycube", "ring.obj", "-o", "out.obj", "--blocks", 2,
          says=["1 handle and 0 cavities"])


def test_holes_are_closed_and_parts_united():
    vertices, faces = icosphere_arrays(2)
    write_obj("open.obj", vertices, faces[16:])
    innermap("polycube", "open.obj", "-o", "out.obj", "--blocks", 6)
    near = [(x + 1, y, z) for x, y, z in vertices]
    shifted = [tuple(i + len(vertices) for i in f) for f in faces]
    write_obj("two.obj", vertices + near, faces + shifted)
    innermap("polycube", "two.obj", "-o", "united.obj", "--blocks", 8)
    apart = [(x + 3, y, z) for x, y, z in vertices]
    write_obj("apart.obj", vertices + apart, faces + shifted)
    fails(1, "polycube", "apart.obj", "-o", "two_out.obj", says=["2 bodies"])


@nightly
@alone
def test_models_are_filled():
    """What the defaults give; a model's least Jacobian may be low, but on one of them only."""
    if not MODELS.is_dir():
        raise Skip(f"{MODELS} is not there")
    low = []
    for name in ("spot", "fandisk", "rocker-arm", "homer", "cheburashka"):
        innermap("hexahedralize", MODELS / f"{name}.obj", "-o", "out.vtu", "--report", "report.json",
                 timeout=600)
        report = read_json("report.json")
        jacobian = report["cells"]["scaled_jacobian"]
        assert report["hexahedra"]["proven"], name
        assert jacobian["mean"] >= 0.75, (name, jacobian["mean"])
        assert report["boundary"]["from_surface"]["rms"] <= 2e-3, name
        assert report["boundary"]["to_surface"]["rms"] <= 2e-3, name
        if jacobian["least"] < 0.1:
            low.append(name)
    assert len(low) <= 1, low


if __name__ == "__main__":
    run(globals())
