#!/usr/bin/python3
"""Runs innermap_ratios with tiny sizes: every section ends with figures. No time is judged.

    test_ratios.py PROGRAM
"""
import json
import math
import os
import subprocess
import sys
import tempfile

MODELS = os.path.join(os.path.dirname(__file__), "..", "..", "..", "shared", "models")
SECTIONS = ["placing", "sums", "solve", "tolerance", "poisson", "sequence", "transfer", "correspond", "levelset",
            "jobs"]


def beside_itself(quick, path):
    """--against: each second of both builds, and a ratio in its spread."""
    done = subprocess.run([*quick, "sequence", "transfer", "--against", sys.argv[1], "--rounds", "2"],
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["against"]["rows"]
    assert {"fit s", "push s", "pull s", "process s", "cpu s"} <= {row["figure"] for row in rows}, rows
    for row in rows:
        assert 0 < row["least"] <= row["ratio"] <= row["most"], row


def main():
    if not os.path.isdir(MODELS):
        print("skipped: needs the test models in", MODELS)
        return 77
    with tempfile.TemporaryDirectory() as folder:
        path, chart = os.path.join(folder, "figures.json"), os.path.join(folder, "chart.svg")
        quick = [sys.argv[1], "--quick", "--models", MODELS, "--json", path]
        done = subprocess.run([*quick, "--chart", chart], capture_output=True, text=True, timeout=500)
        assert done.returncode == 0, done.stdout + done.stderr
        with open(path, encoding="utf-8") as file:
            figures = json.load(file)
        with open(chart, encoding="utf-8") as file:
            assert "meshToVolume" in file.read()
        beside_itself(quick, path)
    assert list(figures["sections"]) == SECTIONS, list(figures["sections"])
    for name, tables in figures["sections"].items():
        assert tables, name
        for table in tables:
            assert table["rows"], f"{name}: {table['title']} has no rows"
            assert table["title"] in done.stdout
            for row in table["rows"]:
                assert row["of limit %"] > 0, f"{name}: {row}"
                bad = [key for key, value in row.items()
                       if value is None or isinstance(value, float) and not math.isfinite(value)]
                assert not bad, f"{name}: {bad} in {row}"
    unknown = subprocess.run([sys.argv[1], "fastness"], capture_output=True, text=True)
    assert unknown.returncode != 0 and "fastness" in unknown.stdout + unknown.stderr
    return 0


if __name__ == "__main__":
    sys.exit(main())
