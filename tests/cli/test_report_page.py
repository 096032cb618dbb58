#!/usr/bin/env python3
"""report.html: what --html and `innermap report` write, opened in a browser."""

import json
import math
import os
import re
from pathlib import Path

import cli
from browser import Browser
from cli import MODELS, Skip, fails, innermap, nightly, no_leftovers
from frames import ball_frames, twisted

MOST_BYTES = 10_000_000
# Colours of a canvas, and the share of its points that something is drawn at.
SEEN = """(selector => {
  const from = document.querySelector(selector), to = document.createElement("canvas");
  [to.width, to.height] = [from.width, from.height];
  const context = to.getContext("2d");
  context.drawImage(from, 0, 0);
  const data = context.getImageData(0, 0, to.width, to.height).data, colours = new Set();
  let drawn = 0, sum = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 0) {
    ++drawn;
    colours.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
    sum = (sum * 31 + data[i] * 7 + data[i + 1] * 3 + data[i + 2] + i) % 1000000007;
  }
  return {colours: colours.size, share: 4 * drawn / data.length, sum};
})(SELECTOR)"""
# Points of a section in the colour of folds.
MARKED = """(() => { const c = document.querySelector("#cut-z"), to = document.createElement("canvas");
  [to.width, to.height] = [c.width, c.height];
  const context = to.getContext("2d");
  context.drawImage(c, 0, 0);
  const data = context.getImageData(0, 0, c.width, c.height).data;
  let count = 0;
  for (let i = 0; i < data.length; i += 4)
    count += data[i] > 250 && Math.abs(data[i + 1] - 230) < 4 && data[i + 2] < 6;
  return count; })()"""
SETTLED = "new Promise(done => requestAnimationFrame(() => setTimeout(done, 60)))"


def bent(p):
    x, y, z = p
    a = 0.6 * x
    return (x + 0.15 * z * z, y * math.cos(a) - z * math.sin(a),
            1.2 * (y * math.sin(a) + z * math.cos(a)))


def hollow_ball(subdivisions=3):
    """A ball with a hollow, hollow.obj, and the same bent."""
    vertices, faces = cli.icosphere_arrays(subdivisions)
    count = len(vertices)
    vertices = vertices + [tuple(0.5 * c for c in v) for v in vertices]
    faces = faces + [tuple(i + count for i in (a, c, b)) for a, b, c in faces]
    cli.write_obj("hollow.obj", vertices, faces)
    cli.write_obj("bent.obj", [bent(v) for v in vertices], faces)


def data_of(path):
    text = Path(path).read_text(encoding="utf-8")
    assert len(text) < MOST_BYTES, f"{path} has {len(text)} bytes"
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1])


def seen(page, selector):
    return page.value(SEEN.replace("SELECTOR", json.dumps(selector)))


def choose(page, selector, value):
    page.value(f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
      e.value = {json.dumps(str(value))};
      e.dispatchEvent(new Event("input", {{bubbles: true}}));
      e.dispatchEvent(new Event("change", {{bubbles: true}})); }})()""")
    page.value(SETTLED)


def check_quiet(page, known=True):
    assert page.complaints() == [], page.complaints()
    assert page.requests() == [], page.requests()
    if not known:
        return
    unknown = page.value("[...document.querySelectorAll('tr[data-known=false]')].map(e => e.dataset.key)")
    assert unknown == [], f"numbers without a meaning: {unknown}"


def check_surfaces(page):
    picture = seen(page, "canvas.surfaces")
    assert picture["colours"] > 200 and 0.02 < picture["share"] < 0.98, picture
    for value in page.value("[...document.querySelectorAll('#colour-by option')].map(e => e.value)")[1:]:
        choose(page, "#colour-by", value)
        other = seen(page, "canvas.surfaces")
        assert other["sum"] != picture["sum"] and abs(other["share"] - picture["share"]) < 0.01, value
        picture = other
    page.value("document.querySelector('canvas.surfaces').focus()")
    page.press("ArrowRight", 39)
    page.value(SETTLED)
    turned = seen(page, "canvas.surfaces")
    assert turned["sum"] != picture["sum"], "an arrow key does not turn"
    # A click in the middle of the left picture tells what is there.
    box = page.value("""(() => { const c = document.querySelector("canvas.surfaces");
      c.scrollIntoView(); const b = c.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()""")
    page.click(box[0] + box[2] / 4, box[1] + box[3] / 2)
    page.value(SETTLED)
    assert "(" in page.value("document.querySelector('#surfaces .told').textContent")


def check_sections(page, grids):
    shown = page.value("[...document.querySelectorAll('#grid-shown option')].map(e => e.value)")
    assert set(grids) <= set(shown), shown
    for grid in grids:
        choose(page, "#grid-shown", grid)
        for axis in "xyz":
            picture = seen(page, "#cut-" + axis)
            assert picture["colours"] > 10 and 0.02 < picture["share"] < 0.98, (grid, axis, picture)
    before = {axis: seen(page, "#cut-" + axis)["sum"] for axis in "xyz"}
    place = page.value("document.querySelector('#slide-z ~ output').textContent")
    choose(page, "#slide-z", 9)
    assert seen(page, "#cut-z")["sum"] != before["z"], "the slider does nothing"
    assert page.value("document.querySelector('#slide-z ~ output').textContent") != place
    slider = "Number(document.querySelector('#slide-x').value)"
    at = page.value(slider)
    page.value("document.querySelector('#slide-x').focus()")
    page.press("ArrowRight", 39)
    page.value(SETTLED)
    assert page.value(slider) == at + 1, "no keys on sliders"


def check_looks(page):
    """Other colours in the dark, other colours on demand, ink on paper in print."""
    paper = "getComputedStyle(document.body).backgroundColor"
    light = page.value(paper)
    page.colours(dark=True)
    assert page.value(paper) != light
    page.colours(dark=False)
    picture = seen(page, "#cut-x")
    choose(page, "#colours", "cividis")
    assert seen(page, "#cut-x")["sum"] != picture["sum"]
    page.pdf("page.pdf")
    assert os.path.getsize("page.pdf") > 20_000
    pages = len(re.findall(rb"/Type */Page\b", cli.read_file("page.pdf")))
    assert pages == 2, pages
    os.remove("page.pdf")


def test_hollow_ball():
    hollow_ball()
    innermap("map", "hollow.obj", "bent.obj", "-o", "out", "--resolution", "40", "--html", "--quiet")
    report, data = cli.read_json("out/report.json"), data_of("out/report.html")
    assert any(o["path"] == "out/report.html" and o["bytes"] == os.path.getsize("out/report.html")
               for o in report["outputs"]), report["outputs"]
    assert data["report"]["boundary_error"] == report["boundary_error"]
    assert [p["label"].split(":")[0] for p in data["shapes"][0]["places"]] == \
        ["source", "where the map takes it", "target"]
    with Browser() as browser:
        page = browser.open("out/report.html")
        check_surfaces(page)
        check_sections(page, ["deformation_energy", "jacobian", "map x"])
        check_looks(page)
        choose(page, "#right-shows", "2")
        assert page.value("document.querySelector('.captions').textContent").endswith("bent.obj")
        findings = report["verdict"]["findings"]
        unmet = sum(not finding["met"] for finding in findings)
        headline = page.value("document.querySelector('#verdict').textContent")
        assert headline.startswith("✗" if unmet else "✓") and str(len(findings)) in headline, headline
        assert page.value("document.querySelector('#why').open") is False
        assert page.value("document.querySelector('#why p').textContent") == report["one_to_one"]["statement"]
        text = page.value("document.body.innerText")
        for wanted in ("innermap map", "Boundary error", "Seconds by stage", report["version"],
                       " ".join(report["command_line"])):
            assert wanted in text, wanted
        check_quiet(page)
        print("ready after", page.value("document.documentElement.dataset.milliseconds"), "ms,",
              os.path.getsize("out/report.html"), "bytes")
    no_leftovers("hollow.obj", "bent.obj", "out")


def test_values_are_the_grids():
    """What the page holds is what was computed: a ball that grows by 1.2, 1.1 and 0.9."""
    vertices, faces = cli.icosphere_arrays(3)
    cli.write_obj("rest.obj", vertices, faces)
    cli.write_obj("grown.obj", [(1.2 * x, 1.1 * y, 0.9 * z) for x, y, z in vertices], faces)
    innermap("map", "rest.obj", "grown.obj", "-o", "out", "--resolution", "40", "--html", "--quiet")
    grids = {g["name"]: g for g in data_of("out/report.html")["grids"]}
    jacobian = grids["jacobian"]
    for axis, growth in zip("xyz", (1.2, 1.1, 0.9)):
        furthest = grids["map " + axis]["grid_greatest"] / growth
        assert 0.93 < furthest < 1.001, (axis, furthest)  # voxel centres within the ball
    assert max(abs(jacobian[k] - 1.2 * 1.1 * 0.9) for k in ("least", "greatest")) < 1e-4, jacobian
    with Browser() as browser:
        page = browser.open("out/report.html")
        choose(page, "#grid-shown", "map x")
        # Half way along the ball: x goes to 1.2 x, whatever the block.
        page.value("""(() => { const c = document.querySelector("#cut-y"); c.scrollIntoView({block: "center"});
          const b = c.getBoundingClientRect(); c.dispatchEvent(new PointerEvent("pointermove",
            {clientX: b.left + 0.75 * b.width, clientY: b.top + b.height / 2})); })()""")
        x, value = map(float, re.search(r"at \((\S+),.*map x (\S+)",
                                        page.value("document.querySelector('#sections .told').textContent")).groups())
        assert x > 0.3 and abs(value - 1.2 * x) < 0.005, (x, value)
        check_quiet(page)


def test_own_resolution():
    """Voxel by voxel where a page can hold it; else sections through the middle are."""
    cli.icosphere(subdivisions=4)
    innermap("voxelize", "ball.obj", "-o", "coarse.vdb", "--resolution", "120", "--html=coarse.html", "--quiet")
    innermap("voxelize", "ball.obj", "-o", "fine.vdb", "--resolution", "400", "--html=fine.html", "--quiet")
    coarse, fine = (data_of(name + ".html")["grids"][0] for name in ("coarse", "fine"))
    assert coarse["stride"] == 1 and "planes" not in coarse, coarse["stride"]
    assert fine["stride"] > 1 and [p["across"] for p in fine["planes"]] == [0, 1, 2]
    assert all(p["stride"] == 1 and max(p["blocks"]) >= 400 for p in fine["planes"])
    with Browser() as browser:
        page = browser.open("fine.html")
        width = "document.querySelector('#cut-z').width"
        assert page.value(width) % fine["planes"][2]["blocks"][0] == 0
        middle = seen(page, "#cut-z")
        choose(page, "#slide-z", page.value("Number(document.querySelector('#slide-z').value)") + 1)
        assert page.value(width) % fine["blocks"][0] == 0 and seen(page, "#cut-z")["sum"] != middle["sum"]
        check_quiet(page)


def test_folds_are_marked():
    """A ball turned over in its middle: places that fold are said, shown and gone to."""
    vertices, faces = cli.icosphere_arrays(4)
    cli.write_obj("ball.obj", vertices, faces)
    # Half of it pushed in far beyond the middle.
    cli.write_obj("dent.obj", [(x, y, z if z < 0.2 else 0.2 - 2.0 * (z - 0.2) * math.exp(-4 * (x * x + y * y)))
                               for x, y, z in vertices], faces)
    innermap("map", "ball.obj", "dent.obj", "-o", "out", "--resolution", "48", "--charges", "800",
             "--repair", "off", "--best-effort", "--html", "--quiet")
    assert cli.read_json("out/report.json")["inside"]["folded"] > 0
    with Browser() as browser:
        page = browser.open("out/report.html")
        sliders = "[...'xyz'].map(a => document.querySelector('#slide-' + a).value).join()"
        for grid in ("jacobian", "deformation_energy"):  # marks stand in the sections of all grids
            choose(page, "#grid-shown", grid)
            before = page.value(sliders)
            page.value("document.querySelector('#next-folded').click()")
            assert page.value(sliders) != before
            assert page.value(MARKED) > 10, grid
        picture = seen(page, "canvas.surfaces")
        page.value("[...document.querySelectorAll('button.mark')].find(b => b.textContent.startsWith('fold')).click()")
        page.value(SETTLED)
        assert seen(page, "canvas.surfaces")["sum"] != picture["sum"]
        assert page.value("document.querySelector('#surfaces .told').textContent").startswith("fold inside 1;")
        marks = page.value("[...document.querySelectorAll('button.mark')].map(b => b.textContent).join()")
        assert "cell proven to fold 1" in marks, marks
        check_quiet(page)


def test_strangers():
    cli.icosphere(subdivisions=3)
    cli.cube()
    innermap("map", "ball.obj", "cube.obj", "-o", "out", "--resolution", "32", "--best-effort", "--html", "--quiet")
    with Browser() as browser:
        page = browser.open("out/report.html")
        check_surfaces(page)
        check_sections(page, ["jacobian"])
        check_quiet(page)


def check_frames_sections(page, frames):
    """Each frame has sections of its own, in the colours of all."""
    at = "document.querySelector('#sections .hint').textContent"
    legend = "document.querySelector('#sections .legend').textContent"
    seen_before, before = set(), page.value(legend)
    for i in range(frames):
        choose(page, "#frame-shown", i)
        number = page.value("document.querySelector('#frame-shown ~ output').textContent")
        assert page.value(at).startswith(f"frame {number}; "), page.value(at)
        assert page.value(legend) == before
        seen_before.add(seen(page, "#cut-z")["sum"])
    assert len(seen_before) == frames, "frames share their sections"
    choose(page, "#frame-shown", 0)


def check_sequence(path, frames, sections=True):
    with Browser() as browser:
        page = browser.open(path)
        check_surfaces(page)
        if sections:
            choose(page, "#frame-shown", min(frames - 1, 2))
            check_sections(page, ["deformation_energy", "jacobian"])
            check_frames_sections(page, min(frames, 5))
        assert page.value("document.querySelectorAll('#frames svg').length") >= 5
        assert page.value("document.querySelector('#frame-shown').max") == str(frames - 1)
        picture = seen(page, "canvas.surfaces")
        choose(page, "#frame-shown", frames - 1)
        assert seen(page, "canvas.surfaces")["sum"] != picture["sum"]
        last = page.value("document.querySelector('#frame-shown ~ output').textContent")
        assert page.value("document.querySelectorAll('.captions span')[1].textContent") == "frame " + last
        page.value("document.querySelector('#frames button.mark').click()")
        page.value(SETTLED)
        worst = page.value("document.querySelector('#frames button.mark').textContent")
        shown = page.value("document.querySelectorAll('.captions span')[1].textContent")
        assert (worst + " ").startswith(shown + " "), (worst, shown)
        check_quiet(page)
        print("ready after", page.value("document.documentElement.dataset.milliseconds"), "ms,",
              os.path.getsize(path), "bytes")


def test_sequence():
    ball_frames(twisted, {1: 0.1, 2: 0.3, 5: 0.6, 7: 0.2})
    innermap("sequence", "rest.obj", "frames", "-o", "out", "--charges", "400", "--resolution", "24",
             "--html", "--quiet")
    check_sequence("out/report.html", 4)
    # The same from the folder's files and the frames that the report names.
    innermap("report", "out", "-o", "again.html", "--quiet")
    check_sequence("again.html", 4, sections=False)
    # With grids, those of each frame come from its file.
    innermap("sequence", "rest.obj", "frames", "-o", "grids", "--charges", "400", "--resolution", "24",
             "--grids=surface,jacobian,deformation_energy", "--quiet")
    innermap("report", "grids", "-o", "grids.html", "--quiet")
    check_sequence("grids.html", 4)


def test_every_command():
    """--html beside each kind of output, and where it is told to."""
    hollow_ball(2)
    quick = ["--quiet", "--html"]
    os.mkdir("f")
    innermap("fit", "hollow.obj", "bent.obj", "-o", "f/map.ply", "--best-effort", *quick)
    innermap("evaluate", "f/map.ply", "-o", "map.vdb", "--resolution", "24", "--quiet", "--html=e.html")
    innermap("voxelize", "hollow.obj", "-o", "ball.vdb", "--resolution", "24", "--quiet", "--html=v.html")
    innermap("push", "f/map.ply", "ball.vdb", "-o", "pushed.vdb", "--quiet", "--html=p.html")
    innermap("check", "hollow.obj", *quick)
    assert [len(s["places"]) for s in data_of("f/report.html")["shapes"]] == [3]
    assert {g["name"] for g in data_of("e.html")["grids"]} >= {"jacobian", "surface", "map z"}
    assert {g["name"] for g in data_of("v.html")["grids"]} == {"surface"}
    assert data_of("p.html")["grids"] and data_of("p.html")["report"]["command"] == "push"
    assert data_of("report.html")["report"]["command"] == "check"
    with Browser() as browser:
        for path in ("f/report.html", "e.html", "v.html", "p.html", "report.html"):
            page = browser.open(path)
            check_quiet(page, known=False)
    fails(1, "check", "hollow.obj", "--html=hollow.obj", says=["hollow.obj"])
    innermap("check", "hollow.obj", "--html=dry.html", "--dry-run", "--quiet")
    assert not os.path.exists("dry.html")


def test_report_of_a_folder():
    hollow_ball(2)
    innermap("map", "hollow.obj", "bent.obj", "-o", "out", "--resolution", "24", "--best-effort", "--html", "--quiet")
    with_run = data_of("out/report.html")
    os.remove("out/report.html")
    assert "out/report.html" in innermap("report", "out", "--quiet").stdout
    again = data_of("out/report.html")
    for key in ("shapes", "grids"):
        assert [sorted(s) for s in again[key]] == [sorted(s) for s in with_run[key]], key
    assert again["shapes"][0]["places"] == with_run["shapes"][0]["places"]
    # What is missing is said, and the page is there.
    os.remove("out/map.ply")
    os.remove("out/map.vdb")
    os.remove("bent.obj")
    said = innermap("report", "out").stderr
    assert "bent.obj" in said and ".vdb" in said, said
    data = data_of("out/report.html")
    assert len(data["missing"]) == 2 and [len(s["places"]) for s in data["shapes"]] == [1]
    with Browser() as browser:
        page = browser.open("out/report.html")
        assert page.value("document.querySelectorAll('li.missing').length") == 2
        check_quiet(page)


def test_reports_are_not_trusted():
    fails(1, "report", "nowhere", says=["nowhere"])
    os.mkdir("out")
    fails(1, "report", "out", says=["report.json"])
    for text in ("[1]", "{", "", "\x00"):
        Path("out/report.json").write_text(text, encoding="utf-8")
        fails(1, "report", "out", says=["report.json"])
    hard = {"command": "</script><script>document.title = 'broken in'</script>",
            "source": {"path": 7, "vertices": "<img src=x onerror=alert(1)>"},
            "frames": {"file": [1, None, "nothing.obj"], "number": [1, 2, "x"]},
            "seconds": {"a": "b", "c": None}, "solve": [1], "steps": {"to": "x"}, "verdict": 5,
            "inside": {"folded_at": [1, 2]}, "notes": ["<b>bold</b>"], "energies": {"harmonic": [None, 1, 2]},
            "deep": json.loads("[" * 200 + "]" * 200)}
    Path("out/report.json").write_text(json.dumps(hard), encoding="utf-8")
    Path("out/map.ply").write_text("ply\nbroken", encoding="utf-8")
    Path("out/map.vdb").write_bytes(b"no grids")
    innermap("report", "out", "--quiet")
    with Browser() as browser:
        page = browser.open("out/report.html")
        assert page.value("document.title") != "broken in"
        assert page.value("document.querySelectorAll('main b, main img').length") == 0
        check_quiet(page, known=False)


def need_models():
    if not MODELS.is_dir():
        raise Skip("no models")


@nightly
def test_horse():
    need_models()
    poses = MODELS / "horse-poses"
    innermap("map", poses / "reference.obj", poses / "pose-03.obj", "-o", "out", "--html", "--quiet")
    with Browser() as browser:
        page = browser.open("out/report.html")
        check_surfaces(page)
        check_sections(page, ["deformation_energy", "jacobian"])
        marks = page.value("[...document.querySelectorAll('button.mark')].map(b => b.textContent)")
        assert any(m.startswith("target crosses itself") for m in marks), marks
        check_quiet(page)
        print("ready after", page.value("document.documentElement.dataset.milliseconds"), "ms,",
              os.path.getsize("out/report.html"), "bytes")
    data_of("out/report.html")


@nightly
def test_gallop():
    need_models()
    innermap("sequence", MODELS / "horse-poses" / "reference.obj", MODELS / "horse-gallop", "-o", "out",
             "--charges", "2000", "--resolution", "48", "--html", "--quiet")
    data_of("out/report.html")
    check_sequence("out/report.html", 48)


cli.run(globals())
