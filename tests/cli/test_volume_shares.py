#!/usr/bin/env python3
"""Shares of one volume, joined to the same bytes."""

import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import cli
from cli import fails, innermap, nightly


LONG = ["evaluate", "map.ply", "--resolution", "270", "--repair", "on", "--quiet"]


def folded_rod(at=2, by=3, over=2):
    """A map of a rod of three blocks, which folds about x = at."""
    v, f = cli.icosphere_arrays(3)
    v = [(20 * x, y, z) for x, y, z in v]
    cli.write_obj("rod.obj", v, f)
    cli.write_obj("pinched.obj", [(x + by * math.exp(-((x - at) / over) ** 2) * y, y, z) for x, y, z in v], f)
    innermap("fit", "rod.obj", "pinched.obj", "-o", "map.ply", "--charges", "300", "--quiet")


def results(path):
    report = cli.read_json(path)
    kept = {k: report.get(k) for k in ["energy", "jacobian", "grid", "repair", "one_to_one", "warnings", "verdict"]}
    return json.dumps(kept)


def test_the_shares_of_a_volume_are_one_run():
    folded_rod()
    innermap(*LONG, "-o", "whole.vdb", "--report", "whole.json")
    assert cli.read_json("whole.json")["repair"]["folded_voxels"] > 0
    fails(1, "join", "cut.vdb.shares", says=["--share"])
    innermap(*LONG, "-o", "cut.vdb", "--share", "2/2")
    fails(1, "join", "cut.vdb.shares", says=["missing", "blocks"])
    for text in ["1/2", "4/7"]:
        told = innermap(*LONG, "-o", "cut.vdb", "--share", text).stdout
    assert "finished already" in told and not Path("cut.vdb").exists()
    innermap("join", "cut.vdb.shares", "--report", "cut.json", "--quiet")
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()
    assert results("cut.json") == results("whole.json")
    report = cli.read_json("cut.json")
    assert report["command"] == "evaluate" and len(report["farm"]["host_frames"]) == 1
    blocks = sorted(Path("cut.vdb.shares").glob("block.*.vdb"))
    assert len(blocks) >= 3

    fails(1, *LONG, "-o", "cut.vdb", "--share", "1/2", "--lame-mu", "0.5", says=["another run", "lame_mu"])
    fails(2, "join", "cut.vdb.shares", "--partial", says=["--partial"])
    fails(2, *LONG[:2], "-o", "x.vdb", "--inverse", "--share", "1/2", says=["--inverse"])
    shutil.copytree("cut.vdb.shares", "other")
    fails(1, "join", "other", says=["other", ".shares"])
    # A block that is cut off is missing; one of another block's voxels is told of.
    whole = blocks[0].read_bytes()
    blocks[0].write_bytes(whole[:-100])
    fails(1, "join", "cut.vdb.shares", says=["1 of", "blocks", "1"])
    blocks[0].write_bytes(whole[:-100] + bytes(100))
    fails(1, "join", "cut.vdb.shares", says=[blocks[0].name, "changed since it was written"])
    blocks[0].unlink()
    innermap(*LONG, "-o", "cut.vdb", "--share", "1/1")  # makes what is missing
    assert blocks[0].read_bytes() == whole
    innermap("fit", "rod.obj", "pinched.obj", "-o", "map.ply", "--charges", "250", "--quiet")
    fails(1, "join", "cut.vdb.shares", says=["cut.vdb.shares", "other files"])


def test_jobs_make_a_volume():
    folded_rod()
    innermap(*LONG, "-o", "whole.vdb")
    innermap(*LONG, "-o", "cut.vdb", "--jobs", "jobs.json", "--tasks", "2")
    for step in cli.read_json("jobs.json")["steps"]:
        run = step["script"]["actions"]["onRun"]
        for share_number in "12" if step["name"] == "Shares" else "1":
            words = [word.replace("{{Task.Param.Share}}", share_number) for word in run["args"]]
            subprocess.run([run["command"], *words], check=True, capture_output=True)
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()


def textured_rod():
    v, f = cli.icosphere_arrays(3)
    v = [(20 * x, y, z) for x, y, z in v]
    with open("textured.obj", "w", encoding="ascii") as file:
        for x, y, z in v:
            file.write(f"v {x} {y} {z}\nvt {x} {y + z}\n")
        for face in f:
            file.write("f " + " ".join(f"{i + 1}/{i + 1}" for i in face) + "\n")


PASSING = {"seconds", "date", "peak_memory_bytes", "memory_after_bytes", "farm", "host", "command_line", "settings",
           "outputs", "frames", "notes"}


def assert_one_run(*command):
    """Whichever way it is cut, and whatever else is there."""
    innermap(*command, "-o", "whole.vdb", "--report", "whole.json")
    for text in ["3/3", "1/2", "2/3"]:
        innermap(*command, "-o", "cut.vdb", "--share", text)
    assert not Path("cut.vdb").exists() and len(list(Path("cut.vdb.shares").glob("block.*.vdb"))) >= 3
    innermap("join", "cut.vdb.shares", "--report", "cut.json", "--quiet")
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes(), command
    one, other = [{k: v for k, v in cli.read_json(name).items() if k not in PASSING}
                  for name in ["whole.json", "cut.json"]]
    assert json.dumps(one) == json.dumps(other), (one, other)
    shutil.rmtree("cut.vdb.shares")
    os.unlink("cut.vdb")


def test_the_shares_of_voxelize_are_one_run():
    textured_rod()
    assert_one_run("voxelize", "textured.obj", "--resolution", "270", "--fog", "--attributes", "-q")
    assert_one_run("voxelize", "textured.obj", "--resolution", "270", "--half-width", "12", "-q")
    Path("scan.nii").write_bytes(b"")
    fails(2, "voxelize", "scan.nii", "-o", "x.vdb", "--share", "1/2", says=["--share", "scan"])


def test_the_shares_of_push_and_pull_are_one_run():
    folded_rod(at=-2.15, by=6, over=1)  # where two blocks meet: voxels there are not inverted
    innermap(*LONG, "-o", "rest.vdb")  # a level set, positions, a fog, scalars
    assert_one_run("push", "map.ply", "rest.vdb", "--resolution", "270", "-q")
    assert cli.read_json("whole.json")["inverse"]["not_inverted"] > 0
    assert_one_run("pull", "map.ply", "rest.vdb", "--resolution", "270", "--density", "-q")
    innermap("push", "map.ply", "rest.vdb", "-o", "cut.vdb", "--share", "1/2", "-q")
    fails(1, "push", "map.ply", "rest.vdb", "-o", "cut.vdb", "--share", "2/2", "--sampling", "nearest",
          says=["another run", "sampling"])
    shutil.copy("cut.vdb.shares/block.0001.vdb", "cut.vdb.shares/block.0002.vdb")
    fails(1, "join", "cut.vdb.shares", says=["blocks"])
    fails(2, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--share", "1/2", "--density",
          says=["--density", "density", "--share"])
    fails(2, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--jobs", "j.txt", "--outside", "0.1",
          says=["--outside", "--jobs"])
    fails(2, "pull", "map.ply", "rod.obj", "-o", "x.obj", "--share", "1/2", says=["--share", "geometry"])


def test_jobs_of_a_map_begin_with_its_fit():
    folded_rod()
    command = ["map", "rod.obj", "pinched.obj", "--charges", "300", "--resolution", "270", "--repair=on"]
    told = innermap(*command, "-o", "out", "--jobs", "jobs.json", "--tasks", "2").stdout
    assert "2 shares" in told and not os.listdir("out"), told
    steps = cli.read_json("jobs.json")["steps"]
    assert [step["name"] for step in steps] == ["First", "Shares", "Join"]
    assert [step.get("dependencies", [{}])[0].get("dependsOn") for step in steps] == [None, "First", "Shares"]
    for step in steps:
        run = step["script"]["actions"]["onRun"]
        for share in "12" if step["name"] == "Shares" else "1":
            words = [word.replace("{{Task.Param.Share}}", share) for word in run["args"]]
            subprocess.run([run["command"], *words], check=True, capture_output=True)
    assert sorted(os.listdir("out")) == ["map.ply", "map.vdb", "map.vdb.shares"]
    innermap(*LONG, "-o", "whole.vdb")
    assert Path("out/map.ply").read_bytes() == Path("map.ply").read_bytes()
    assert Path("out/map.vdb").read_bytes() == Path("whole.vdb").read_bytes()
    check = cli.ROOT.parent / "shared" / "hosts" / "openjd_check.py"
    if check.exists():
        subprocess.run([sys.executable, check, "jobs.json"], check=True)
    innermap(*command, "-o", "out", "--jobs", "jobs.sh")
    script = Path("jobs.sh").read_text(encoding="utf-8")
    assert script.index("first=$(sbatch") < script.index("afterok:\"$first\"") < script.index("afterok:\"$array\"")
    fails(1, *command, "-o", "out", "--jobs", "jobs.txt", says=["--jobs", "jobs.txt", "order"])
    fails(2, *command, "-o", "out", "--jobs", "j.sh", "--slices", "3", says=["--slices"])
    fails(2, "map", "rod.obj", cli.cube(), "-o", "out", "--jobs", "j.sh", says=["--jobs", "evaluate"])


@nightly
def test_the_shares_of_a_large_volume():
    """Equal grids, and a worker's memory is an eighth of the whole's, and what the map takes."""
    poses = cli.MODELS / "horse-poses"
    if not poses.exists():
        raise cli.Skip(f"no models in {cli.MODELS}")
    fixed = 120e6
    innermap("fit", poses / "reference.obj", poses / "pose-02.obj", "-o", "map.ply", "--charges", "2000", "-q")
    command = ["evaluate", "map.ply", "--resolution", "1024", "-q"]
    innermap(*command, "-o", "whole.vdb", "--report", "whole.json")
    whole = cli.read_json("whole.json")["peak_memory_bytes"]
    for k in range(1, 17):
        innermap(*command, "-o", "cut.vdb", "--share", f"{k}/16", "--report", "part.json")
        assert cli.read_json("part.json")["peak_memory_bytes"] < whole / 8 + fixed, k
    innermap("join", "cut.vdb.shares", "-q")
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()


cli.run(globals())
