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
SECTIONS = ["placing", "sums", "solve", "tolerance", "poisson", "sequence", "transfer", "correspond", "jobs"]


def main():
    if not os.path.isdir(MODELS):
        print("skipped: needs the test models in", MODELS)
        return 77
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "figures.json")
        done = subprocess.run([sys.argv[1], "--quick", "--models", MODELS, "--json", path],
                              capture_output=True, text=True, timeout=500)
        assert done.returncode == 0, done.stdout + done.stderr
        with open(path, encoding="utf-8") as file:
            figures = json.load(file)
    assert list(figures["sections"]) == SECTIONS, list(figures["sections"])
    for name, tables in figures["sections"].items():
        assert tables, name
        for table in tables:
            assert table["rows"], f"{name}: {table['title']} has no rows"
            assert table["title"] in done.stdout
            for row in table["rows"]:
                bad = [key for key, value in row.items()
                       if value is None or isinstance(value, float) and not math.isfinite(value)]
                assert not bad, f"{name}: {bad} in {row}"
    unknown = subprocess.run([sys.argv[1], "fastness"], capture_output=True, text=True)
    assert unknown.returncode != 0 and "fastness" in unknown.stdout + unknown.stderr
    return 0


if __name__ == "__main__":
    sys.exit(main())
