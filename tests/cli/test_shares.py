#!/usr/bin/env python3
"""Shares of a run and innermap join."""

import csv
import json
import os
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import cli
import slurm
from cli import PROGRAM, fails, innermap, nightly
from frames import ball_frames, break_frame, twisted

SMALL = ["--charges", "200", "--resolution", "12", "--quiet"]
COMMAND = ["sequence", "rest.obj", "frames/*.obj"]
# Differ from run to run: times, memory, and how the shares were made.
PASSING = {"seconds", "date", "peak_memory_bytes", "memory_after_bytes", "stages", "farm", "host"}


def make_frames(count):
    ball_frames(twisted, {n: 0.05 * n for n in range(1, count + 1)}, subdivisions=2)


def table(folder):
    with open(Path(folder) / "energies.csv", encoding="utf-8", newline="") as file:
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]


def figures(folder):
    report = {k: v for k, v in cli.read_json(Path(folder) / "report.json").items() if k not in PASSING}
    report["energies"].pop("seconds")
    for key in [key for key in report["frames"] if key.startswith("seconds")]:
        report["frames"].pop(key)
    report["outputs"] = [output for output in report["outputs"] if not output["path"].endswith(".html")]
    for output in report["outputs"]:  # the table's seconds have more or fewer digits
        if output["path"].endswith(".csv"):
            output.pop("bytes")
    line = report["command_line"]
    if "--threads" in line:
        del line[line.index("--threads"):line.index("--threads") + 2]
    text = json.dumps(report)
    return text.replace(str(folder), "FOLDER")


def assert_same(one, other):
    assert table(one) == table(other)
    assert (Path(one) / "energies.svg").read_bytes() == (Path(other) / "energies.svg").read_bytes()
    assert figures(one) == figures(other), f"{figures(one)}\n{figures(other)}"
    for grid in Path(one).glob("*.vdb"):
        assert grid.read_bytes() == (Path(other) / grid.name).read_bytes(), grid


def share(text, folder, *more, **options):
    return innermap(*COMMAND, "-o", folder, *SMALL, "--share", text, *more, **options)


def test_the_joined_shares_are_one_run():
    make_frames(5)
    one = innermap(*COMMAND, "-o", "whole", *SMALL, "--grids", "--warn-folded", "0.01", "--prove", "core").stdout
    for text in ["3/3", "1/3", "2/3"]:
        innermap(*COMMAND, "-o", "cut", *SMALL, "--grids", "--warn-folded", "0.01", "--prove", "core", "--share", text)
    assert not Path("cut/report.json").exists()
    joined = innermap("join", "cut", "-q", "--html").stdout
    strip = lambda text: [line for line in text.splitlines() if not line.startswith("seconds")]
    assert strip(joined) == strip(one), (joined, one)
    assert_same("whole", "cut")
    report = cli.read_json("cut/report.json")
    assert sum(report["farm"]["host_frames"]) == 5 and len(report["farm"]["code"]) == 1
    assert "--share" not in report["command_line"] and report["settings"]["share"] is None
    assert "f.0003" in Path("cut/report.html").read_text(encoding="utf-8")
    again = innermap("join", "cut")
    assert "replaces" not in again.stderr and "other files" not in again.stderr, again.stderr
    assert_same("whole", "cut")


def test_finished_frames_are_not_made_again():
    make_frames(3)
    share("1/1", "out", "--grids")
    before = {path: path.stat().st_mtime_ns for path in Path("out").rglob("*.*")}
    done = share("1/2", "out", "--grids")
    assert "1 of them finished already" in done.stdout, done.stdout
    assert before == {path: path.stat().st_mtime_ns for path in Path("out").rglob("*.*")}
    os.truncate("out/energy.0002.vdb", 100)
    innermap("join", "out", exit_code=1)
    done = share("2/2", "out", "--grids")
    assert "1 of them finished already" in done.stdout, done.stdout
    innermap("join", "out", "-q")


def test_missing_frames_are_named():
    make_frames(4)
    fails(1, "join", "out", says=["out", "--share"])
    share("1/4", "out")
    share("3/4", "out")
    fails(1, "join", "out", says=["2 of 4", "2, 4", "--partial"])
    assert not Path("out/energies.csv").exists()
    done = innermap("join", "out", "--partial")
    assert "2 of 4" in done.stderr and [row["frame"] for row in table("out")] == ["1", "3"]
    assert cli.read_json("out/report.json")["frames"]["left"] == 2
    share("4/9", "out")  # has none
    share("auto", "out", env={**os.environ, "CUE_IFRAME": "3", "CUE_RANGE": "3-5x2"})
    share("2/2", "out")
    innermap("join", "out")
    assert len(table("out")) == 4


def test_broken_frames_are_told_of_as_in_one_run():
    make_frames(4)
    break_frame("frames/f.0002.obj")
    innermap(*COMMAND, "-o", "whole", *SMALL, exit_code=1)
    share("1/2", "cut", exit_code=1)
    share("2/2", "cut")
    fails(1, "join", "cut", says=["1 of 4", "2"])
    assert_same("whole", "cut")
    shutil.copy("frames/f.0001.obj", "frames/f.0002.obj")  # mended, and made again
    share("1/2", "cut")
    innermap("join", "cut")


def test_shares_that_cannot_be():
    make_frames(2)
    for text in ["0/0", "5/4", "0/4", "1/0", "-1/4", "3", "a/b", "1/2/3", "1 /2", "1/9999999", "1/1e3",
                 "99999999999999999999/2", ""]:
        if text:
            fails(1, *COMMAND, "-o", "out", "--share", text, says=["--share", text.split("/")[0]])
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("SLURM_", "CUE_"))}
    fails(1, *COMMAND, "-o", "out", "--share", "auto", env=clean, says=["SLURM_ARRAY_TASK_ID"])
    slurm = {"SLURM_ARRAY_TASK_ID": "3", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "5",
             "SLURM_ARRAY_TASK_STEP": "2", "SLURM_ARRAY_TASK_COUNT": "3"}
    done = innermap(*COMMAND, "-o", "out", *SMALL, "--share", "auto", env={**clean, **slurm})
    assert "share 2/3" in done.stdout
    for key, value in [("ID", "4"), ("ID", "x"), ("MAX", "0"), ("COUNT", "2"), ("STEP", "0"),
                       ("MIN", "4"), ("MAX", "999999999999")]:
        fails(1, *COMMAND, "-o", "out", "--share", "auto", says=["auto"],
              env={**clean, **slurm, "SLURM_ARRAY_TASK_" + key: value})
    for frame, text in [("3", "4-5"), ("3", "x"), ("", "1-5"), ("3", "1-5x0"), ("2", "1-5x2")]:
        fails(1, *COMMAND, "-o", "out", "--share", "auto", says=["OpenCue"],
              env={**clean, "CUE_IFRAME": frame, "CUE_RANGE": text})
    fails(1, *COMMAND, "-o", "out", "--cpu-target", "z80", says=["--cpu-target", "avx2"])
    # People have arrays of their own.
    innermap(*COMMAND, "-o", "own", *SMALL, env={**clean, **slurm})
    assert len(table("own")) == 2
    fails(2, *COMMAND, "-o", "out", "--share", "1/2", "--html", says=["--html", "join"])


def test_parts_that_do_not_belong_together():
    make_frames(3)
    share("1/3", "out")
    fails(1, *COMMAND, "-o", "out", *SMALL, "--share", "2/3", "--tolerance", "0.1",
          says=["another run", "tolerance", "0.1", "--output"])
    fails(1, *COMMAND, "-o", "out", *SMALL, "--share", "2/3", "--frames", "1-2", says=["frames"])
    innermap(*COMMAND, "-o", "other", *SMALL, "--share", "1/1", "--tolerance", "0.1")
    shutil.copytree("out", "mixed")
    for part in Path("other/parts").iterdir():
        shutil.copy(part, "mixed/parts")
    fails(1, "join", "mixed", says=["2 runs", "tolerance"])
    next(Path("mixed/parts").glob("run.*")).unlink()
    fails(1, "join", "mixed", says=["another run"])
    share("2/3", "out")
    share("3/3", "out")
    innermap("join", "out")
    part = next(Path("out/parts").glob("frame.0002.*"))
    whole = part.read_text(encoding="utf-8")
    for damaged, says in [(whole[:len(whole) // 2], "cut off"), ("", "cut off"), ("[]", "cut off"),
                          (whole.replace('"harmonic",\n', '"harmonix",\n'), "changed since it was written"),
                          ("[" * 5000, "cut off")]:
        part.write_text(damaged, encoding="utf-8")
        fails(1, "join", "out", says=[part.name, says])
    share("2/3", "out")  # a damaged part is made again
    innermap("join", "out")
    run = next(Path("out/parts").glob("run.*"))
    good = run.read_text(encoding="utf-8")
    run.write_text(good.replace('"version": "', '"version": "0.'), encoding="utf-8")
    fails(1, "join", "out", says=["use that version"])


def test_a_clock_that_runs_behind_plays_no_part():
    make_frames(3)
    share("1/2", "cut")
    for path, day in zip(Path("cut/parts").iterdir(), [1, 10**6]):
        os.utime(path, (day * 86400, day * 86400))
    assert "1 of them finished already" in share("1/2", "cut").stdout
    share("2/2", "cut")
    innermap(*COMMAND, "-o", "whole", *SMALL)
    innermap("join", "cut", "-q")
    assert_same("whole", "cut")


def test_a_disk_that_is_full_and_a_folder_that_is_deleted():
    make_frames(3)
    innermap(*COMMAND, "-o", "whole", *SMALL, "--grids")
    share("1/3", "cut", "--grids")
    size = Path("cut/energy.0001.vdb").stat().st_size
    fails(1, *COMMAND, "-o", "cut", *SMALL, "--grids", "--share", "2/3", says=["cut/energy.0002.vdb", "frame 2"],
          preexec_fn=cli.file_size_limit(size // 2))
    assert sorted(os.listdir("cut")) == ["energy.0001.vdb", "parts"]
    fails(1, "join", "cut", says=["2 of 3", "2, 3"])
    worker = subprocess.Popen([PROGRAM, *COMMAND, "-o", "cut", *SMALL, "--grids", "--share", "1/1"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while len(list(Path("cut/parts").glob("frame.*"))) < 2 and worker.poll() is None:
        time.sleep(0.01)
    shutil.rmtree("cut", ignore_errors=True)
    said = worker.communicate()[1]
    # Whichever it was at: it fails and names the folder, or had ended.
    assert worker.returncode == 0 or (worker.returncode == 1 and "cut" in said), said
    share("1/1", "cut", "--grids")
    innermap("join", "cut", "-q")
    assert_same("whole", "cut")


def test_restarts_and_failures_are_told_of():
    make_frames(4)
    break_frame("frames/f.0002.obj")
    share("1/2", "cut", exit_code=1)
    shutil.copy("frames/f.0001.obj", "frames/f.0002.obj")
    share("1/2", "cut", env={**os.environ, "SLURM_RESTART_COUNT": "2"})
    share("2/2", "cut", env={**os.environ, "SLURM_RESTART_COUNT": "x"})
    innermap("join", "cut")
    farm = cli.read_json("cut/report.json")["farm"]
    assert farm["restarted"] == 1 and farm["failed_tries"] == 1, farm


def test_workers_that_disagree():
    make_frames(2)
    share("1/1", "out")
    # The frame is changed under a worker: both parts are whole, and of one run.
    shutil.copy("frames/f.0001.obj", "frames/f.0002.obj")
    share("2/2", "out")
    fails(1, "join", "out", says=["frame 2", "twice", "changed in between"])
    make_frames(2)
    for part in sorted(Path("out/parts").glob("frame.0002.*")):
        text = json.loads(part.read_text(encoding="utf-8"))
        if text["result"]["input"] != "":
            text["made"].update(host="elsewhere", code="OTHER")
            part.write_text(json.dumps(text), encoding="utf-8")
            other = part
    for part in sorted(Path("out/parts").glob("frame.0002.*")):
        if part != other:
            part.unlink()
    assert "elsewhere" in innermap("join", "out").stderr  # a mix is named


def test_shares_of_deform():
    make_frames(5)
    innermap("voxelize", "rest.obj", "-o", "smoke.vdb", "--resolution", "12")
    command = ["deform", "rest.obj", "smoke.vdb", "frames/*.obj", "--charges", "200", "--velocity"]
    innermap(*command, "-o", "whole/s.####.vdb")
    for text in ["2/2", "1/2", "5/9"]:
        innermap(*command, "-o", "cut/s.####.vdb", "--share", text)
    assert sorted(os.listdir("cut")) == sorted(os.listdir("whole"))
    for grid in Path("whole").iterdir():
        assert grid.read_bytes() == (Path("cut") / grid.name).read_bytes(), grid
    fails(2, "deform", "rest.obj", "rest.obj", "frames/*.obj", "-o", "all.pc2", "--share", "1/2",
          says=["one file"])
    fails(1, "join", "cut", says=["--share"])


def test_shares_of_a_study():
    make_frames(1)
    command = ["study", "rest.obj", "frames/f.0001.obj", "--charges", "50,100", "--points", "2,4",
               "--distances", "0.05", "--radius-ratios", "none", "--grid", "none", "--resolution", "8"]
    innermap(*command, "-o", "whole")
    for text in ["2/2", "1/2"]:
        told = innermap(*command, "-o", "cut", "--share", text).stdout
        assert os.listdir("cut") == ["runs"], told
    made = innermap(*command, "-o", "cut").stdout
    rows = {}
    for folder in ["whole", "cut"]:
        with open(f"{folder}/study.csv", encoding="utf-8", newline="") as file:
            rows[folder] = [{k: v for k, v in row.items() if "seconds" not in k and k != "kept"}
                            for row in csv.DictReader(file)]
    assert rows["whole"] == rows["cut"] and len(rows["cut"]) > 2, made
    assert cli.read_json("cut/report.json")["study"]["made"] == 0
    fails(1, *command, "-o", "x", "--share", "3/2", says=["--share"])
    told = innermap(*command, "-o", "jobs", "--jobs", "study.json", "--tasks", "2").stdout
    assert f"2 shares of {len(rows['cut'])} runs" in told and not Path("jobs").exists(), told
    words = [step["script"]["actions"]["onRun"]["args"][1] for step in cli.read_json("study.json")["steps"]]
    assert " --share " in words[0] and words[0].startswith(words[1]), words


def test_jobs_make_the_run():
    make_frames(5)
    os.makedirs("it's here")
    for name in ["rest.obj", "frames"]:
        shutil.move(name, "it's here")
    os.chdir("it's here")
    innermap(*COMMAND, "-o", "whole", *SMALL)
    told = innermap(*COMMAND, "-o", "cut", *SMALL, "--jobs", "jobs.txt", "--tasks", "3").stdout
    assert "3 shares of 5 frames" in told and not Path("cut").exists()
    lines = Path("jobs.txt").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 3
    os.chdir("/")
    for line in lines:
        subprocess.run(["sh", "-c", line], check=True, capture_output=True)
    os.chdir(lines[0][len("cd '"):lines[0].index("' &&")].replace("'\\''", "'"))
    innermap("join", "cut")
    assert_same("whole", "cut")
    innermap(*COMMAND, "-o", "cut2", *SMALL, "--jobs=jobs.sh", "--tasks=2")
    innermap(*COMMAND, "-o", "cut3", *SMALL, "--jobs", "jobs.json")
    # Slurm as a stand-in, which runs each task at once.
    Path("sbatch").write_text("""#!/bin/sh
for word; do case $word in --array=1-*) last=${word#--array=1-};; esac; wrapped=$word; done
for id in $(seq ${last:-1}); do SLURM_ARRAY_TASK_ID=$id sh -c "$wrapped" >&2 || exit 1; done
echo 17
""", encoding="utf-8")
    os.chmod("sbatch", 0o755)
    done = subprocess.run(["./jobs.sh", "--partition=day"], check=True, capture_output=True, text=True,
                          env={**os.environ, "PATH": os.getcwd() + ":" + os.environ["PATH"]})
    assert done.stdout == "array 17, join 17\n"
    assert_same("whole", "cut2")
    template = cli.read_json("jobs.json")
    assert [step["name"] for step in template["steps"]] == ["Shares", "Join"]
    for step in template["steps"]:
        run = step["script"]["actions"]["onRun"]
        words = [word.replace("{{Task.Param.Share}}", "1") for word in run["args"]]
        subprocess.run([run["command"], *words], check=True, capture_output=True)
    assert_same("whole", "cut3")
    check = cli.ROOT.parent / "shared" / "hosts" / "openjd_check.py"
    if check.exists():
        subprocess.run([sys.executable, check, "jobs.json"], check=True)
    fails(1, *COMMAND, "-o", "a", "--jobs", "jobs.py", says=["--jobs", ".txt", "OpenJD"])
    fails(2, *COMMAND, "-o", "a", "--jobs", "j.txt", "--share", "1/2", says=["--share"])
    fails(2, *COMMAND, "-o", "a", "--tasks", "3", says=["--jobs"])
    fails(1, *COMMAND, "-o", "a\nb", "--jobs", "j.txt", says=["line break"])


def random_run(seed, count, whole):
    """Cuts a run at random, kills some workers, starts others twice; then ends what is left."""
    rand = random.Random(seed)
    folder = f"cut{seed}"
    of = rand.randint(1, count + 2)
    shares = [f"{k}/{of}" for k in range(1, of + 1) if rand.random() < 0.8]
    shares += [rand.choice(shares)] if shares else []
    workers = [subprocess.Popen([PROGRAM, *COMMAND, "-o", folder, *SMALL, "--grids", "--threads", "1",
                                 "--share", text], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for text in shares]
    time.sleep(rand.random() * 0.4)
    killed = [worker for worker in workers if rand.random() < 0.5]
    for worker in killed:
        worker.kill()
    joined = subprocess.run([PROGRAM, "join", folder, "-q"], capture_output=True, text=True, check=False)
    for worker in workers:
        worker.wait()
    if joined.returncode == 0:
        assert_same(whole, folder)
    else:
        assert "are missing" in joined.stderr or "no parts" in joined.stderr or \
            "is not there" in joined.stderr, joined.stderr
    again = rand.randint(1, count)
    for k in range(1, again + 1):
        innermap(*COMMAND, "-o", folder, *SMALL, "--grids", "--share", f"{k}/{again}")
    innermap("join", folder, "-q")
    assert_same(whole, folder)
    # Whoever makes the frame next removes what a killed worker had begun; nobody does where a twin had made it.
    left = [name for name in os.listdir(folder) + os.listdir(folder + "/parts")
            if name.startswith(".") and not any(f"-{worker.pid}-" in name for worker in killed)]
    assert not left, left
    shutil.rmtree(folder)


def random_runs(number):
    seed = int(os.environ.get("INNERMAP_TEST_SEED", random.randrange(10**6)))
    print(f"INNERMAP_TEST_SEED={seed}", file=sys.stderr)
    make_frames(4)
    innermap(*COMMAND, "-o", "whole", *SMALL, "--grids")
    for i in range(number):
        random_run(seed + i, 4, "whole")


def test_random_cuts_and_kills():
    random_runs(4)


@nightly
def test_slurm_ends_a_run_whose_node_is_killed():
    make_frames(24)
    innermap(*COMMAND, "-o", "whole", *SMALL, "--grids", "--threads", "1")
    with slurm.running("slurm") as farm:
        innermap(*COMMAND, "-o", "cut", *SMALL, "--grids", "--threads", "1", "--jobs", "jobs.sh",
                 "--tasks", "24")
        job = farm.run("./jobs.sh", "--mem=100", "--output=/dev/null").split()[-1]
        farm.wait(lambda: len(list(Path("cut/parts").glob("frame.*"))) > 3 and len(farm.steps("n2")) > 1, 60,
                  "frames, and a task on n2")
        farm.kill_node("n2")
        farm.wait(lambda: not farm.run("squeue", "-h", "-o", "%i").split(), 300, f"job {job} to end")
    assert_same("whole", "cut")


@nightly
def test_parallel_ends_a_run_whose_worker_is_killed():
    if not shutil.which("parallel"):
        raise cli.Skip("no parallel")
    make_frames(12)
    innermap(*COMMAND, "-o", "whole", *SMALL, "--grids", "--threads", "1")
    innermap(*COMMAND, "-o", "cut", *SMALL, "--grids", "--threads", "1", "--jobs", "jobs.txt", "--tasks", "6")
    lines = Path("jobs.txt").read_text(encoding="utf-8").splitlines()
    # The first attempt at one task kills itself.
    lines[2] = f"if mkdir once; then (sleep 0.3; kill -9 $$) & {lines[2]}; sleep 1; else {lines[2]}; fi"
    done = subprocess.run(["parallel", "-j2", "--retries", "3", "--joblog", "log"],
                          input="\n".join(lines) + "\n", text=True, capture_output=True, check=False)
    assert done.returncode == 0 and Path("once").exists(), done.stderr
    innermap("join", "cut")
    assert_same("whole", "cut")


@nightly
def test_two_hundred_random_cuts_and_kills():
    random_runs(200)


cli.run(globals())
