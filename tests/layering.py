#!/usr/bin/python3
"""Checks the layers: which folder of lib/innermap may include which, that solve/ knows no mesh and
no grid, that headers whose first comment says "Internal to FOLDER/" stay in their folder, and that
every other header has its unit test.

    layering.py [ROOT]      exit code 1 and one line for each finding
"""
import os
import re
import sys

# Direct dependencies; what those depend on is allowed too, and core to all.
DIRECT = {
    "core": [],
    "mesh": ["core"],
    "solve": ["core"],
    "levelset": ["mesh"],
    "sample": ["levelset", "mesh"],
    "field": ["solve"],
    "evaluate": ["field", "levelset"],
    "surface": ["mesh"],
    "transfer": ["evaluate", "mesh"],
    "tetra": ["evaluate", "levelset"],
    "output": ["core"],
}
# Words that must not stand in a folder's sources, comments aside.
FORBIDDEN = {"solve": r"\bmesh\b|\bMesh\b|openvdb"}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)


def closure(folder):
    allowed, waiting = {folder, "core"}, [folder]
    while waiting:
        for other in DIRECT[waiting.pop()]:
            if other not in allowed:
                allowed.add(other)
                waiting.append(other)
    return allowed


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)


def is_internal(root, included):
    path = os.path.join(root, "lib", included)
    if not os.path.exists(path):
        return False
    with open(path, encoding="utf-8") as file:
        comment = file.read().split("#pragma once")[0].replace("\n// ", " ")
    return re.search(rf"\b(Internal|Private) to {included.split('/')[1]}/", comment) is not None


def sources(top):
    for folder, _, names in os.walk(top):
        for name in sorted(names):
            if name.endswith((".h", ".cc", ".hpp", ".cpp", ".inl")):
                yield os.path.join(folder, name)


def check_folder(root, folder):
    """Findings of one folder of lib/innermap."""
    if folder not in DIRECT:
        yield f"lib/innermap/{folder}: not a folder of the design"
        return
    allowed = closure(folder)
    for path in sources(os.path.join(root, "lib/innermap", folder)):
        here = os.path.relpath(path, root)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for included in INCLUDE.findall(text):
            parts = included.split("/")
            if parts[0] != "innermap":
                if not os.path.dirname(included) and os.path.exists(
                        os.path.join(os.path.dirname(path), included)):
                    yield f'{here}: include "innermap/{folder}/{included}", by its path'
                elif ".." in parts or parts[0] in ("lib", "tools", "tests"):
                    yield f'{here}: includes "{included}", not by its path from lib/'
            elif len(parts) != 3:
                yield f'{here}: includes "{included}", which is in no folder'
            elif parts[1] not in allowed:
                yield f"{here}: {folder} must not include {parts[1]} ({included})"
            elif parts[1] != folder and is_internal(root, included):
                yield f"{here}: {included} is internal to {parts[1]}"
            elif not os.path.exists(os.path.join(root, "lib", included)):
                yield f'{here}: includes "{included}", which is not there'
        forbidden = FORBIDDEN.get(folder)
        found = forbidden and re.search(forbidden, without_comments(text))
        if found:
            yield f'{here}: {folder} must not know of "{found.group()}"'


def check_tests(root, folder):
    """Public headers without tests/unit/<folder>/<header>_test.cc."""
    top = os.path.join(root, "lib/innermap", folder)
    for name in sorted(os.listdir(top)):
        if not name.endswith(".h") or is_internal(root, f"innermap/{folder}/{name}"):
            continue
        test = f"tests/unit/{folder}/{name[:-2]}_test.cc"
        path = os.path.join(root, test)
        if not os.path.exists(path):
            yield f"lib/innermap/{folder}/{name}: no unit test, {test} is missing"
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if f'"innermap/{folder}/{name}"' not in text:
            yield f"{test}: does not include innermap/{folder}/{name}"
        elif not re.search(r"^\s*(TYPED_)?TEST(_[FP])?\(", text, re.M):
            yield f"{test}: has no test"


def check_tools(root):
    for path in sources(os.path.join(root, "tools")):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for included in INCLUDE.findall(text):
            if included.startswith("innermap/") and is_internal(root, included):
                yield f"{os.path.relpath(path, root)}: {included} is internal to its folder"


def check(root):
    yield from check_tools(root)
    lib = os.path.join(root, "lib/innermap")
    for folder in sorted(os.listdir(lib)):
        if os.path.isdir(os.path.join(lib, folder)):
            yield from check_folder(root, folder)
            if folder in DIRECT:
                yield from check_tests(root, folder)
        elif folder.endswith((".h", ".cc")):
            yield f"lib/innermap/{folder}: in no folder of the design"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(here)
    found = list(check(root))
    print("\n".join(found) if found else "The layers are as the design says.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
