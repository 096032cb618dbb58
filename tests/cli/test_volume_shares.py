#!/usr/bin/env python3
"""Shares of one volume, joined to the same bytes."""

import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import cli
from cli import PROGRAM, fails, innermap, nightly


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
    assert cli.dry_run("join", "cut.vdb.shares").memory > 1e7
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
    """With other vector instructions than the machine's best, in all of them."""
    folded_rod()
    older = ["--cpu-target", "avx2"] if " avx2 " in Path("/proc/cpuinfo").read_text(encoding="ascii") else []
    innermap(*LONG, "-o", "whole.vdb", *older)
    innermap(*LONG, "-o", "cut.vdb", "--jobs", "jobs.json", "--tasks", "2", *older)
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


PASSING = {"seconds", "date", "peak_memory_bytes", "memory_after_bytes", "stages", "farm", "host", "command_line", "settings",
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
    assert_one_run("pull", "map.ply", "rest.vdb", "--resolution", "270", "--density", "-q")
    # Two densities, in cubes of their own; and one with nothing that is sampled.
    assert_one_run("push", "map.ply", "rest.vdb", "--resolution", "270", "--densities", "harmonic_energy,density",
                   "-q")
    report = cli.read_json("whole.json")
    assert report["inverse"]["not_inverted"] > 0, report["inverse"]
    assert report["mass"]["harmonic_energy_after"] > 0 and report["densities"]["density_folded_cells"] > 0, report
    assert_one_run("push", "map.ply", "rest.vdb", "--grids", "density", "--density", "-q", "--voxel-size", "0.08",
                   "--density-limit", "1.1")
    innermap("push", "map.ply", "rest.vdb", "-o", "cut.vdb", "--share", "1/2", "-q")
    fails(1, "push", "map.ply", "rest.vdb", "-o", "cut.vdb", "--share", "2/2", "--sampling", "nearest",
          says=["another run", "sampling"])
    shutil.copy("cut.vdb.shares/block.0001.vdb", "cut.vdb.shares/block.0002.vdb")
    fails(1, "join", "cut.vdb.shares", says=["blocks"])
    fails(2, "push", "map.ply", "rest.vdb", "-o", "x.vdb", "--jobs", "j.txt", "--outside", "0.1",
          says=["--outside", "--jobs"])
    fails(2, "pull", "map.ply", "rod.obj", "-o", "x.obj", "--share", "1/2", says=["--share", "geometry"])


def test_blocks_stand_side_by_side():
    folder = rod_in_shares("cut.vdb")
    innermap("export", folder, "-o", "tiles.usda")
    text = Path("tiles.usda").read_text(encoding="utf-8")
    blocks = sorted(path.name for path in folder.glob("block.*"))
    assert re.findall(r"asset filePath = @\./cut\.vdb\.shares/(.*)@", text) == blocks and len(blocks) > 2, text
    for name in blocks:
        prim = name[:-len(".vdb")].replace(".", "_")
        assert f"rel field:surface = </tiles/{prim}/surface>" in text, text
    assert 'def Xform "tiles"' in text and "timeSamples" not in text
    assert text.count("extent = ") == len(blocks) == text.count("def Volume")
    checker = cli.ROOT.parent / "shared" / "hosts" / "usda_check.py"
    if checker.exists():
        subprocess.run([cli.PYTHON, checker, "tiles.usda"], check=True, capture_output=True)
    (folder / blocks[1]).unlink()
    fails(1, "export", folder, "-o", "x.usda", says=["cut.vdb.shares", "1 of", "missing: 2"])


VOXELIZE = ["voxelize", "rod.obj", "--resolution", "270", "-q"]


def rod_in_shares(output, *more):
    cli.write_obj("rod.obj", [(20 * x, y, z) for x, y, z in cli.icosphere_arrays(3)[0]], cli.icosphere_arrays(3)[1])
    innermap(*VOXELIZE, "-o", output, "--share", "1/1", *more)
    return Path(output + ".shares")


def content(folder):
    return {str(path): path.read_bytes() for path in sorted(Path(folder).rglob("*")) if path.is_file()}


def hash_of(text):
    """As core/file.h has it: parts are named by what they hold."""
    data, state, mask = text.encode(), 0xcbf29ce484222325, (1 << 64) - 1
    for i in range(0, len(data), 8):
        state = (state ^ int.from_bytes(data[i:i + 8], "little")) * 0x100000001b3 & mask
        state ^= state >> 32
    z = state ^ len(data)
    for shift, factor in [(30, 0xbf58476d1ce4e5b9), (27, 0x94d049bb133111eb)]:
        z = (z ^ z >> shift) * factor & mask
    return f"{z ^ z >> 31:016x}"


def part_name(number, text):
    begin = text.index("{", text.index('"result"'))
    lines = text[begin:text.index("\n }", begin) + 3].split("\n")
    return f"frame.{number:04}.{hash_of(chr(10).join([lines[0], *[line[1:] for line in lines[1:]]]) + chr(10))}.json"


def forged(part, before, after):
    """A part beside this one that holds something else, and is whole."""
    text = part.read_text(encoding="utf-8")
    number = int(part.name.split(".")[1])
    assert part_name(number, text) == part.name and before in text
    text = text.replace(before, after, 1)
    other = part.with_name(part_name(number, text))
    other.write_text(text, encoding="utf-8")
    return other


def refuses(folder, says):
    """join ends with these words, and leaves all as it was."""
    before = content(folder)
    fails(1, "join", folder, says=says)
    assert content(folder) == before


def test_bad_parts_of_a_volume():
    folder = rod_in_shares("cut.vdb")
    innermap(*VOXELIZE, "-o", "whole.vdb")
    parts = sorted((folder / "parts").glob("frame.*"))
    block = folder / "block.0002.vdb"
    output = re.search(r'"\d+-[0-9a-f]{16}"', parts[1].read_text(encoding="utf-8"))[0]

    # Written twice with other bits: both workers' parts are named; either may go.
    twin = forged(parts[1], output, output[:-3] + ("00" if output[-3:-1] != "00" else "11") + '"')
    refuses(folder, ["block 2", "twice", twin.name, parts[1].name, "--cpu-target"])
    hidden = parts[1].read_bytes()
    parts[1].unlink()
    refuses(folder, [block.name, "changed since it was written"])
    twin.unlink()
    refuses(folder, ["1 of", "blocks", "2"])
    parts[1].write_bytes(hidden)

    # Origins that are none, and another block's.
    first, second = [re.search(r'"totals",[^]]*', part.read_text(encoding="utf-8"))[0] for part in parts[:2]]
    begin, last = re.fullmatch(r"(.*?)(-?[0-9.]+)\s*", second, re.S).groups()
    for wrong, says in [(begin + last + "5", "totals"), (begin + "1e+30", "totals"), (begin + "7.0", "totals"),
                        (begin + "null", "totals"), (first, "same block")]:
        twin = forged(parts[1], second.rstrip(), wrong.rstrip())
        parts[1].unlink()
        refuses(folder, ["block.000", says])
        twin.unlink()
        parts[1].write_bytes(hidden)

    # Cut off; of no block; of another version; of another run.
    parts[1].write_bytes(hidden[:len(hidden) // 2])
    refuses(folder, [parts[1].name, "cut off"])
    parts[1].write_bytes(hidden)
    stray = forged(parts[0], '"frame": 1,', '"frame": 99,')
    stray = stray.rename(stray.with_name(part_name(99, stray.read_text(encoding="utf-8"))))
    refuses(folder, [stray.name, "none of the run's"])
    stray.unlink()
    run = next((folder / "parts").glob("run.*"))
    good = run.read_text(encoding="utf-8")
    run.write_text(good.replace('"version": "', '"version": "0.'), encoding="utf-8")
    refuses(folder, ["use that version"])
    run.write_text(good, encoding="utf-8")
    other = rod_in_shares("other.vdb", "--half-width", "4")
    shutil.copy(next((other / "parts").glob("run.*")), folder / "parts")
    refuses(folder, ["2 runs", "half_width"])
    (folder / "parts" / next((other / "parts").glob("run.*")).name).unlink()
    shutil.copy(next((other / "parts").glob("frame.0001.*")), folder / "parts")
    refuses(folder, ["another run"])
    (folder / "parts" / next((other / "parts").glob("frame.0001.*")).name).unlink()
    shutil.copy(other / block.name, block)
    line = cli.error_line(innermap("join", folder, exit_code=1))
    assert "blocks are missing" in line or "changed since it was written" in line, line
    block.unlink()

    # A clock that runs behind plays no part.
    for path, day in zip(sorted(folder.rglob("*.*")), [1, 10**6] * 100):
        os.utime(path, (day * 86400, day * 86400))
    assert f"{len(parts) - 1} of them finished already" in \
        innermap(*VOXELIZE, "-o", "cut.vdb", "--share", "1/1").stdout
    innermap("join", folder, "-q")
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()


# Both on a disk that holds the blocks but for one, and then but for the file that is joined.
FULL_DISK = """
mount -t tmpfs -o size=100m none disk || exit 99
"$P" voxelize rod.obj --resolution 270 -q -o disk/cut.vdb --share 1/1 && rm disk/cut.vdb.shares/block.0002.vdb
used=$(df -k --output=used disk | tail -1)
mount -o remount,size=$((used + 8))k none disk
"$P" voxelize rod.obj --resolution 270 -q -o disk/cut.vdb --share 1/1; echo "share ends with $?"
ls -A disk disk/cut.vdb.shares
mount -o remount,size=100m none disk
"$P" voxelize rod.obj --resolution 270 -q -o disk/cut.vdb --share 1/1; echo "share ends with $?"
echo before > disk/cut.vdb
used=$(df -k --output=used disk | tail -1)
mount -o remount,size=$((used + 8))k none disk
"$P" join disk/cut.vdb.shares -q; echo "join ends with $?"
ls -A disk; cat disk/cut.vdb
mount -o remount,size=100m none disk
"$P" join disk/cut.vdb.shares -q; echo "join ends with $?"
cmp disk/cut.vdb whole.vdb && echo same
"""


def test_a_disk_that_is_full():
    rod_in_shares("other.vdb")
    innermap(*VOXELIZE, "-o", "whole.vdb")
    os.mkdir("disk")
    done = subprocess.run(["unshare", "-m" if os.geteuid() == 0 else "-rm", "sh", "-c", FULL_DISK],
                          env={**os.environ, "P": PROGRAM}, capture_output=True, text=True, check=False)
    if "ends with" not in done.stdout:
        raise cli.Skip(f"no disk of its own: {done.stderr}")
    said = done.stdout + done.stderr
    assert re.findall(r"(\w+) ends with (\d)", said) == [("share", "1"), ("share", "0"), ("join", "1"), ("join", "0")], \
        said
    assert "disk/cut.vdb.shares/block.0002.vdb" in done.stderr and "block 2" in done.stderr, said
    assert "innermap: disk/cut.vdb: " in done.stderr and "before" in done.stdout.splitlines(), said
    assert "same" in done.stdout.splitlines(), said
    assert not [name for name in done.stdout.split() if name.startswith(".")], said


def test_a_folder_that_is_deleted_meanwhile():
    rod_in_shares("cut.vdb")
    innermap(*VOXELIZE, "-o", "whole.vdb")
    Path("cut.vdb").write_text("before", encoding="ascii")
    failed = 0
    for command, seen in [([*VOXELIZE, "-o", "cut.vdb", "--share", "1/1"], "cut.vdb.shares"),
                          (["join", "cut.vdb.shares"], "block.")] * 3:
        if command[0] == "voxelize":
            shutil.rmtree("cut.vdb.shares", ignore_errors=True)
        worker = subprocess.Popen([PROGRAM, *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while worker.poll() is None and not is_at(worker.pid, seen):
            time.sleep(0.0005)
        if worker.poll() is None:
            worker.send_signal(signal.SIGSTOP)
            shutil.rmtree("cut.vdb.shares", ignore_errors=True)
            worker.send_signal(signal.SIGCONT)
        said = worker.communicate()[1]
        # Whichever it was at: it fails and names the folder, or had ended.
        assert worker.returncode == 0 or (worker.returncode == 1 and "cut.vdb" in said), said
        failed += worker.returncode
        if command[0] == "voxelize" or worker.returncode == 1:
            assert Path("cut.vdb").read_text(encoding="ascii") == "before"
        else:
            assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()
            Path("cut.vdb").write_text("before", encoding="ascii")
        assert not [name for name in os.listdir(".") if name.startswith(".")], os.listdir(".")
        innermap(*VOXELIZE, "-o", "cut.vdb", "--share", "1/1")
    assert failed > 0
    innermap("join", "cut.vdb.shares", "-q")
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()


def is_at(pid, name):
    """Whether a process has a file open that is called so."""
    try:
        return any(name in os.readlink(path) for path in Path(f"/proc/{pid}/fd").iterdir())
    except OSError:
        return False


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
    # What each command knows is handed on; what is of the whole run, to the last.
    innermap(*command, "-o", "out", "--jobs", "j.json", "--cpu-target", "avx2", "--max-memory=2GB", "--report", "r.json",
             "--strict", "--warn-folded", "0.5")
    words = [step["script"]["actions"]["onRun"]["args"][1] for step in cli.read_json("j.json")["steps"]]
    for text, having in [("--cpu-target avx2", [1, 1, 1]), ("--max-memory=2GB", [1, 1, 1]), ("--charges 300", [1, 0, 0]),
                         ("--resolution 270", [0, 1, 0]), ("--report r.json", [0, 0, 1]), ("--strict", [0, 0, 1]),
                         ("--warn-folded 0.5", [1, 1, 0])]:
        assert [int(text in word) for word in words] == having, (text, words)
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
    patient = {"timeout": 1500}  # a minute each on two idle cores
    innermap(*command, "-o", "whole.vdb", "--report", "whole.json", **patient)
    whole = cli.read_json("whole.json")["peak_memory_bytes"]
    for k in range(1, 17):
        innermap(*command, "-o", "cut.vdb", "--share", f"{k}/16", "--report", "part.json")
        assert cli.read_json("part.json")["peak_memory_bytes"] < whole / 8 + fixed, k
    innermap("join", "cut.vdb.shares", "-q", **patient)
    assert Path("cut.vdb").read_bytes() == Path("whole.vdb").read_bytes()


cli.run(globals())
