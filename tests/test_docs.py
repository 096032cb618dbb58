#!/usr/bin/python3
"""README.md is short, and what its pages link to is there.

    test_docs.py [ROOT]      exit code 1 and one line for each finding
"""
import os
import re
import sys

MOST_LINES = 200
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def findings(root):
    pages = ["README.md", "CONTRIBUTING.md"]
    pages += sorted(os.path.join("docs", name) for name in os.listdir(os.path.join(root, "docs"))
                    if name.endswith(".md"))
    linked = set()
    for page in pages:
        path = os.path.join(root, page)
        if not os.path.exists(path):
            yield f"{page}: is missing"
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if page == "README.md" and text.count("\n") > MOST_LINES:
            yield f"{page}: has {text.count(chr(10))} lines; at most {MOST_LINES}"
        for target in LINK.findall(text):
            if "://" in target:
                continue
            full = os.path.normpath(os.path.join(os.path.dirname(path), target))
            linked.add(os.path.relpath(full, root))
            if not os.path.exists(full):
                yield f"{page}: links to {target}, which is not there"
    for page in pages[1:]:
        if page not in linked:
            yield f"{page}: no page links to it"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    found = list(findings(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(here)))
    print("\n".join(found) if found else "All links lead somewhere.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
