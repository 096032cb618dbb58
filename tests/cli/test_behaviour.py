#!/usr/bin/env python3
"""What holds for every command: quiet, dry run, report, limits, full disks, cancelling."""

import json
import os
import resource
import subprocess

import cli
from cli import cube, fails, file_size_limit, icosphere, innermap, no_leftovers


def test_quiet_says_nothing_and_progress_is_plain_lines():
    cube()
    done = innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16", "--quiet")
    assert done.stdout == "" and done.stderr == "", done
    done = innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16")
    assert done.stdout == ""
    assert done.stderr and "\r" not in done.stderr and "\x1b" not in done.stderr
    stages = done.stderr.strip().split("\n")
    assert len(set(stages)) == len(stages), stages


def test_json_is_the_report_on_stdout():
    cube()
    done = innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16", "--json", "--report",
                    "r.json")
    told, written = json.loads(done.stdout), cli.read_json("r.json")
    for report in (told, written):
        for key in ("seconds", "stages", "memory_after_bytes", "peak_memory_bytes", "outputs"):
            report.pop(key)
    assert told == written and told["grid"]["active_voxels"] > 0
    planned = json.loads(innermap("voxelize", "cube.obj", "-o", "a.vdb", "--dry-run", "--json").stdout)
    assert planned["dry_run"] and planned["memory_needed_bytes"] > 0


def test_dry_run_writes_nothing_and_tells_the_memory():
    cube()
    for command in [["voxelize", "cube.obj", "-o", "a.vdb"], ["check", "cube.obj"],
                    ["info", "cube.obj"]]:
        assert cli.dry_run(*command, "--report", "r.json").memory > 1e6
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16")
    done = innermap("slice", "a.vdb", "-o", "s.exr", "--picture", "p.png", "--dry-run")
    assert "s.exr" in done.stdout and "p.png" in done.stdout
    no_leftovers("cube.obj", "a.vdb")


def test_report_holds_times_and_memory():
    cube()
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16", "--report", "r.json")
    report = cli.read_json("r.json")
    assert report["command"] == "voxelize"
    assert report["source"]["triangles"] == 12
    assert abs(report["source"]["volume"] - 1) < 1e-9
    assert report["grid"]["active_voxels"] > 0
    assert all(s >= 0 for s in report["seconds"].values()) and "write" in report["seconds"]
    assert report["peak_memory_bytes"] > 1e6


def test_too_much_memory_is_refused_before_it_is_used():
    icosphere()
    fails(1, "voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "2000", "--max-memory", "500MB",
          says=["--voxel-size"])


def test_outputs_that_cannot_be_written():
    cube()
    os.mkdir("folder")
    for path in ["missing/a.vdb", "folder"]:
        line = fails(1, "voxelize", "cube.obj", "-o", path)
        assert path.split("/")[0] in line
    fails(1, "check", "cube.obj", "--report", "missing/r.json", says=["missing/r.json"])
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16", "--quiet")
    fails(1, "slice", "a.vdb", "-o", "missing/s.exr", says=["missing/s.exr"])
    fails(1, "slice", "a.vdb", "--picture", "missing/p.png", says=["missing/p.png"])
    if os.geteuid() != 0:
        os.chmod("folder", 0o500)
        fails(1, "voxelize", "cube.obj", "-o", "folder/a.vdb", says=["folder/a.vdb"])


def test_full_disk():
    icosphere()
    for size in [0, 1000, 20000]:
        fails(1, "voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "64", says=["a.vdb"],
              preexec_fn=file_size_limit(size))
    innermap("voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "64", "--quiet")
    for size in [0, 1000, 20000]:
        fails(1, "slice", "a.vdb", "-o", "s.exr", says=["s.exr"], preexec_fn=file_size_limit(size))
        fails(1, "slice", "a.vdb", "--picture", "p.png", says=["p.png"],
              preexec_fn=file_size_limit(size))
    if os.path.exists("/dev/full"):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([cli.PROGRAM, "check", "ball.obj"], stdout=full,
                                  stderr=subprocess.PIPE, text=True)
        assert done.returncode == 1 and cli.error_line(done), done


def test_a_failure_keeps_the_file_that_was_there():
    icosphere()
    innermap("voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "20", "--quiet")
    before = cli.read_file("a.vdb")
    fails(1, "voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "64",
          preexec_fn=file_size_limit(20000))
    with open("a.vdb", "rb") as file:
        assert file.read() == before


def test_a_limit_on_address_space_is_no_trap():
    # OpenBLAS waits for ever where it cannot map its buffers, of 32 MB a thread: that must not be reached.
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("bent.obj", [(1.3 * x, y + 0.2 * x * x, z) for x, y, z in vertices], faces)
    said = set()
    for size in [*range(450, 1000, 50), 1000, 1200, 1500, 2000, 4000]:
        limit = size << 20
        done = subprocess.run([cli.PROGRAM, "fit", "ball.obj", "bent.obj", "-o", "m.ply", "-q",
                               "--charges", "800", "--threads", "4", "--best-effort"],
                              capture_output=True, text=True, timeout=120,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS,
                                                                    (limit, limit)))
        if done.returncode == 0:
            os.remove("m.ply")
            said.add("done")
            continue
        if done.returncode == 127:
            continue  # not even its libraries could be loaded
        assert done.returncode == 1 and cli.error_line(done), done
        said.add("address space" if "ulimit -v" in done.stderr else "memory")
        no_leftovers("ball.obj", "bent.obj")
    assert {"done", "address space"} <= said, said


def test_broken_pipe_is_an_error_not_a_crash():
    icosphere()
    process = subprocess.Popen([cli.PROGRAM, "check", "ball.obj", "--json"],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    process.stderr.read()
    process.stderr.close()
    assert process.wait(60) in (0, 1)


cli.run(globals())
