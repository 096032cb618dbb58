#!/usr/bin/env python3
"""What every report says of the run itself, and docs/report.schema.json."""

import datetime
import os
from pathlib import Path

from cli import check_report, cube, icosphere, innermap, read_json, report_validator, run

QUICK = ("--charges", 200, "--resolution", 24)


def sizes(report):
    return {o["path"]: o["bytes"] for o in report["outputs"]}


def test_says_what_ran_when_and_where():
    icosphere("a.obj")
    icosphere("b.obj", radius=2)
    before = datetime.datetime.utcnow().replace(microsecond=0)
    done = innermap("fit", "a.obj", "b.obj", "-o", "map.ply", "--charges", 200, "--threads", 2,
                    "--report", "r.json")
    after = datetime.datetime.utcnow()
    r = read_json("r.json")
    assert r["command"] == "fit"
    assert r["command_line"][:2] == ["innermap", "fit"]
    assert r["command_line"][2:] == [str(a) for a in done.args[2:]]
    assert r["version"] == innermap("--version").stdout.split()[1]
    date = datetime.datetime.strptime(r["date"], "%Y-%m-%dT%H:%M:%SZ")
    assert before <= date <= after, (before, date, after)
    assert r["host"]["cores"] == len(os.sched_getaffinity(0)) or \
        r["host"]["cores"] == os.cpu_count(), r["host"]
    assert r["host"]["threads"] == 2
    assert sizes(r) == {"map.ply": os.path.getsize("map.ply")}


def test_settings_are_those_used():
    icosphere("a.obj")
    icosphere("b.obj", radius=2)
    innermap("fit", "a.obj", "b.obj", "-o", "map.ply", "--report", "r.json", "--one-to-one", "off",
             "--tolerance", 0.01)
    s = read_json("r.json")["settings"]
    assert s["source"] == "a.obj" and s["target"] == "b.obj" and s["output"] == "map.ply"
    assert s["tolerance"] == 0.01 and s["one_to_one"] == "off" and s["interpolation"] == "auto"
    assert s["best_effort"] is False and s["seed"] == 1 and s["charges"] is None
    innermap("fit", "a.obj", "b.obj", "-o", "map.ply", "--report", "r.json")
    assert read_json("r.json")["settings"]["tolerance"] == 0.001


def test_a_folder_s_files_with_their_sizes():
    icosphere("a.obj")
    icosphere("b.obj", radius=2)
    Path("out").mkdir()
    Path("out/steps.png").write_text("of an earlier run", encoding="ascii")
    innermap("map", "a.obj", "b.obj", "-o", "out", *QUICK, "--report", "r.json")
    wanted = {f"out/{n}": os.path.getsize(f"out/{n}")
              for n in ("map.ply", "map.vdb", "slices.exr", "section.png")}
    assert sizes(read_json("out/report.json")) == wanted
    assert {**wanted, "out/report.json": os.path.getsize("out/report.json")} == \
        sizes(read_json("r.json"))


def test_a_failed_run_is_no_report_and_a_dry_run_writes_none():
    cube("a.obj")
    innermap("check", "a.obj", "--dry-run", "--report", "r.json")
    assert not Path("r.json").exists()
    innermap("check", "a.obj", "--report", "r.json")
    assert sizes(read_json("r.json")) == {}


def test_the_schema_refuses_what_is_wrong():
    cube("a.obj")
    innermap("check", "a.obj", "--report", "r.json")
    check_report("r.json")
    good = read_json("r.json")
    validator = report_validator()
    for wrong in ({"date": "yesterday"}, {"peak_memory_bytes": -1}, {"unheard_of": 1},
                  {"source": {"path": "a.obj"}}, {"outputs": [{"path": "a"}]},
                  {"verdict": {"met": True}}):
        assert list(validator.iter_errors({**good, **wrong})), wrong
    for key in ("version", "settings", "command_line", "host", "seconds"):
        assert list(validator.iter_errors({k: v for k, v in good.items() if k != key})), key


run(globals())
