"""What the command-line tests share: running innermap, small meshes, checks.

A test is a script with functions named test_*. run(globals()) calls all of them, or those that the
command line names, prints what fails and ends with exit code 1 if anything did. Each function gets a
temporary folder of its own as working directory, and is a test of its own for ctest
(tests/CMakeLists.txt finds them by their "def" lines, and the marks @alone and @nightly before these).
Standard library only, but for jsonschema: every report that a run leaves is checked against
docs/report.schema.json.
"""

import functools
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
import traceback
from collections import namedtuple
from pathlib import Path

PROGRAM = os.environ.get("INNERMAP", "innermap")
if os.sep in PROGRAM:
    PROGRAM = os.path.abspath(PROGRAM)  # tests run in folders of their own
ROOT = Path(os.environ.get("INNERMAP_ROOT", Path(__file__).resolve().parents[2]))
sys.path.append(str(ROOT / "samples"))
import make_shapes  # pylint: disable=wrong-import-position

MODELS = ROOT.parent / "shared" / "models"
# For tests that run beside others: threads of each innermap() whose arguments do not say.
THREADS = os.environ.get("INNERMAP_TEST_THREADS", "")


# Seconds within which a run that is cancelled is over. Half a second here; machines that others use
# as well are slower, and a run that does not heed the signal takes longer than this by far.
AT_ONCE = 5


# text: all that it printed; bytes of memory; seconds, None where it says none.
DryRun = namedtuple("DryRun", "text memory seconds")


class Skip(Exception):
    """Raised by a test that cannot run here."""


def alone(test):
    """Marks a test that measures time: ctest runs nothing beside it, and it has all cores."""
    return test


def nightly(test):
    """Marks a test that tests/run leaves to tests/nightly."""
    return test


def innermap(*arguments, exit_code=0, **options):
    """Runs innermap; checks the exit code, and that a failure is one line on stderr."""
    command = [PROGRAM, *map(str, arguments)]
    if THREADS and len(command) > 2 and not command[1].startswith("-") and \
            command[1] != "help" and "--help" not in command and "--threads" not in command:
        command[2:2] = ["--threads", THREADS]
    reports = reports_of(arguments, options.get("cwd", "."))
    before = [identity(path) for path in reports]
    done = subprocess.run(command, capture_output=True, text=True,
                          timeout=options.pop("timeout", 300), **options)
    said = f"innermap {' '.join(map(str, arguments))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
    assert done.returncode == exit_code, f"exit code {done.returncode}, not {exit_code}: {said}"
    if exit_code:
        assert error_line(done), said
        assert done.stderr.endswith("\n"), said
    for report, was in zip(reports, before):
        if identity(report) not in (None, was):
            check_report(report)
    return done


def identity(path):
    """Changes when the file is written; None where there is none."""
    try:
        if not path.is_file():
            return None
        status = path.stat()
    except OSError:  # no file can be there
        return None
    return status.st_ino, status.st_mtime_ns, status.st_size


UNITS = {"B": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}


def dry_run(*arguments):
    """Runs innermap with --dry-run, which must write nothing; what it says that the run would need."""
    before = set(os.listdir("."))
    text = innermap(*arguments, "--dry-run").stdout
    assert set(os.listdir(".")) == before, set(os.listdir(".")) - before
    memory = re.search(r"^memory: .*?([0-9.e+]+) ([kMGT]?B)\b", text, re.M)
    seconds = re.search(r"^time: .*?(\d+) s$", text, re.M)
    assert memory, text
    return DryRun(text, float(memory[1]) * UNITS[memory[2]], int(seconds[1]) if seconds else None)


def reports_of(arguments, folder):
    """Where a run with these arguments may write reports."""
    words = [str(a) for a in arguments]
    after = {option: Path(folder, words[i + 1]) for i, option in enumerate(words[:-1])
             if option in ("--report", "-o", "--output")}
    return [path / "report.json" if option != "--report" else path
            for option, path in after.items()]


def check_report(path):
    """The report is as docs/report.schema.json says."""
    errors = [f"{path}: {'.'.join(map(str, e.absolute_path))}: {e.message}"
              for e in report_validator().iter_errors(read_json(path))]
    assert not errors, "\n".join(errors[:10])


@functools.lru_cache(maxsize=1)
def report_validator():
    import jsonschema  # pylint: disable=import-outside-toplevel
    schema = read_json(ROOT / "docs" / "report.schema.json")
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def error_line(done):
    """The one line that says why; progress and notes may stand before it."""
    lines = [line for line in done.stderr.split("\n") if line]
    return lines[-1] if lines and lines[-1].startswith("innermap: ") else ""


def fails(exit_code, *arguments, says=(), **options):
    """Runs innermap, which must fail with one line that holds all of `says`; nothing is written."""
    before = set(os.listdir("."))
    done = innermap(*arguments, exit_code=exit_code, **options)
    line = error_line(done)
    for text in says:
        assert text in line, f"'{text}' is not in: {line}"
    assert set(os.listdir(".")) == before, f"left behind: {set(os.listdir('.')) - before}"
    return line


PYTHON = "/usr/bin/python3"


def independent(script, *arguments):
    """What a script prints with the system's Python, which has the modules of other programs; Skip where
    one is missing."""
    done = subprocess.run([PYTHON, "-c", script, *map(str, arguments)], capture_output=True,
                          text=True, timeout=300, check=False)
    if "No module named" in done.stderr:
        raise Skip(done.stderr.strip().split("\n")[-1])
    assert done.returncode == 0, done.stderr
    return done.stdout


def no_leftovers(*allowed):
    """Nothing but `allowed` stands in the folder: no temporary file was left."""
    extra = set(os.listdir(".")) - set(allowed)
    assert not extra, f"left behind: {extra}"


def file_size_limit(size):
    """For preexec_fn: files may not grow over `size` bytes, like a disk that is full."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def write_file(path, content):
    """Text or bytes."""
    with open(path, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)


def read_file(path):
    """Its bytes."""
    with open(path, "rb") as file:
        return file.read()


def write_obj(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        for v in vertices:
            file.write("v {:.17g} {:.17g} {:.17g}\n".format(*v))
        for f in faces:
            file.write("f " + " ".join(str(i + 1) for i in f) + "\n")
    return path


def read_obj(path):
    """Vertices and faces, counted from 0."""
    vertices, faces = [], []
    with open(path, encoding="utf-8") as file:
        for words in map(str.split, file):
            if words[:1] == ["v"]:
                vertices.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                faces.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:]))
    return vertices, faces


CUBE_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def cube(path="cube.obj", size=1.0, origin=(0.0, 0.0, 0.0)):
    vertices = [tuple(o + size * c for o, c in zip(origin, (i & 1, i >> 1 & 1, i >> 2)))
                for i in range(8)]
    return write_obj(path, vertices, CUBE_FACES)


def icosphere_arrays(subdivisions=2, radius=1.0):
    vertices, faces = make_shapes.sphere(subdivisions, evenly=False)
    return [tuple(radius * x for x in v) for v in vertices], faces


def icosphere(path="ball.obj", subdivisions=2, radius=1.0):
    return write_obj(path, *icosphere_arrays(subdivisions, radius))


def torus(path, n=24, m=12, major=1.0, minor=0.4):
    return write_obj(path, *make_shapes.torus(n, m, major, minor))


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def cpu_seconds():
    """That this process and those it started and saw end have used."""
    own, ended = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + ended.ru_utime + ended.ru_stime


def run(names):
    """Runs the test_* functions of a script that the command line names, or all."""
    failed = skipped = 0
    wanted = sys.argv[1:]
    tests = [(name, test) for name, test in names.items()
             if name.startswith("test_") and (not wanted or name in wanted)]
    if len(tests) < len(wanted):
        sys.exit(f"no such tests: {set(wanted) - set(dict(tests))}")
    for name, test in tests:
        start, before, home = time.monotonic(), cpu_seconds(), os.getcwd()
        with tempfile.TemporaryDirectory(prefix="innermap-") as folder:
            os.chdir(folder)
            try:
                test()
                result = "ok"
            except Skip as reason:
                skipped += 1
                result = f"skipped: {reason}"
            except Exception:  # pylint: disable=broad-except
                failed += 1
                result = "FAILED\n" + traceback.format_exc()
            finally:
                os.chdir(home)
        print(f"{name}: {result} ({time.monotonic() - start:.1f} s, "
              f"{cpu_seconds() - before:.1f} s of CPU)", flush=True)
    sys.exit(1 if failed else 77 if skipped == len(tests) else 0)
