#!/usr/bin/env python3
"""The usual options and the rest, pages for man, completion in shells."""

import re
import shutil
import subprocess

import cli
from cli import Skip, cube, innermap


def names(text):
    return set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", text, re.M))


def commands():
    return re.findall(r"^### innermap ([\w-]+)$", innermap("help", "--markdown").stdout, re.M)


def test_help_has_the_usual_options_and_help_all_every_one():
    reference = innermap("help", "--markdown").stdout
    for command in commands():
        usual, every = (innermap(command, o).stdout for o in ["--help", "--help-all"])
        section = reference.split(f"### innermap {command}\n")[1].split("\n### ")[0]
        own = set(re.findall(r"^\| `(?:-\w, )?(--[\w-]+)", section, re.M))
        assert own <= names(every), command
        assert names(usual) <= names(every), command
        hidden = len(own - names(usual))
        said = re.search(r"^(\d+) more options?, .*: innermap " + command + " --help-all$", usual, re.M)
        assert re.search(r"^options of every command: --threads, .*--dry-run, ", usual, re.M), command
        assert (int(said.group(1)) if said else 0) == hidden, command
    assert "--radius-ratio" not in innermap("map", "--help").stdout
    assert innermap("help", "map", "--all").stdout == innermap("map", "--help-all").stdout


def test_the_program_alone_names_what_people_need_first():
    done = innermap()
    assert re.findall(r"^  ([\w-]+) ", done.stdout, re.M) == ["map", "deform", "push", "voxelize", "check", "info"]
    assert "innermap --help" in done.stdout


def test_usual_options_stand_in_groups_and_first():
    text = innermap("map", "--help-all").stdout
    titles = re.findall(r"^([\w ]+):$", text, re.M)
    assert titles[0] == "arguments" and titles[-2:] == ["options of every command", "example"]
    assert len(titles) == len(set(titles)) >= 7, titles
    fit = text.split("fit of the map:")[1]
    assert fit.index("--one-to-one") < fit.index("--radius-ratio")


def test_source_and_target_are_named_alike():
    for command in ["map", "fit", "correspond", "compare-fem"]:
        assert re.search(r"usage: innermap \S+ SOURCE \[?TARGET", innermap(command, "-h").stdout)
    for command in ["sequence", "deform"]:
        assert f"usage: innermap {command} SOURCE " in innermap(command, "-h").stdout


def test_every_command_tells_the_version():
    version = innermap("--version").stdout
    for command in commands():
        assert innermap(command, "--version").stdout == version
        assert innermap(command, "missing.obj", "-V").stdout == version


def test_scripts_of_completion_are_well_formed():
    for shell in ["bash", "zsh", "fish"]:
        text = innermap("help", "--completion", shell).stdout
        for word in ["voxelize", "radius-ratio", "houdini"]:
            assert word in text, (shell, word)
        if shutil.which(shell):
            cli.write_file("script", text)
            subprocess.run([shell, "-n", "script"], check=True)


def completed_in_bash(line):
    words = line.split(" ")
    script = (". ./script; COMP_WORDS=(" + " ".join(f"'{w}'" for w in words) +
              f"); COMP_CWORD={len(words) - 1}; _innermap; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    done = subprocess.run(["bash", "-c", script], check=True, text=True, capture_output=True)
    return set(done.stdout.split())


def completed_in_fish(line):
    script = f"source script; complete -C '{line}'"
    done = subprocess.run(["fish", "--no-config", "-c", script], check=True, text=True,
                          capture_output=True, env={"HOME": ".", "PATH": "/usr/bin:/bin"})
    return {row.split("\t")[0] for row in done.stdout.split("\n") if row}


def completes(shell, completed):
    if not shutil.which(shell):
        raise Skip(f"{shell} is not installed")
    cube()
    cli.write_file("script", innermap("help", "--completion", shell).stdout)
    assert completed("innermap vox") == {"voxelize"}
    assert completed("innermap voxelize --voxel") == {"--voxel-size"}
    assert completed("innermap voxelize --names ") == {"innermap", "blender", "houdini"}
    assert "cube.obj" in completed("innermap voxelize cu")
    assert completed("innermap help tetra") == {"tetrahedralize"}


def test_bash_completes():
    completes("bash", completed_in_bash)


def test_fish_completes():
    completes("fish", completed_in_fish)


def test_pages_for_man_are_well_formed():
    innermap("help", "--pages", "pages")
    every = ["innermap", *(f"innermap-{c}" for c in commands())]
    for name in every:
        text = cli.read_file(f"pages/{name}.1").decode()
        assert text.startswith(".TH " + name.upper().replace("-", "\\-") + " 1 ")
        if name != "innermap":
            command = name.split("-", 1)[1]
            for option in names(innermap(command, "--help-all").stdout):
                assert option.replace("-", "\\-") in text, (name, option)
            assert innermap("help", "--man", command).stdout == text
    if not shutil.which("mandoc"):
        raise Skip("mandoc is not installed")
    # Pages have no date: they are the same from every build of a version.
    files = [f"pages/{name}.1" for name in every]
    said = subprocess.run(["mandoc", "-Tlint", "-Wstyle", *files], text=True,
                          capture_output=True, check=False)
    lines = [line for line in (said.stdout + said.stderr).split("\n")
             if line and "missing date" not in line and "referenced manual not found" not in line]
    assert not lines, lines[:5]


cli.run(globals())
