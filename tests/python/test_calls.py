"""Calls: progress, Ctrl-C, threads, other processes, the end of the interpreter."""

import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy as np

import cli
from cli import alone, nightly
import innermap
import shapes

LONG = """
import innermap, shapes, sys
V, F = shapes.ball(4)
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(3)
print("ended", flush=True)
"""
# Each takes minutes.
TELL = "progress=lambda *said: print(*said, flush=True)"
CALLS = (
    f"innermap.fit(V, F, shapes.bent(V), tolerance=1e-9, {TELL})",
    f"innermap.harmonic(V, F, abs(V[:, 0]), tolerance=1e-9, {TELL})",
    f"innermap.correspond((V, F), (V[:, [1, 2, 0]] * [1, 2, 3], F), candidates=64, {TELL})",
)


def environment():
    here = os.path.dirname(os.path.abspath(__file__))
    return {**os.environ, "PYTHONPATH": here + os.pathsep + os.environ["PYTHONPATH"]}


def start(program):
    return subprocess.Popen([sys.executable, "-c", program], env=environment(), text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def seconds_to_end(call):
    """After Ctrl-C at the tenth time that it tells of progress."""
    process = start(LONG.format(call=call))
    for _ in range(10):
        assert process.stdout.readline() not in ("", "ended\n"), f"over already: {call}"
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    said, errors = process.communicate(timeout=120)
    assert process.returncode == 3 and said.endswith("interrupted\n"), (call, said, errors)
    return time.monotonic() - begin


def test_max_time_ends_what_improves():
    V, F = shapes.ball(4)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        fitted = innermap.fit(V, F, shapes.bent(V), tolerance=1e-9, max_time=1e-3)
    assert [w.category for w in told] == [RuntimeWarning] and "max_time" in str(told[0].message), told
    assert not fitted.tolerance_met
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        innermap.fit(V, F, shapes.bent(V), max_time=1000, **shapes.FEW)


def test_ends_on_ctrl_c():
    seconds_to_end(CALLS[0])


@nightly
@alone
def test_ends_on_ctrl_c_at_once():
    for call in CALLS:
        took = seconds_to_end(call)
        assert took < cli.AT_ONCE, f"{took:.1f} s: {call}"


def test_tells_of_progress():
    V, F = shapes.ball(3)
    told = []
    m = innermap.fit(V, F, shapes.bent(V), progress=lambda *said: told.append(
        (*said, threading.current_thread())))
    m.evaluate(resolution=32, progress=lambda stage, fraction: told.append(
        (stage, fraction, threading.current_thread())))
    assert len({stage for stage, _, _ in told}) > 3
    assert all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction, _ in told)
    assert {thread for _, _, thread in told} == {threading.main_thread()}


class Stop(Exception):
    pass


def test_ends_with_what_a_callable_raises():
    V, F = shapes.ball(3)

    def stop(*_):
        raise Stop("enough")

    for call in (lambda: innermap.fit(V, F, shapes.bent(V), progress=stop),
                 lambda: innermap.harmonic(V, F, stop),
                 lambda: innermap.harmonic(V, F, V[:, 0], fix=np.arange(20), flux=stop)):
        try:
            call()
        except Stop as error:
            assert str(error) == "enough"
        else:
            raise AssertionError("no error")


def test_lets_other_threads_run():
    V, F = shapes.ball(4)
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    innermap.fit(V, F, shapes.bent(V))
    took = time.monotonic() - begin
    done.set()
    thread.join()
    # A call that kept the lock would leave a few at its ends.
    assert len(ticks) > 20, (len(ticks), took)


def test_serves_several_threads():
    V, F = shapes.ball(2)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    X = shapes.inside(300)
    Y = m(X)
    wrong = []

    def work():
        for _ in range(5):
            back, found = m.inverse(m(X))
            if not (np.array_equal(m(X), Y) and found.all() and np.abs(back - X).max() < 1e-8):
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_is_the_same_for_any_number_of_threads():
    V, F = shapes.ball(3)
    X = shapes.inside(200)
    one, two = (innermap.fit(V, F, shapes.bent(V), threads=n)(X, threads=n) for n in (1, 2))
    assert np.array_equal(one, two)


def test_works_in_forked_processes():
    V, F = shapes.ball(2)
    m = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
    X = shapes.inside(1000)
    Y = m(X)
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        fresh = innermap.fit(V, F, shapes.twisted(V), **shapes.FEW)
        os._exit(0 if np.array_equal(m(X), Y) and np.array_equal(fresh(X), Y) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_ends_with_the_interpreter():
    # Objects are left to its end; a thread that is no daemon is waited for.
    process = start("""
import innermap, shapes, threading
V, F = shapes.ball(2)
m = innermap.fit(V, F, shapes.twisted(V), tolerance=1e-2)
grids = m.evaluate(resolution=16)
threading.Thread(target=lambda: print(innermap.fit(V, F, V, tolerance=1e-2).steps)).start()
try:
    innermap.load("nothing.ply")
except innermap.FileError as error:
    kept = error
""")
    said, errors = process.communicate(timeout=120)
    assert process.returncode == 0 and said == "1\n" and errors == "", (said, errors)


def test_ends_while_daemon_threads_compute():
    for begun in (0.3, 1):
        process = start(f"""
import innermap, shapes, threading, time
V, F = shapes.ball(3)
m = innermap.fit(V, F, V)
for call in (lambda: innermap.fit(V, F, shapes.bent(V), tolerance=1e-9),
             lambda: innermap.harmonic(V, F, lambda P: abs(P[:, 0]), tolerance=1e-9),
             lambda: m.evaluate(resolution=600)):
    threading.Thread(target=call, daemon=True).start()
time.sleep({begun})
print("over")
""")
        said, errors = process.communicate(timeout=60)
        # Python may still say that a thread was cancelled; nothing crashes.
        assert process.returncode == 0 and said == "over\n", (process.returncode, said, errors)


def test_former_names_are_taken_with_a_warning():
    V, F = shapes.ball(1)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        m = innermap.fit(V, F, 2 * V, sources=60)
        innermap.fit(V, F, 2 * V, charges=60)
    assert [str(w.message) for w in told if w.category is DeprecationWarning] == \
        ["'sources' is now called 'charges'"], told
    assert int(m.facts["rank"]) <= 64


if __name__ == "__main__":
    cli.run(globals())
