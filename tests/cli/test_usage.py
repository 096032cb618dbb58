#!/usr/bin/env python3
"""Exit codes, help, mistyped commands and options, values that are refused."""

import re

import cli
from cli import cube, fails, innermap

COMMANDS = ["check", "voxelize", "slice", "info", "help", "map", "fit", "evaluate", "texture"]


def test_version_is_the_projects():
    text = (cli.ROOT / "CMakeLists.txt").read_text()
    version = re.search(r"project\(innermap VERSION ([0-9.]+)", text).group(1)
    lines = innermap("--version").stdout.splitlines()
    assert re.fullmatch(rf"innermap {re.escape(version)}( \(commit [0-9a-f]{{10,}}(-dirty)?\))?", lines[0]), lines
    for library in ("OpenVDB", "TBB", "OpenEXR", "OpenImageIO", "OpenBLAS", "zlib"):
        assert re.search(rf"\b{library} [0-9]+\.[0-9]+", " ".join(lines[1:])), (library, lines)
    assert max(map(len, lines)) <= 80, lines
    assert f"\nversion: {version}\n" in (cli.ROOT / "CITATION.cff").read_text()
    assert f"\n## {version}" in (cli.ROOT / "CHANGELOG.md").read_text()


def test_each_command_has_help_with_an_example_and_the_common_options():
    for command in COMMANDS:
        text = innermap(command, "--help").stdout
        assert innermap("help", command).stdout == text
        assert f"usage: innermap {command}" in text
        assert "example:" in text
        for option in ["--threads", "--max-memory", "--dry-run", "--report", "--quiet", "--help"]:
            assert option in text, (command, option)
        assert max(map(len, text.split("\n"))) <= 100, command


def test_help_shows_units_ranges_and_defaults():
    text = " ".join(innermap("voxelize", "--help").stdout.split())
    assert "above 0 up to " in text and "default: by --resolution]" in text
    assert "[from 4 to 4096; default: 128" in text
    assert "[innermap, blender, houdini; default: innermap]" in text


def test_mistyped_commands_and_options():
    cube()
    fails(2, "voxelis", says=["'voxelis'", "voxelize"])
    fails(2, "chekc", "cube.obj", says=["check"])
    fails(2, "frobnicate", says=["innermap --help"])
    fails(2, "--qiet", says=["'--qiet'"])
    fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--resoluton", "20",
          says=["'--resoluton'", "did you mean --resolution?"])
    fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--voxelsize=0.1",
          says=["'--voxelsize'", "did you mean --voxel-size?"])
    fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--names", "blendr",
          says=["--names", "blender"])
    fails(2, "help", "slcie", says=["slice"])


def test_missing_and_surplus_arguments():
    cube()
    fails(2, "check", says=["MESH"])
    fails(2, "voxelize", "cube.obj", says=["--output"])
    fails(2, "voxelize", "cube.obj", "-o", says=["-o"])
    fails(2, "voxelize", "cube.obj", "-o", "--fog", says=["--output"])
    fails(2, "check", "cube.obj", "more.obj", says=["'more.obj'"])
    fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "-o", "b.vdb")
    fails(2, "slice", "a.vdb", says=["--output", "--picture"])


def test_values_that_are_not_numbers():
    cube()
    for value in ["abc", "1x", "", "nan", "inf", "1e", "0x10", " 1", "1,5", "--5", "+1"]:
        line = fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--voxel-size", value)
        assert "--voxel-size" in line, line
    for value in ["1.5", "abc", "1e3", "-"]:
        line = fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--resolution", value)
        assert "--resolution" in line, line
    line = fails(2, "slice", "a.vdb", "--picture", "p.png", "--range", "3")
    assert "--range" in line, line


def test_values_out_of_range():
    cube()
    for option, value in [("--voxel-size", "0"), ("--voxel-size", "-1"), ("--resolution", "3"),
                          ("--resolution", "-5"), ("--half-width", "1"), ("--threads", "-1"),
                          ("--voxel-size", "1e999"), ("--resolution", "99999999999999999999"),
                          ("--max-memory", "0"), ("--max-memory", "many"),
                          ("--max-memory", "-4GB"), ("--max-memory", "1e"), ("--max-memory", "0x10")]:
        line = fails(1, "voxelize", "cube.obj", "-o", "a.vdb", option, value)
        assert option in line, line


def test_values_may_follow_an_equals_sign():
    cube()
    innermap("voxelize", "cube.obj", "--output=a.vdb", "--resolution=12", "--quiet")
    innermap("voxelize", "--resolution", "12", "-q", "-o", "b.vdb", "cube.obj")


def test_spellings_of_both_sides_are_taken():
    cube()
    innermap("voxelise", "cube.obj", "-o", "a.vdb", "--resolution", "12", "--fog")
    for flag in ["--color", "--colour"]:
        fails(1, "slice", "a.vdb", "--picture", "a.png", flag, says=["density"])
    fails(2, "slice", "a.vdb", "--picture", "c.png", "--color", "--colour", "--colur",
          says=["did you mean --colour?"])
    assert innermap("help", "tetrahedralise").stdout == innermap("tetrahedralize", "-h").stdout
    fails(2, "fit", "a.obj", "b.obj", "-o", "a.ply", "--regularisation", "0.1",
          "--regularization", "0.1")


def test_former_names_are_taken_with_a_note():
    cli.icosphere("a.obj", 2)
    cli.icosphere("b.obj", 2, radius=2)
    fit = ("fit", "a.obj", "b.obj", "-o", "m.ply", "--report", "r.json")
    done = innermap(*fit, "--sources", "60")
    assert "--sources is now called --charges" in done.stderr
    assert cli.read_json("r.json")["settings"]["charges"] == 60
    assert "now called" not in innermap(*fit, "--charges=60").stderr
    assert "--max-folded is now called" in innermap(*fit, "--max-folded=0.5").stderr
    fails(1, *fit, "--sources", "0", says=["--charges"])
    fails(2, *fit, "--sources", "60", "--charges", "60", says=["more than once"])
    assert "formerly --sources" in innermap("help", "--markdown").stdout


def test_a_cut_is_said_in_one_way():
    cube()
    innermap("voxelize", "cube.obj", "-o", "a.vdb", "--resolution", "16", "-q")
    pictures = {}
    for name, words in [("new", ["--picture", "{}", "--section", "x=0.3"]),
                        ("parts", ["--picture", "{}", "--axis", "x", "--section", "0.3"]),
                        ("old", ["--section", "{}", "--axis", "x", "--at", "0.3"]),
                        ("other", ["--picture", "{}", "--section", "y"])]:
        done = innermap("slice", "a.vdb", "--grid", "surface", *[w.format(f"{name}.png") for w in words])
        assert ("--picture" in done.stderr) == (name == "old"), done.stderr
        pictures[name] = open(f"{name}.png", "rb").read()
    assert pictures["new"] == pictures["parts"] == pictures["old"] != pictures["other"]
    done = innermap("tetrahedralize", "cube.obj", "-o", "t.vtu", "--resolution", "4", "--picture", "t.png",
                    "--axis", "x", "--at", "0.3", "--report", "r.json")
    assert "--axis is now called --section" in done.stderr
    assert cli.read_json("r.json")["settings"]["section"] == "x=0.3"
    for twice in [("x=0.1", "y=0.2"), ("x", "y"), ("0.1", "0.2"), ("x=0.1", "0.2")]:
        fails(2, "tetrahedralize", "cube.obj", "-o", "u.vtu", "--section", twice[0], "--section", twice[1],
              says=["more than once"])
    for command in [["tetrahedralize", "cube.obj", "-o", "t.vtu", "--resolution", "4"], ["slice", "a.vdb"]]:
        innermap(*command, "--picture", "t.png", "--section", "auto")
    for bad, code in [("w", 2), ("x=2", 1), ("=", 2), ("x=", 2), ("x=0.5=1", 2), ("x=nan", 2)]:
        fails(code, "slice", "a.vdb", "--picture", "p.png", "--section", bad, says=["--section"])


def test_names_whose_ending_is_another_kinds_are_refused():
    cube()
    for command, ending in [(["voxelize", "cube.obj"], ".vdb"), (["sphere", "cube.obj"], ".ply"),
                            (["tetrahedralize", "cube.obj"], ".mesh"), (["export", "a.vdb"], ".exr"),
                            (["texture", "cube.obj"], ".vdb")]:
        for name in ["x.png", "x", "x.vdb.bak"]:
            fails(2, *command, "-o", name, says=["--output", name, ending])
    fails(2, "slice", "a.vdb", "--picture", "x.exr", says=["--picture", ".png"])
    innermap("voxelize", "cube.obj", "-o", "x.VDB", "--resolution", "8")
    innermap("voxelize", "cube.obj", "-o", "/dev/null", "--resolution", "8")


cli.run(globals())
