#!/usr/bin/python3
"""Checks the layers: which folder of lib/innermap may include which (the DEPENDS in
lib/CMakeLists.txt), that solve/ knows no mesh and no grid, that programs include no
header of a detail/ (those serve the library alone and are not installed), that no file includes
itself by way of others, that no two headers define types of one name (their files would link to
either's code), and that every public header has its unit test.

    layering.py [ROOT]      exit code 1 and one line for each finding
"""
import os
import re
import sys

# Words that must not stand in a folder's sources, comments aside.
FORBIDDEN = {"solve": r"\bmesh\b|\bMesh\b|openvdb"}
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)[^;(]*\{", re.M)
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)


def read_edges(root):
    """Direct dependencies of each folder, from lib/CMakeLists.txt."""
    with open(os.path.join(root, "lib/CMakeLists.txt"), encoding="utf-8") as file:
        text = file.read()
    edges = {}
    for name, rest in re.findall(r"^innermap_folder\((\w+)([^)]*)\)", text, re.M):
        words = rest.split()
        start = words.index("DEPENDS") + 1 if "DEPENDS" in words else len(words)
        depends = []
        for word in words[start:]:
            if word.isupper():
                break
            depends.append(word)
        edges[name] = depends
    return edges


def closure(edges, folder):
    allowed, waiting = {folder}, [folder]
    while waiting:
        for other in edges[waiting.pop()]:
            if other not in allowed:
                allowed.add(other)
                waiting.append(other)
    return allowed


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)


def is_internal(included):
    return "detail" in included.split("/")[2:-1]


def sources(top):
    for folder, _, names in os.walk(top):
        for name in sorted(names):
            if name.endswith((".h", ".cc", ".hpp", ".cpp", ".inl")):
                yield os.path.join(folder, name)


def check_folder(root, folder, edges):
    """Findings of one folder of lib/innermap."""
    if folder not in edges:
        yield f"lib/innermap/{folder}: not an innermap_folder of lib/CMakeLists.txt"
        return
    allowed = closure(edges, folder)
    for path in sources(os.path.join(root, "lib/innermap", folder)):
        here = os.path.relpath(path, root)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for included in INCLUDE.findall(text):
            parts = included.split("/")
            if parts[0] != "innermap":
                if not os.path.dirname(included) and os.path.exists(
                        os.path.join(os.path.dirname(path), included)):
                    yield f'{here}: includes "{included}", not by its path from lib/'
                elif ".." in parts or parts[0] in ("lib", "tools", "tests"):
                    yield f'{here}: includes "{included}", not by its path from lib/'
            elif len(parts) < 3:
                yield f'{here}: includes "{included}", which is in no folder'
            elif parts[1] not in allowed:
                yield f"{here}: {folder} must not include {parts[1]} ({included})"
            elif not os.path.exists(os.path.join(root, "lib", included)):
                yield f'{here}: includes "{included}", which is not there'
        forbidden = FORBIDDEN.get(folder)
        found = forbidden and re.search(forbidden, without_comments(text))
        if found:
            yield f'{here}: {folder} must not know of "{found.group()}"'


def check_tests(root, folder):
    """Public headers without tests/unit/<their path>_test.cc."""
    lib = os.path.join(root, "lib")
    for path in sources(os.path.join(lib, "innermap", folder)):
        header = os.path.relpath(path, lib)
        if not header.endswith(".h") or is_internal(header):
            continue
        test = f"tests/unit/{header[len('innermap/'):-2]}_test.cc"
        path = os.path.join(root, test)
        if not os.path.exists(path):
            yield f"lib/{header}: no unit test, {test} is missing"
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if f'"{header}"' not in text:
            yield f"{test}: does not include {header}"
        elif not re.search(r"^\s*(TYPED_)?TEST(_[FP])?\(", text, re.M):
            yield f"{test}: has no test"


def check_outside(root, top):
    """Programs see public headers only."""
    for path in sources(os.path.join(root, top)):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for included in INCLUDE.findall(text):
            if included.startswith("innermap/") and is_internal(included):
                yield f"{os.path.relpath(path, root)}: {included} is internal to its folder"


def unit_of(path):
    """A header and its source are one unit."""
    return re.sub(r"\.(h|cc)$", "", path)


def check_cycles(root):
    """Units (a header with its source) that include each other, directly or round about."""
    lib = os.path.join(root, "lib")
    includes = {}
    for path in sources(lib):
        with open(path, encoding="utf-8") as file:
            units = {unit_of(i) for i in INCLUDE.findall(file.read())}
        unit = unit_of(os.path.relpath(path, lib))
        includes.setdefault(unit, set()).update(units - {unit})
    state, trail = {}, []

    def visit(unit):
        state[unit] = "open"
        trail.append(unit)
        for other in sorted(includes.get(unit, ())):
            if state.get(other) == "open":
                yield f"lib/{other}: includes itself: " + " -> ".join(trail[trail.index(other):] + [other])
            elif other not in state:
                yield from visit(other)
        trail.pop()
        state[unit] = "done"

    for unit in sorted(includes):
        if unit not in state:
            yield from visit(unit)


def check_names(root):
    """Types that two headers define in the one namespace of the library."""
    seen = {}
    for path in sources(os.path.join(root, "lib")):
        if not path.endswith(".h"):
            continue
        here = os.path.relpath(path, root)
        with open(path, encoding="utf-8") as file:
            names = TYPE.findall(without_comments(file.read()))
        for name in sorted(set(names)):
            if name in seen:
                yield f"{here}: defines {name}, as {seen[name]} does"
            seen[name] = here


def check(root):
    edges = read_edges(root)
    for top in ("tools", "tests/install", "python"):
        yield from check_outside(root, top)
    yield from check_cycles(root)
    yield from check_names(root)
    lib = os.path.join(root, "lib/innermap")
    for folder in sorted(os.listdir(lib)):
        if os.path.isdir(os.path.join(lib, folder)):
            yield from check_folder(root, folder, edges)
            if folder in edges:
                yield from check_tests(root, folder)
        elif folder.endswith(".cc"):
            yield f"lib/innermap/{folder}: in no folder of the design"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(here)
    found = list(check(root))
    print("\n".join(found) if found else "The layers are as the design says.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
