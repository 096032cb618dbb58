#!/usr/bin/env python3
"""Push and pull: volumes carried through maps of meshes made here, and of the horse where it is."""


from cli import (MODELS, Skip, fails, file_size_limit, icosphere, independent, innermap, no_leftovers,
                 read_file, read_json, run, write_file)
from scenes import fitted_ball, swirl


def scene(function=swirl, subdivisions=4, sources=400, resolution=32):
    """map.ply from ball.obj to target.obj, and rest.vdb: a fog and a level set in the ball."""
    fitted_ball(function, subdivisions=subdivisions, sources=sources)
    innermap("voxelize", "ball.obj", "-o", "rest.vdb", "--resolution", resolution, "--fog",
             "--quiet")


def test_push_keeps_mass_and_inverts_all():
    scene(resolution=128)
    innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--density", "--report", "r.json",
             "--quiet")
    report = read_json("r.json")
    assert report["inverse"]["inverted_fraction"] > 0.999, report["inverse"]
    assert report["inverse"]["largest_residual_voxels"] <= 0.01
    mass = report["mass"]
    assert abs(mass["density_after"] / mass["density_before"] - 1) < 1e-3, mass
    # Mass, not value: the target is larger by half.
    ratio = report["densities"]["density_largest_ratio"]
    assert 0.6 < ratio < 0.9, report["densities"]
    out = independent("""
import sys, pyopenvdb as v
a, b = (v.read(p, "density") for p in sys.argv[1:])
for g in a, b:
    h = g.transform.voxelSize()[0]
    print(sum(x.value * x.count for x in g.citerOnValues()) * h ** 3)
    print(max(x.value for x in g.citerOnValues()))
""", "rest.vdb", "posed.vdb")
    before, most_before, after, most_after = map(float, out.split())
    assert abs(after / before - 1) < 1e-3, out
    assert most_after <= most_before * ratio * (1 + 1e-5), out
    no_leftovers("ball.obj", "target.obj", "map.ply", "rest.vdb", "posed.vdb", "r.json")


def test_densities_alone_need_no_inverse():
    scene()
    said = innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--grids", "density",
                    "--density", "--report", "r.json").stdout
    report = read_json("r.json")
    assert "inverse" not in report and "inverse" not in said, said
    mass = report["mass"]
    assert abs(mass["density_after"] / mass["density_before"] - 1) < 1e-3, mass


def test_metadata_tells_the_map_and_its_error():
    scene()
    innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--grids", "density", "--quiet")
    out = independent("import sys, pyopenvdb as v\n"
                     "g = v.readAllGridMetadata(sys.argv[1])\n"
                     "print(len(g), g[0].name, g[0].gridClass, 'innermap_boundary_error_rms' in "
                     "g[0].metadata)", "posed.vdb")
    assert out.split() == ["1", "density", "fog", "volume", "True"], out


def test_pull_undoes_push():
    scene(resolution=64)
    innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--quiet")
    innermap("pull", "map.ply", "posed.vdb", "-o", "again.vdb", "--quiet")
    out = independent("""
import sys, pyopenvdb as v
a, b = (v.read(p, "surface") for p in sys.argv[1:])
acc, worst, n = a.getConstAccessor(), 0, 0
for x in b.citerOnValues():
    if abs(x.value) < 2 * b.transform.voxelSize()[0]:
        worst, n = max(worst, abs(x.value - acc.getValue(x.min))), n + 1
print(worst / b.transform.voxelSize()[0], n)
""", "rest.vdb", "again.vdb")
    worst, count = map(float, out.split())
    assert worst < 0.5 and count > 1000, out  # voxels; two interpolations and two rebuilds


def test_vectors_of_the_map_itself():
    # The grid `map` of the identity's positions, pushed: each voxel tells where it came from.
    scene(resolution=32)
    innermap("map", "ball.obj", "ball.obj", "-o", "same", "--resolution", "32", "--quiet")
    innermap("push", "map.ply", "same/map.vdb", "-o", "posed.vdb", "--grids", "map", "--quiet")
    out = independent("""
import sys, math, pyopenvdb as v
g = v.read(sys.argv[1], "map")
worst = 0
for x in g.citerOnValues():
    p = x.value
    if sum(a * a for a in p) > 0.95: continue
    a = 0.6 * p[2]
    f = (1.2 * (math.cos(a) * p[0] - math.sin(a) * p[1]) + 4,
         1.2 * (math.sin(a) * p[0] + math.cos(a) * p[1]), 1.1 * p[2])
    q = g.transform.indexToWorld(x.min)
    worst = max(worst, max(abs(s - t) for s, t in zip(f, q)))
print(worst)
""", "posed.vdb")
    # The swirl is no harmonic function: the map differs from it inside.
    assert float(out) < 0.05, out


def test_outside_and_what_it_fades_to():
    scene()
    icosphere("big.obj", 3, 1.6)
    innermap("voxelize", "big.obj", "-o", "big.vdb", "--voxel-size", "0.06", "--fog", "--quiet")
    counts = {}
    for name, options in {"inside": [], "cut": ["--outside", "0.1"],
                          "all": ["--outside", "0.1", "--fade-to", "fitted"]}.items():
        innermap("push", "map.ply", "big.vdb", "-o", f"{name}.vdb", "--grids", "density",
                 "--report", "r.json", "--quiet", *options)
        counts[name] = read_json("r.json")["inverse"]["voxels"]
    assert counts["inside"] < counts["cut"] < counts["all"], counts
    innermap("pull", "map.ply", "cut.vdb", "-o", "back.vdb", "--outside", "0.05", "--quiet")
    for options in (["--fade-to", "identity"], ["--outside", "0.1", "--fade-to", "sideways"],
                    ["--outside", "0.1", "--fade-to", "2,0,0,0,0,1,0,0,0,0,1,0"]):
        fails(2, "push", "map.ply", "big.vdb", "-o", "x.vdb", *options, says=["--fade-to"])
    for number in ("2", "nan", "-0.1"):
        done = innermap("push", "map.ply", "big.vdb", "-o", "x.vdb", "--outside=" + number,
                        exit_code=1 if number != "nan" else 2)
        assert "--outside" in done.stderr, done.stderr


def test_names_of_other_programs():
    scene()
    innermap("map", "ball.obj", "ball.obj", "-o", "same", "--resolution", "32", "--quiet")
    innermap("push", "map.ply", "same/map.vdb", "-o", "posed.vdb", "--names", "blender", "--quiet")
    assert "density" in innermap("info", "posed.vdb").stdout


def test_bad_input():
    scene()
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--grids", "smoke",
          says=["rest.vdb", "smoke", "density", "surface"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--densities", "smoke",
          says=["smoke", "density"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--densities", "surface",
          says=["surface"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--stress", "s", says=["s.xx"])
    fails(1, "push", "ball.obj", "rest.vdb", "-o", "x.vdb", says=["ball.obj"])
    fails(1, "push", "map.ply", "ball.obj", "-o", "x.vdb", says=["ball.obj"])
    fails(1, "push", "map.ply", "missing.vdb", "-o", "x.vdb", says=["missing.vdb"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "no/x.vdb", says=["no"])
    fails(2, "push", "map.ply", "rest.vdb")
    fails(2, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--sampling", "cubic")
    fails(1, "pull", "map.ply", "rest.vdb", "-o", "x.vdb", "--voxel-size", "-1",
          says=["--voxel-size"])
    # The target's volume is not where the source is.
    innermap("voxelize", "target.obj", "-o", "there.vdb", "--resolution", "32", "--quiet")
    fails(1, "push", "map.ply", "there.vdb", "-o", "x.vdb", says=["surface", "ball.obj"])
    content = read_file("rest.vdb")
    write_file("half.vdb", content[:len(content) // 2])
    fails(1, "push", "map.ply", "half.vdb", "-o", "x.vdb", says=["half.vdb"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--max-memory", "100MB",
          says=["--max-memory"])
    fails(1, "push", "map.ply", "rest.vdb", "-o", "x.vdb",
          preexec_fn=file_size_limit(1000))


def test_horse():
    poses = MODELS / "horse-poses"
    if not poses.exists():
        raise Skip("no shared/models")
    innermap("fit", poses / "reference.obj", poses / "pose-03.obj", "-o", "map.ply", "--quiet")
    innermap("voxelize", poses / "reference.obj", "-o", "rest.vdb", "--resolution", "128", "--fog",
             "--quiet")
    innermap("push", "map.ply", "rest.vdb", "-o", "posed.vdb", "--density", "--report", "r.json",
             "--quiet")
    report = read_json("r.json")
    assert report["inverse"]["inverted_fraction"] > 0.995, report["inverse"]
    mass = report["mass"]
    assert abs(mass["density_after"] / mass["density_before"] - 1) < 1e-3, mass


run(globals())
