#!/usr/bin/env python3
"""Outputs never replace what they should not, and what cannot be written is said before the work."""

import os
import signal
import stat
import subprocess
import threading

import cli
from cli import cube, fails, icosphere, innermap, no_leftovers


def grids(path="a.vdb"):
    cube()
    innermap("voxelize", "cube.obj", "-o", path, "--resolution", "12", "-q")


def pair():
    vertices, faces = cli.icosphere_arrays(2)
    cli.write_obj("ball.obj", vertices, faces)
    cli.write_obj("egg.obj", [(1.3 * x, y, z) for x, y, z in vertices], faces)


def test_an_output_is_no_input():
    grids("g.vdb")
    os.link("cube.obj", "hard.obj")
    os.link("cube.obj", "hard.vdb")
    for name in ["soft.png", "soft.exr"]:
        os.symlink("g.vdb", name)
    before = cli.read_file("cube.obj"), cli.read_file("g.vdb")
    for command in [["voxelize", "cube.obj", "-o", "hard.vdb"],
                    ["voxelize", "hard.obj", "-o", "./../" + os.path.basename(os.getcwd()) + "/hard.vdb"],
                    ["voxelize", "cube.obj", "-o", "a.vdb", "--report", "hard.obj"],
                    ["voxelize", "cube.obj", "-o", "a.vdb", "--report", "cube.obj"],
                    ["check", "cube.obj", "--report", "cube.obj"],
                    ["slice", "g.vdb", "--picture", "soft.png"],
                    ["slice", "g.vdb", "-o", "soft.exr"],
                    ["export", "g.vdb", "-o", "soft.exr"],
                    ["sphere", "cube.obj", "-o", "cube.ply", "--report", "cube.obj"],
                    ["voxelize", "cube.obj", "-o", "hard.vdb", "--dry-run"]]:
        fails(1, *command)
    assert before == (cli.read_file("cube.obj"), cli.read_file("g.vdb"))


def test_an_output_is_no_input_of_those_found_by_name_or_option():
    pair()
    os.mkdir("frames")
    for number in (1, 2):
        os.rename("egg.obj" if number == 1 else "ball2.obj", f"frames/f.{number:04}.obj")
        if number == 1:
            icosphere("ball2.obj")
    fails(1, "deform", "ball.obj", "ball.obj", "frames", "-o", "frames/f.####.obj",
          says=["frames/f.0001.obj"])
    fails(1, "sequence", "ball.obj", "frames", "-o", "out", "--report", "frames/f.0002.obj",
          says=["frames/f.0002.obj"])
    cli.write_file("pairs.txt", "")
    os.link("pairs.txt", "pairs.png")
    fails(1, "correspond", "ball.obj", "ball.obj", "-o", "c.ply", "--landmarks", "pairs.txt",
          "--picture", "pairs.png", says=["pairs.png"])
    os.mkdir("out")
    os.rename("ball.obj", "out/map.ply")
    fails(1, "map", "out/map.ply", "frames/f.0001.obj", "-o", "out",
          says=["out/map.ply"])


def test_two_outputs_are_two_files():
    grids("g.vdb")
    icosphere("ball.obj")
    os.symlink("c.ply", "link.ply")
    os.symlink("c.ply", "link.png")
    os.symlink("s.exr", "s.png")
    os.mkdir("out")
    for command in [["slice", "g.vdb", "--picture", "s.png", "-o", "s.exr"],
                    ["slice", "g.vdb", "--picture", "s.png", "-o", "./s.exr"],
                    ["correspond", "ball.obj", "cube.obj", "-o", "link.ply", "--picture", "link.png"],
                    ["correspond", "ball.obj", "cube.obj", "-o", "c.ply", "--picture", "link.png"],
                    ["correspond", "ball.obj", "cube.obj", "-o", "c.ply", "--source-out", "c.ply"],
                    ["voxelize", "cube.obj", "-o", "r.vdb", "--report", "r.vdb"],
                    ["map", "ball.obj", "cube.obj", "-o", "out", "--report", "out/map.vdb"]]:
        fails(1, *command)


def test_folders_say_what_they_hold():
    pair()
    os.mkdir("out")
    for name in ["map.ply", "notes.txt", "thesis.doc"]:
        cli.write_file(f"out/{name}", "mine")
    command = ["map", "ball.obj", "egg.obj", "-o", "out", "--resolution", "8", "--charges", "100"]
    for dry in [["--dry-run"], []]:
        said = innermap(*command, *dry).stderr
        assert all(name in said for name in ("map.ply", "notes.txt", "thesis.doc")), said
        assert cli.read_file("out/notes.txt") == cli.read_file("out/thesis.doc") == b"mine"
        assert (cli.read_file("out/map.ply") == b"mine") == bool(dry)
    said = innermap(*command).stderr
    assert "notes.txt" not in said and "thesis.doc" not in said, said
    innermap(*command[:4], "new/deep", *command[5:])
    assert os.path.exists("new/deep/report.json")


def test_dry_runs_find_what_the_run_would_refuse():
    pair()
    os.mkdir("taken.vdb")
    cube()
    for command, says in [(["voxelize", "cube.obj", "-o", "none/a.vdb"], "none"),
                          (["voxelize", "cube.obj", "-o", "taken.vdb"], "taken.vdb"),
                          (["map", "ball.obj", "egg.obj", "-o", "cube.obj"], "cube.obj"),
                          (["voxelize", "cube.obj", "-o", "a.vdb", "--max-memory", "1M",
                            "--resolution", "512"], "limit of 1 MB")]:
        for dry in [["--dry-run"], []]:
            fails(1, *command, *dry, says=[says])
    innermap("map", "ball.obj", "egg.obj", "-o", "new/deep", "--dry-run")
    assert not os.path.exists("new")


def device(name, minor):
    """A device of the test's own: as root, a fault would take the machine's."""
    if os.geteuid() != 0:
        return "/dev/" + name
    try:
        os.mknod(name, stat.S_IFCHR | 0o666, os.makedev(1, minor))
        with open(name, "rb"):
            return name
    except OSError as error:
        raise cli.Skip(f"no devices can be made here: {error}")


def test_devices_stay_devices():
    cube()
    null, full = device("null", 3), device("full", 7)
    for _ in range(2):
        innermap("check", "cube.obj", "--report", null)
        innermap("voxelize", "cube.obj", "-o", null, "--resolution", "12", "-q", "--report", null)
        assert stat.S_ISCHR(os.stat(null).st_mode)
    fails(1, "check", "cube.obj", "--report", full, says=[full])
    assert stat.S_ISCHR(os.stat(full).st_mode)


def test_pipes_get_the_whole_file():
    cube()
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "12", "-q")
    os.mkfifo("pipe")
    got = []
    reader = threading.Thread(target=lambda: got.append(cli.read_file("pipe")))
    reader.start()
    innermap("slice", "a.vdb", "-o", "pipe", "-q")
    reader.join(30)
    assert stat.S_ISFIFO(os.stat("pipe").st_mode)
    innermap("slice", "a.vdb", "-o", "s.exr", "-q")
    assert len(got[0]) > 1000 and len(got[0]) == len(cli.read_file("s.exr"))
    done = innermap("check", "cube.obj", "--report", "/dev/stdout")
    assert done.stdout.index("box") < done.stdout.index('"command"'), done.stdout
    with open("text", "w", encoding="ascii") as file:
        subprocess.run([cli.PROGRAM, "check", "cube.obj", "--report", "/dev/stdout"], stdout=file,
                       check=True)
    assert b"box" in cli.read_file("text") and b'"command"' in cli.read_file("text")


def test_links_are_followed():
    cube()
    os.mkdir("there")
    os.symlink("there/real.vdb", "link.vdb")
    for _ in range(2):  # first dangling, then not
        innermap("voxelize", "cube.obj", "-o", "link.vdb", "--resolution", "12", "-q")
        assert os.path.islink("link.vdb") and os.path.isfile("there/real.vdb")
        assert os.listdir("there") == ["real.vdb"]
    os.symlink("round", "circle")
    os.symlink("circle", "round")
    fails(1, "voxelize", "cube.obj", "-o", "round", says=["round"])


def test_links_in_a_folder_are_followed():
    pair()
    os.makedirs("out")
    os.makedirs("else")
    os.symlink("../else/real.ply", "out/map.ply")
    innermap("map", "ball.obj", "egg.obj", "-o", "out", "--resolution", "16", "-q", timeout=300)
    assert os.path.islink("out/map.ply") and os.listdir("else") == ["real.ply"]
    assert not [name for name in os.listdir("out") if name.startswith(".")]


def test_long_names():
    cube()
    for size in (240, 250, 255):
        name = "n" * (size - 4) + ".vdb"
        innermap("voxelize", "cube.obj", "-o", name, "--resolution", "12", "-q")
        os.remove(name)
    fails(1, "voxelize", "cube.obj", "-o", "n" * 252 + ".vdb", says=["256", "255"])


def commands():
    """Every command that writes, its output not yet given."""
    return [["voxelize", "cube.obj"], ["fit", "ball.obj", "egg.obj"], ["map", "ball.obj", "egg.obj"],
            ["evaluate", "m.ply"], ["sphere", "ball.obj"], ["correspond", "ball.obj", "egg.obj"],
            ["push", "m.ply", "cube.obj"], ["pull", "m.ply", "cube.obj"],
            ["transfer-distance", "m.ply"], ["slice", "a.vdb"], ["export", "a.vdb"],
            ["import", "a.exr"], ["texture", "cube.obj"], ["sequence", "ball.obj", "frame.1.obj"],
            ["deform", "ball.obj", "cube.obj", "frame.1.obj"]]


ENDINGS = {"fit": "ply", "sphere": "ply", "correspond": "ply", "push": "obj", "pull": "obj",
           "slice": "exr", "export": "exr", "deform": "obj"}
FOLDERS = ("map", "sequence", "transfer-distance")


def test_every_command_says_first_what_cannot_be_written():
    # The inputs are no meshes or grids at all: to read one would be another error.
    for name in ("cube.obj", "ball.obj", "egg.obj", "m.ply", "a.vdb", "a.exr", "frame.1.obj"):
        cli.write_file(name, "nothing\n")
    for command in commands():
        ending = ENDINGS.get(command[0], "vdb")
        fails(1, *command, "-o", f"x.{ending}", "--report", "none/r.json",
              says=["none/r.json"])
        if command[0] in FOLDERS:
            fails(1, *command, "-o", "cube.obj", says=["cube.obj"])
            os.makedirs("out/report.json")
            fails(1, *command, "-o", "out", says=["out/report.json"])
            assert os.listdir("out") == ["report.json"]
            os.removedirs("out/report.json")
            continue
        if command[0] != "deform":  # makes it
            fails(1, *command, "-o", f"none/x.{ending}", says=["none"])
        fails(1, *command, "-o", f"cube.obj/x.{ending}", says=["cube.obj"])
        name = "x.0001." + ending if command[0] == "deform" else "x." + ending
        os.mkdir(name)
        fails(1, *command, "-o", "x." + ending)
        os.rmdir(name)
        if command[0] != "info":
            fails(1, *command, "-o", "n" * 252 + "." + ending, says=["255"])


def test_a_folder_of_files_is_all_new_or_all_old():
    pair()
    innermap("map", "ball.obj", "egg.obj", "-o", "out", "--resolution", "16", "-q")
    before = {name: cli.read_file("out/" + name) for name in os.listdir("out")}
    os.remove("out/section.png")
    os.makedirs("out/section.png/inner")
    fails(1, "map", "egg.obj", "ball.obj", "-o", "out", "--resolution", "16", says=["section.png"])
    os.removedirs("out/section.png/inner")
    for name in set(before) - {"section.png"}:
        assert cli.read_file("out/" + name) == before[name], name
    assert set(os.listdir("out")) == set(before) - {"section.png"}


def test_folders_made_for_nothing_go_with_their_parents():
    cube("cube.obj")
    cli.write_file("bad.obj", "nothing\n")
    fails(1, "map", "cube.obj", "bad.obj", "-o", "one/two/three")
    no_leftovers("cube.obj", "bad.obj")


def test_what_a_killed_run_left_goes_with_the_next():
    icosphere(subdivisions=4)
    process = subprocess.Popen([cli.PROGRAM, "voxelize", "ball.obj", "-o", "a.vdb", "--resolution",
                                "500", "--fog"], stderr=subprocess.DEVNULL)
    while process.poll() is None and not any(n.endswith(".part") for n in os.listdir(".")):
        pass
    process.kill()
    process.wait()
    left = [name for name in os.listdir(".") if name.endswith(".part")]
    innermap("voxelize", "ball.obj", "-o", "b.vdb", "--resolution", "12", "-q")
    assert [name for name in os.listdir(".") if name.endswith(".part")] == left, "not of b.vdb"
    innermap("voxelize", "ball.obj", "-o", "a.vdb", "--resolution", "12", "-q")
    no_leftovers("ball.obj", "a.vdb", "b.vdb")


def test_two_signals_leave_no_folder():
    icosphere("ball.obj", 5)
    icosphere("egg.obj", 5, 1.2)
    for number in (signal.SIGINT, signal.SIGTERM):
        process = subprocess.Popen([cli.PROGRAM, "map", "ball.obj", "egg.obj", "-o", "one/two"],
                                   stderr=subprocess.PIPE, text=True)
        while process.poll() is None and not os.path.exists("one/two"):
            pass
        process.send_signal(number)
        process.send_signal(number)
        said = process.communicate(timeout=30)[1]
        assert process.returncode == 130, (process.returncode, said)
        assert len(said.rstrip().split("innermap: ")) > 1, said
        no_leftovers("ball.obj", "egg.obj")


def test_a_signal_says_what_is_there():
    # At any moment: exit code 0 and the output, or 130, these words and no output.
    cube()
    for step in range(40):
        process = subprocess.Popen([cli.PROGRAM, "voxelize", "cube.obj", "-o", "a.vdb",
                                    "--resolution", "40", "-q"], stderr=subprocess.PIPE, text=True)
        try:
            process.wait(0.02 + 0.01 * step)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=30)[1]
        # Before the program's own code runs, the system ends it.
        assert process.returncode in (0, 130, -signal.SIGINT), (process.returncode, said)
        assert os.path.exists("a.vdb") == (process.returncode == 0), (step, process.returncode, said)
        if process.returncode == 0:
            os.remove("a.vdb")
        no_leftovers("cube.obj")


cli.run(globals())
