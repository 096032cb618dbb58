#!/usr/bin/env python3
"""Cancelling, once a mechanism: commands that write one file, a folder, and frames, two of each.

What is counted are stages that a run begins after the signal, not seconds, so that other work on the
machine does not matter. How soon each command ends, tests/nightly measures, with nothing beside it.
"""

import os
import shutil
import signal
import subprocess
import time

import cli
from cli import alone, innermap, nightly

# The stage that a signal meets may end, and the next may have begun when it comes.
MOST_STAGES_AFTER = 2


def stopped(*arguments, at, number=signal.SIGINT):
    """Runs innermap and signals it when it says its stage number `at`: (exit code, stages that it
    began after that)."""
    with subprocess.Popen([cli.PROGRAM, *map(str, arguments), "--verbose"],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        stream = process.stderr.fileno()
        begun = b""
        while begun.count(b"\n") < at:
            text = os.read(stream, 65536)  # all that there is
            if not text:
                break
            begun += text
        process.send_signal(number)
        try:
            said = process.communicate(timeout=120)[1].decode()
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    stages = [line for line in said.split("\n") if line and not line.startswith("innermap: ")]
    return process.returncode, len(stages)


def stops(arguments, judge, at=(1, 3), number=signal.SIGINT):
    for stage in at:
        code, after = stopped(*arguments, at=stage, number=number)
        assert code == 130, (arguments, stage, code)
        assert after <= MOST_STAGES_AFTER, (arguments, stage, after)
        judge()


def left(*expected):
    """A check that the folder holds these and nothing else."""
    return lambda: cli.no_leftovers(*expected)


def pair(subdivisions):
    vertices, faces = cli.icosphere_arrays(subdivisions)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("bent.obj", [(x, y, z + 0.2 * abs(x)) for x, y, z in vertices], faces)


def frames(subdivisions, count):
    vertices, faces = cli.icosphere_arrays(subdivisions)
    cli.write_obj("ball.obj", vertices, faces)
    os.mkdir("frames")
    for n in range(1, count + 1):
        cli.write_obj(f"frames/f.{n:04}.obj",
                      [(x, y, z * (1 + 0.01 * n) + 0.01 * n * x * x) for x, y, z in vertices], faces)


def test_commands_that_write_a_file():
    pair(4)
    stops(["voxelize", "ball.obj", "-o", "a.vdb", "--resolution", 800, "--half-width", 8, "--fog"],
          left("ball.obj", "bent.obj"), at=(1,))
    stops(["fit", "ball.obj", "bent.obj", "-o", "m.ply", "--tolerance", 1e-7],
          left("ball.obj", "bent.obj"), number=signal.SIGTERM)


def test_commands_that_write_a_folder():
    pair(4)
    stops(["map", "ball.obj", "bent.obj", "-o", "one/two", "--tolerance", 1e-6],
          left("ball.obj", "bent.obj"))
    innermap("fit", "ball.obj", "bent.obj", "-o", "m.ply", "--tolerance", 1e-2, "--quiet")
    stops(["transfer-distance", "m.ply", "-o", "out", "--resolution", 500],
          left("ball.obj", "bent.obj", "m.ply"), at=(1, 2), number=signal.SIGHUP)


def test_commands_that_write_frames():
    frames(3, 40)
    innermap("voxelize", "ball.obj", "-o", "in.vdb", "--resolution", 48, "--fog", "--quiet")

    def whole_frames():
        for name in os.listdir("out") if os.path.exists("out") else []:
            assert name.endswith(".vdb") and not name.startswith("."), name
            innermap("info", os.path.join("out", name))
        cli.no_leftovers("ball.obj", "in.vdb", "frames", "out")

    stops(["sequence", "ball.obj", "frames", "-o", "out", "--grids", "--charges", 600], whole_frames,
          at=(1, 9))
    stops(["deform", "ball.obj", "in.vdb", "frames", "-o", "out/d.vdb", "--charges", 600], whole_frames,
          at=(1, 9))


# Each takes some seconds at least.
LONG = [
    "voxelize ball.obj -o a.vdb --resolution 1500 --half-width 10 --fog",
    "correspond ball.obj bent.obj -o a.ply",
    "fit ball.obj bent.obj -o a.ply --tolerance 1e-7",
    "map ball.obj bent.obj -o out --charges 3000",
    "push m.ply in.vdb -o a.vdb --resolution 300 --density",
    "transfer-distance m.ply -o out --resolution 400",
    "tetrahedralize ball.obj -o a.vtu --resolution 256",
    "compare-fem ball.obj --functions -o out --resolutions 64,128",
    "hexahedralize ring.obj -o a.vtu",
    "texture coloured.obj -o a.vdb --resolution 400",
    "export in.vdb -o a.exr --resolution 900",
    "sequence ball.obj frames -o out --grids --charges 3500 --resolution 96",
    "deform ball.obj in.vdb frames -o out/d.vdb --charges 3500",
]


def interrupt(*arguments, after):
    """Starts innermap and signals it `after` seconds after its first line of progress; (exit code,
    seconds it took to end), or (None, 0) when it had ended by then."""
    process = subprocess.Popen([cli.PROGRAM, *arguments, "--verbose"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    process.stderr.readline()
    time.sleep(after)
    if process.poll() is not None:
        process.communicate()
        return None, 0.0
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    try:
        process.communicate(timeout=30)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    return process.returncode, time.monotonic() - start


@nightly
@alone
def test_each_command_ends_at_once():
    pair(5)
    frames(5, 30)
    cli.torus("ring.obj", n=90, m=36)
    with open("ball.obj", encoding="ascii") as plain, open("coloured.obj", "w", encoding="ascii") as file:
        for line in plain:
            file.write(line.strip() + (" 1 0.5 0\n" if line.startswith("v ") else "\n"))
    innermap("voxelize", "ball.obj", "-o", "in.vdb", "--resolution", 100, "--fog", "--quiet")
    innermap("fit", "ball.obj", "bent.obj", "-o", "m.ply", "--tolerance", 1e-2, "--quiet")
    inputs = os.listdir(".")
    for command in LONG:
        caught = 0
        for after in (0.1, 1.5):
            code, seconds = interrupt(*command.split(), after=after)
            for name in os.listdir("out") if os.path.exists("out") else []:
                assert "frames" in command and not name.startswith("."), (command, name)
                innermap("info", f"out/{name}")
            shutil.rmtree("out", ignore_errors=True)
            if code is None:
                break
            assert code == 130 and seconds < cli.AT_ONCE, (command, after, code, seconds)
            cli.no_leftovers(*inputs)
            caught += 1
        assert caught, f"too short to be interrupted: {command}"


cli.run(globals())
