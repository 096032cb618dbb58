#!/usr/bin/env python3
"""Checks the pages (*.md, but in build folders): every relative link and picture is there, with its
heading where the link names one; every picture has a text in its place; README.md is short; README.md
and CONTRIBUTING.md are there, and to all others some page links.

    test_docs.py [ROOT]      exit code 1 and one line for each finding
"""
import re
import sys
from pathlib import Path

README_LINES = 150
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
            elif anchor and file.suffix == ".md" and anchor not in anchors(
                    file.read_text(encoding="utf-8")):
                yield f"{name}: {target}: no heading of that name"
    for page in pages(root):
        if page not in linked:
            yield f"{page.relative_to(root)}: no page links to it"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1]).resolve()
    found = list(findings(root))
    print("\n".join(found) if found else f"{len(list(pages(root)))} pages are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
