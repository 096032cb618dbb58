#!/usr/bin/env python3
"""Checks the pages (*.md, but in build folders): every relative link and picture is there, with its
heading where the link names one; every picture has a text in its place and is no larger than 300 kB (3 MB
if it moves); README.md is short; README.md and CONTRIBUTING.md are there, and to all others some page links;
docs/install.md names each package of scripts/packages that a build takes, and the Dockerfile takes them from there.

    test_docs.py [ROOT]      exit code 1 and one line for each finding
"""
import re
import sys
from pathlib import Path

README_LINES = 150
PICTURE_BYTES = {".webp": 3_000_000}
BUILD = ("build", "libraries", "python")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```", re.M | re.S)
SKIPPED = re.compile(r"^(build|out|\.git)")


def pages(root):
    for path in sorted(root.rglob("*.md")):
        if not SKIPPED.match(path.relative_to(root).parts[0]):
            yield path


def anchors(text):
    """The anchors that a page's headings get: lower case, no punctuation, hyphens for spaces."""
    found = set()
    for heading in re.findall(r"^#+ (.+)$", CODE.sub("", text), re.M):
        words = re.sub(r"[^\w\- ]", "", LINK.sub(r"\2", heading).lower())
        found.add(words.strip().replace(" ", "-"))
    return found


def findings(root):
    linked = {root / "README.md"}
    for name in ["README.md", "CONTRIBUTING.md"]:
        if not (root / name).exists():
            yield f"{name}: is not there"
    for page in pages(root):
        text = page.read_text(encoding="utf-8")
        name, lines = page.relative_to(root), text.count("\n")
        if str(name) == "README.md" and lines > README_LINES:
            yield f"README.md: {lines} lines, over {README_LINES}"
        for picture, words, target in LINK.findall(re.sub(r"`[^`\n]*`", "", CODE.sub("", text))):
            if picture and not words.strip():
                yield f"{name}: the picture {target} has no text in its place"
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            linked.add(file)
            if not file.exists():
                yield f"{name}: {target} is not there"
            elif picture and file.stat().st_size > PICTURE_BYTES.get(file.suffix, 300_000):
                yield f"{name}: {target} has {file.stat().st_size} bytes; make it smaller"
            elif anchor and file.suffix == ".md" and anchor not in anchors(
                    file.read_text(encoding="utf-8")):
                yield f"{name}: {target}: no heading of that name"
    for page in pages(root):
        if page not in linked:
            yield f"{page.relative_to(root)}: no page links to it"


def packages(root):
    """{group: packages} of scripts/packages."""
    groups = {}
    for line in (root / "scripts/packages").read_text(encoding="utf-8").split("\n"):
        if line.startswith("["):
            named = groups.setdefault(line.strip("[]"), [])
        elif line and not line.startswith("#"):
            named.append(line)
    return groups


def install_findings(root):
    groups = packages(root)
    words = set(re.findall(r"[\w.+-]+", (root / "docs/install.md").read_text(encoding="utf-8")))
    for package in [package for group in BUILD for package in groups[group]]:
        if package not in words:
            yield f"docs/install.md: {package} of scripts/packages is missing"
    if "RUN scripts/install-packages " + " ".join(BUILD) not in (root / "Dockerfile").read_text(encoding="utf-8"):
        yield f"Dockerfile: does not install the groups {BUILD} of scripts/packages"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1]).resolve()
    found = [*findings(root), *install_findings(root)]
    print("\n".join(found) if found else f"{len(list(pages(root)))} pages are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
