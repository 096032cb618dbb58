#!/usr/bin/env python3
"""What a job shows of how far it is: on a terminal one bar, elsewhere lines."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios
import time

import cli
from cli import innermap


def pair():
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("egg.obj", [(1.4 * x + 0.1 * y * y, y, z) for x, y, z in vertices], faces)


def on_terminal(*arguments):
    """What a terminal is shown: (seconds, percent, label, what stands after the bar) of each bar."""
    ours, theirs = pty.openpty()
    start, seen = time.monotonic(), []
    with subprocess.Popen([cli.PROGRAM, *arguments], stderr=theirs, stdout=subprocess.DEVNULL,
                          env={**os.environ, "TERM": "xterm"}) as process:
        os.close(theirs)
        while True:
            try:
                text = os.read(ours, 65536).decode(errors="replace").replace("\r\x1b[K", "")
            except OSError:  # the other end is closed
                break
            for label, percent, rest in re.findall(r"\r(.+?) +\[=* *\] +(\d+)%([^\x1b\r]*)", text):
                seen.append((time.monotonic() - start, int(percent), label, rest.strip()))
    os.close(ours)
    assert process.returncode == 0
    return seen


def test_one_bar_that_never_runs_backwards():
    pair()
    for command in [["map", "ball.obj", "egg.obj", "-o", "out", "--tolerance", "1e-4", "--interpolation",
                     "linear", "--resolution", "96"],
                    ["evaluate", "out/map.ply", "-o", "a.vdb", "--resolution", "160"]]:
        bars = on_terminal(*command)
        assert len(bars) > 5, bars
        shown = [percent for _, percent, _, _ in bars]
        assert shown == sorted(shown) and shown[-1] > shown[0], shown
        assert all(re.fullmatch(r"|(\d+ h )?(\d+ min ?)?(\d+ s)? left", rest) for *_, rest in bars), bars
        labels = [label for i, (_, _, label, _) in enumerate(bars) if label != bars[i - 1][2]]
        assert len(set(labels)) == len(labels) >= 2, labels  # none comes twice


def test_lines_carry_seconds():
    pair()
    job = ["map", "ball.obj", "egg.obj", "-o", "out", "--resolution", "32"]
    assert not re.search(r"^ *\d+\.\d s ", innermap(*job).stderr, re.M)  # only every ten seconds
    done = innermap(*job, "--verbose")
    lines = [line for line in done.stderr.split("\n") if line and not line.startswith("innermap: ")]
    found = [re.fullmatch(r" *(\d+\.\d) s  (\w.*)", line) for line in lines]
    assert all(found) and len(found) >= 3, lines
    seconds = [float(m.group(1)) for m in found]
    assert seconds == sorted(seconds), seconds


def test_report_says_what_the_stages_took():
    pair()
    innermap("map", "ball.obj", "egg.obj", "-o", "out", "--resolution", "32", "--quiet")
    stages = cli.read_json("out/report.json")["stages"]
    columns = {key: column for key, column in stages.items() if isinstance(column, list)}
    assert len({len(column) for column in columns.values()}) == 1, columns
    assert {"level set", "evaluating the map", "writing slices"} <= set(stages["work"]), stages["work"]
    assert all(s >= 0 for s in stages["seconds"]) and sum(stages["core_seconds"]) > 0, stages
    assert min(stages["block_seconds"], *stages["times"]) > 0, stages


def test_dry_run_says_seconds_that_include_the_fit():
    pair()
    few, many = (cli.dry_run("map", "ball.obj", "egg.obj", "-o", "out", "--charges", charges).seconds
                 for charges in (100, 20000))
    assert many > few >= 1, (few, many)


def test_every_long_command_says_seconds_that_can_be_told():
    pair()
    innermap("fit", "ball.obj", "egg.obj", "-o", "map.ply")
    innermap("evaluate", "map.ply", "-o", "map.vdb", "--resolution", "24")
    # Few cells: where a machine is slow, half of a remesh of many is doubtful.
    innermap("tetrahedralize", "ball.obj", "-o", "cells.vtu", "--resolution", "12")
    for number in (1, 2):
        vertices, faces = cli.icosphere_arrays(3)
        cli.write_obj(f"frame.{number}.obj", [(x, (1 + 0.1 * number) * y, z) for x, y, z in vertices],
                      faces)
    vertices, faces = cli.icosphere_arrays(3)
    with open("coloured.obj", "w") as file:
        for x, y, z in vertices:
            file.write(f"v {x} {y} {z} {(x + 1) / 2} {(y + 1) / 2} {(z + 1) / 2}\n")
        for face in faces:
            file.write("f " + " ".join(str(v + 1) for v in face) + "\n")
    frames = "frame.*.obj"
    for command in [["evaluate", "map.ply", "-o", "a.vdb"],
                    ["push", "map.ply", "map.vdb", "-o", "a.vdb", "--grids", "density"],
                    ["push", "map.ply", "map.vdb", "-o", "a.vdb", "--grids", "density", "--density"],
                    ["pull", "map.ply", "map.vdb", "-o", "a.vdb", "--grids", "density"],
                    ["transfer-distance", "map.ply", "-o", "out"],
                    ["sequence", "ball.obj", frames, "-o", "out"],
                    ["deform", "ball.obj", "map.vdb", frames, "-o", "out/a.##.vdb"],
                    ["deform", "ball.obj", "cells.vtu", frames, "-o", "out/a.##.vtu"],
                    ["texture", "coloured.obj", "-o", "a.vdb"],
                    ["harmonic", "coloured.obj", "--vertex-colours", "-o", "a.vdb"],
                    ["correspond", "ball.obj", "egg.obj", "-o", "a.ply"],
                    ["tetrahedralize", "ball.obj", "-o", "a.vtu"],
                    ["remesh", "map.ply", "cells.vtu", "-o", "a.vtu"],
                    ["hexahedralize", "ball.obj", "-o", "a.vtu"],
                    ["study", "ball.obj", "egg.obj", "-o", "out"],
                    ["fit", "ball.obj", "egg.obj", "-o", "a.ply"]]:
        # How long the runs of a study take is not known within a factor of two.
        assert (cli.dry_run(*command).seconds is None) == (command[0] == "study"), command


def test_more_voxels_are_said_to_take_longer():
    pair()
    innermap("fit", "ball.obj", "egg.obj", "-o", "map.ply")
    said = []
    for resolution in ["64", "1024"]:
        said.append(cli.dry_run("evaluate", "map.ply", "-o", "a.vdb", "--resolution", resolution,
                                "--max-memory", "100GB").seconds)
    assert said[1] > said[0], said


def test_each_stage_of_a_plan_has_a_weight():
    folder = cli.ROOT / "tools" / "innermap"
    text = "".join(path.read_text() for path in sorted(folder.rglob("*.cc")))
    named = set()
    for call in re.findall(r"(?:stageOf\(|stage :\s+\{)([^;]*?)(?:, \w|\})", text):
        named.update(re.findall(r'"([^"]+)"', call))
    weighed = set(re.findall(r'\{"([^"]+)"', (folder / "stage_weights.inc").read_text()))
    assert len(named) > 50, named
    assert named == weighed, named ^ weighed
    # And something reports it, or a run would never come to it.
    sources = [*(cli.ROOT / "lib").rglob("*.[ch]*"), *folder.rglob("*.cc")]
    told = "".join(line for path in sources for line in path.read_text().splitlines()
                   if "stageOf(" not in line)
    assert [name for name in sorted(named) if f'"{name.split(":")[0]}"' not in told] == []


def shown(columns, *arguments, **more):
    """All that a terminal of so many columns is shown, without the bar, and whether the run succeeded."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    with subprocess.Popen([cli.PROGRAM, *arguments], stderr=theirs, stdout=theirs,
                          env={**environment, "TERM": "xterm", **more}):
        os.close(theirs)
        text = b""
        while True:
            try:
                text += os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
    os.close(ours)
    return [line.split("\x1b[K")[-1] for line in text.decode().replace("\r\n", "\n").split("\n")]


def test_a_run_ends_within_the_terminal():
    pair()
    colour = re.compile(r"\x1b\[[0-9;]*m")
    arguments = ("fit", "ball.obj", "egg.obj", "-o", "map.ply", "--charges", "300", "--threads", "1")
    for columns in (80, 50):
        lines = shown(columns, *arguments)
        assert any(colour.search(line) for line in lines), lines
        plain = [colour.sub("", line) for line in lines]
        assert max(map(len, plain)) <= columns, plain
        assert len(plain) <= (24 if columns == 80 else 40), plain
        assert any("map.ply" in line for line in plain[-3:]), plain
        assert plain == shown(columns, *arguments, NO_COLOR="1") == shown(columns, *arguments, TERM="dumb")[-len(plain):]
    # A pipe gets the same words, each finding on a line of its own, without colours.
    piped = innermap(*arguments).stdout
    assert "\x1b" not in piped
    assert " ".join(piped.split()) in " ".join(" ".join(plain).split())


cli.run(globals())
