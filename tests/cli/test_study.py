#!/usr/bin/env python3
"""study."""

import csv
import math
import os
import re
import signal
import subprocess
import time
import xml.etree.ElementTree as xml
from html.parser import HTMLParser
from pathlib import Path

import cli
from cli import MODELS, PROGRAM, Skip, fails, innermap, read_json

SMALL = ["--charges", "40,80", "--points", "1,3", "--distances", "0.05:0.4:3", "--radius-ratios",
         "1.5,3", "--base-charges", "80", "--base-points", "3", "--base-distance", "0.2",
         "--resolution", "16"]
RUNS = 20  # of SMALL: see test_dry_run
CHARTS = ["figure5.svg", "errors.svg", "stability.svg", "energies.svg", "cost.svg", "grid.svg"]
SVG = "{http://www.w3.org/2000/svg}"


def shapes():
    cli.icosphere("ball.obj", 3)
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("egg.obj", [(x + 0.3 * y * y, 1.3 * y, z + 0.2 * x) for x, y, z in vertices], faces)


def study(*more, **options):
    return innermap("study", "ball.obj", "egg.obj", "-o", "out", *SMALL, *more, **options)


def table(path="out/study.csv"):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def figures(rows):
    """What does not depend on the clock, by run."""
    times = ("seconds", "seconds_overall")
    return [{k: v for k, v in row.items() if k not in times} for row in rows]


class Page(HTMLParser):
    """Counts elements; every one that is opened is closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.count, self.text, self.links = [], {}, "", []
        self.feed(text)
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.count[tag] = self.count.get(tag, 0) + 1
        self.links += [v for k, v in attrs if k in ("src", "href", "data")]

    def handle_startendtag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.links += [v for k, v in attrs if k in ("src", "href", "data")]

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, tag

    def handle_data(self, data):
        self.text += data


def test_files():
    shapes()
    study()
    assert set(os.listdir("out")) == {"study.csv", "study.json", "study.html", "report.json", "runs",
                                      *CHARTS}, os.listdir("out")
    rows = table()
    assert len(rows) == RUNS
    data = read_json("out/study.json")
    assert len(data["rows"]) == RUNS and data["runs_left"] == 0
    # The same in both, and consistent.
    for row, entry in zip(rows, data["rows"]):
        for key, value in entry.items():
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                assert math.isclose(float(row[key]), value, rel_tol=1e-8), key
        points, rms = int(row["points"]), float(row["collocation_rms"])
        assert math.isclose(float(row["c_error"]), points * rms * rms, rel_tol=1e-6)
        assert float(row["rms"]) <= float(row["max"])
        assert float(row["harmonic_energy"]) > 3 and float(row["deformation_energy"]) > 0
        assert float(row["condition"]) >= 1 and float(row["weights"]) > 0
        assert (row["o_distance"] == "") == (row["placement"] == "sphere")
        assert (row["r_ratio"] == "") == (row["placement"] == "offset")
        assert math.isclose(float(row["s_ratio"]), int(row["sources"]) / data["vertices"],
                            rel_tol=1e-6)
    best = min(rows, key=lambda r: float(r["p99"]))
    assert math.isclose(data["best"]["p99"], float(best["p99"]), rel_tol=1e-6)
    assert len(data["statements"]) == 6
    assert {s["verdict"] for s in data["statements"]} <= {"holds", "in part", "does not hold"}
    report = read_json("out/report.json")
    assert report["study"]["made"] == RUNS and report["study"]["best"] == data["best"]["options"]


def test_charts_and_page():
    shapes()
    study()
    for name in CHARTS:
        root = xml.parse(f"out/{name}").getroot()
        assert root.tag == SVG + "svg", name
        width, height = float(root.get("width")), float(root.get("height"))
        for mark in root.iter():
            for key, most in (("x", width), ("cx", width), ("x1", width), ("x2", width),
                              ("y", height), ("cy", height), ("y1", height), ("y2", height)):
                if mark.get(key) is not None:
                    assert -1 <= float(mark.get(key)) <= most + 1, (name, xml.tostring(mark))
        assert not re.search(r"\b(nan|inf)\b", Path(f"out/{name}").read_text(encoding="utf-8"))
    # The curve of the C-Error over the distance has the table's values.
    rows = [r for r in table() if r["placement"] == "offset" and r["sources"] == "80" and
            r["points"] == "240"]
    told = [mark.findtext(SVG + "title") for mark in xml.parse("out/figure5.svg").getroot().iter()
            if mark.tag != SVG + "svg" and mark.find(SVG + "title") is not None]
    for row in rows:
        assert f": {float(row['o_distance']):.4g}, {float(row['c_error']):.4g}" in told, (row, told)
    labels = "".join(xml.parse("out/figure5.svg").getroot().itertext())
    for label in ("S-Ratio", "C-Ratio", "O-Distance", "R-Ratio", "C-Error"):
        assert label in labels, label
    page = Page(Path("out/study.html").read_text(encoding="utf-8"))
    assert page.count["svg"] == len(CHARTS)
    assert page.count["tr"] == 2 + 6 + RUNS
    assert not page.links, page.links  # needs no other file
    assert "innermap map ball.obj egg.obj" in page.text


def test_best_settings_are_those_of_map():
    shapes()
    study()
    best = read_json("out/study.json")["best"]
    innermap("map", "ball.obj", "egg.obj", "-o", "again", "--resolution", "16",
             *best["options"].split())
    error = read_json("again/report.json")["boundary_error"]
    for key in ("rms", "p99", "max", "c_error"):
        assert math.isclose(error[key], best[key], rel_tol=1e-9), (error, best)


def kept():
    try:
        return len([n for n in os.listdir("out/runs") if n.endswith(".run")])
    except FileNotFoundError:
        return 0


def stopped(number, runs):
    """Stops a study by a signal once so many runs are kept; its exit code."""
    with subprocess.Popen([PROGRAM, "study", "ball.obj", "egg.obj", "-o", "out", *SMALL, "--threads",
                           "1"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        while kept() < runs and process.poll() is None:
            time.sleep(0.002)
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
        return process.returncode, said


def test_goes_on_after_kill():
    shapes()
    study()
    whole = figures(table())
    for name in os.listdir("out/runs"):
        os.remove(f"out/runs/{name}")
    for name in ("study.csv", "study.json"):
        os.remove(f"out/{name}")
    code, _ = stopped(signal.SIGKILL, 4)
    if code == 0:
        raise Skip("the study ended before it could be killed")
    there = kept()
    assert 4 <= there < RUNS and not os.path.exists("out/study.csv")
    study()
    told = read_json("out/report.json")["study"]
    assert told["kept"] == there and told["made"] == RUNS - there, told
    assert figures(table()) == whole
    left = [n for n in os.listdir("out/runs") if not n.endswith(".run")]
    assert not left, left


def test_goes_on_after_interrupt():
    shapes()
    code, said = stopped(signal.SIGINT, 3)
    if code == 0:
        raise Skip("the study ended before it could be stopped")
    assert code == 130, (code, said)
    assert re.search(rf"\d+ of {RUNS}\b.* out/runs", said), said
    assert os.listdir("out") == ["runs"], os.listdir("out")
    there = kept()
    study()
    assert read_json("out/report.json")["study"]["kept"] == there


def test_kept_runs_are_of_the_same_settings():
    shapes()

    def made(*more):
        innermap("study", "ball.obj", "egg.obj", "-o", "out", *SMALL, "--grid", "none", *more)
        return read_json("out/report.json")["study"]["made"]

    runs = made()
    assert 0 < runs < RUNS
    assert made() == 0
    assert made("--seed", "2") == runs
    assert made("--method", "tsvd") == runs
    assert 0 < made("--base-radius-ratio", "3") < runs
    # Another file of the same name.
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("egg.obj", [(x, 1.2 * y, z) for x, y, z in vertices], faces)
    assert made() == runs
    assert made() == 0


def test_dry_run():
    shapes()
    text = study("--dry-run").stdout
    assert not os.path.exists("out")
    assert len(re.findall(rf"^run \d+ of {RUNS}: .*\d.*B$", text, re.M)) == RUNS, text
    study()
    text = study("--dry-run").stdout
    assert not re.findall(rf"^run \d+ of {RUNS}: .*\d.*B$", text, re.M), text
    assert re.search(rf"\b0 runs\b.*\b{RUNS}\b", text), text


def test_budgets():
    shapes()
    study("--max-time", "1e-6")
    assert read_json("out/report.json")["study"]["left"] == RUNS and table() == []
    # Too large for the limit: in the table, with the reason.
    innermap("study", "ball.obj", "egg.obj", "-o", "more", "--charges", "40,5000", "--points", "none",
             "--distances", "none", "--radius-ratios", "none", "--base-charges", "40", "--resolution",
             "16", "--max-memory", "500MB")
    rows = table("more/study.csv")
    assert [bool(r["failure"]) for r in rows] == [False, True], rows
    assert "500 MB" in rows[1]["failure"] and rows[1]["rms"] == ""
    assert len(os.listdir("more/runs")) == 1
    Page(Path("more/study.html").read_text(encoding="utf-8"))
    fails(1, "study", "ball.obj", "egg.obj", "-o", "none", "--charges", "5000,6000", "--points", "none",
          "--distances", "none", "--radius-ratios", "none", "--base-charges", "5000", "--resolution",
          "16", "--max-memory", "500MB")


def test_names_are_escaped():
    shapes()
    name = "<b>&'.obj"
    os.rename("egg.obj", name)
    innermap("study", "ball.obj", name, "-o", "out", "--charges", "40", "--points", "none",
             "--distances", "0.1,0.2", "--radius-ratios", "none", "--base-charges", "40",
             "--resolution", "16")
    page = Page(Path("out/study.html").read_text(encoding="utf-8"))
    assert name in page.text and page.count["b"] == 6  # the verdicts
    for chart in os.listdir("out"):
        if chart.endswith(".svg"):
            assert name in "".join(xml.parse(f"out/{chart}").getroot().itertext())


def test_refusals():
    shapes()
    both = ("study", "ball.obj", "egg.obj", "-o", "out")
    fails(2, "study", "ball.obj", "-o", "out", says=("TARGET",))
    fails(2, *both, "--charges", "many", says=("--charges", "many"))
    fails(2, *both, "--distances", "0.1:0.2", says=("--distances",))
    fails(2, *both, "--distances", "0.2:0.1:3", says=("--distances",))
    fails(2, *both, "--points", "", says=("--points",))
    fails(1, *both, "--charges", "3,100", says=("charges", "16"))
    fails(1, *both, "--distances", "5", says=("distances",))
    fails(1, *both, "--radius-ratios", "1", says=("radius",))
    fails(1, *both, "--charges", "100:200:100", "--distances", "0.01:0.1:200", says=("10000",))
    cli.cube("cube.obj")
    fails(1, "study", "ball.obj", "cube.obj", "-o", "out")


@cli.nightly
def test_horse_pose():
    if not MODELS.exists():
        raise Skip("no models here")
    poses = MODELS / "horse-poses"
    innermap("study", poses / "reference.obj", poses / "pose-02.obj", "-o", "out", "--grid", "none",
             "--charges", "125:500:3", "--points", "1,4", "--base-charges", "500", "--distances",
             "0.0025,0.02,0.16", "--radius-ratios", "1.1,3")
    verdicts = {s["text"]: s["verdict"] for s in read_json("out/study.json")["statements"]}
    assert verdicts["More charges give a smaller error"] == "holds", verdicts
    assert verdicts["Charges on a sphere are worse than on an offset of the surface"] == "holds"
    # The best distance is about a spacing, neither the nearest nor the farthest.
    assert verdicts["Charges nearer to the surface give a smaller error at fresh points"] == "in part"


if __name__ == "__main__":
    cli.run(globals())
