#!/usr/bin/python3
"""Makes one source file of the C++ snippets of a page: its includes, then all else in one function,
so that a snippet sees what the earlier ones declare.

    docs_snippets.py OUTPUT PAGE...
"""
import os
import re
import sys

BLOCK = re.compile(r"^```cpp\n(.*?)^```$", re.M | re.S)


def source_of(page):
    with open(page, encoding="utf-8") as file:
        blocks = BLOCK.findall(file.read())
    if not blocks:
        sys.exit(f"{page}: has no C++ snippet")
    includes, code = [], []
    for block in blocks:
        for line in block.splitlines():
            (includes if line.startswith("#include") else code).append(line)
    name = re.sub(r"\W", "_", os.path.basename(page))
    return includes, [f"void {name}() {{", *code, "}"]


def main():
    output, pages = sys.argv[1], sys.argv[2:]
    includes, functions = ["#include <cstdio>"], []
    for page in pages:
        more, function = source_of(page)
        includes += [line for line in more if line not in includes]
        functions += function
    text = "\n".join(includes + [""] + functions) + "\n"
    with open(output, "w", encoding="utf-8") as file:
        file.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
