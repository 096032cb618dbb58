#!/usr/bin/python3
"""Checks the layers of the library. Its rooms and which may include which stand in lib/CMakeLists.txt
(innermap_room, DEPENDS). Headers of a room are public (lib/include/innermap/ROOM/, installed), private to
the library (lib/ROOM/), or the room's own (a detail/ in it).

Found are: includes of rooms that are not below, of a header that is not there, of another room's own; public
headers that include private ones, or are more than MOST_PUBLIC, or that no test of the room includes;
programs that include private headers of other rooms than OPEN; includes of parts that a build may leave out
(COMPONENTS); files that include themselves by way of others; two headers that define types of one name (their
files would link to either's code); a solve/ that knows of meshes or grids.

    layering.py [ROOT]      exit code 1 and one line for each finding
"""
import os
import re
import sys

# Words that must not stand in a room's sources, comments aside.
FORBIDDEN = {"solve": r"\bmesh\b|\bMesh\b|openvdb"}
# Rooms whose private headers serve the programs of this repository too.
OPEN = ("core", "jobs", "report")
MOST_PUBLIC = 50
# Rooms that a build may leave out, and with them all folders of their names (cmake/InnermapComponents.cmake).
COMPONENTS = ("tetra", "study")
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)\b(?!::)[^;(]*\{", re.M)
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)
PUBLIC = "lib/include/innermap"


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def read_edges(root):
    """Direct dependencies of each room, from lib/CMakeLists.txt."""
    edges = {}
    for name, rest in re.findall(r"^innermap_room\((\w+)([^)]*)\)", read(os.path.join(root, "lib/CMakeLists.txt")), re.M):
        words = rest.split()
        start = words.index("DEPENDS") + 1 if "DEPENDS" in words else len(words)
        depends = []
        for word in words[start:]:
            if word.isupper():
                break
            depends.append(word)
        edges[name] = depends
    return edges


def closure(edges, room):
    allowed, waiting = {room}, [room]
    while waiting:
        for other in edges[waiting.pop()]:
            if other not in allowed:
                allowed.add(other)
                waiting.append(other)
    return allowed


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)


def sources(top):
    for folder, _, names in os.walk(top):
        for name in sorted(names):
            if name.endswith((".h", ".cc", ".hpp", ".cpp", ".inl")):
                yield os.path.join(folder, name)


def parse(included, edges):
    """(room, whether public, whether the room's own) of an include of ours; None: not ours."""
    parts = included.split("/")
    if parts[0] == "innermap" and len(parts) == 3:
        return parts[1], True, False
    if len(parts) > 1 and parts[0] in edges:
        return parts[0], False, "detail" in parts[1:-1]
    return None


def check_room(root, room, edges):
    """Findings of one room: its public headers and what stands in its folder."""
    allowed = closure(edges, room)
    for public, top in ((True, f"{PUBLIC}/{room}"), (False, f"lib/{room}")):
        for path in sources(os.path.join(root, top)):
            here, text = os.path.relpath(path, root), read(path)
            for included in INCLUDE.findall(text):
                yield from check_include(root, room, here, public, included, edges, allowed)
            found = room in FORBIDDEN and re.search(FORBIDDEN[room], without_comments(text))
            if found:
                yield f'{here}: {room} must not know of "{found.group()}"'


def check_include(root, room, here, public, included, edges, allowed):
    found = parse(included, edges)
    if not found:
        first = included.split("/")[0]
        beside = os.path.join(root, os.path.dirname(here), included)
        if first in ("..", "lib", "tools", "tests", "innermap") or os.path.exists(beside):
            yield f'{here}: includes "{included}", not by its path from lib/ or lib/include/'
        return
    other, is_public, own = found
    if other not in allowed:
        yield f"{here}: {room} must not include {other} ({included})"
    elif not os.path.exists(os.path.join(root, "lib/include" if is_public else "lib", included)):
        yield f'{here}: includes "{included}", which is not there'
    elif own and other != room:
        yield f"{here}: {included} is {other}'s own"
    elif public and not is_public:
        yield f"{here}: is public and includes {included}, which is not"


def check_tests(root, room):
    """Public headers that no test of the room is for."""
    tests = [read(path) for path in sources(os.path.join(root, "tests/unit", room))]
    tests = [text for text in tests if re.search(r"^\s*(TYPED_)?TEST(_[FP])?\(", text, re.M)]
    for path in sources(os.path.join(root, PUBLIC, room)):
        header = os.path.relpath(path, os.path.join(root, "lib/include"))
        if not any(f'"{header}"' in text for text in tests):
            yield f"lib/include/{header}: no test in tests/unit/{room}/ includes it"


def check_outside(root, top, edges):
    """Programs see public headers, and those of the rooms that are open to them."""
    for path in sources(os.path.join(root, top)):
        here = os.path.relpath(path, root)
        program = os.path.join(root, *here.split("/")[:2])
        for included in INCLUDE.findall(read(path)):
            found = parse(included, edges)
            if os.path.exists(os.path.join(program, included)):
                continue  # a folder of its own, named as a room
            if found and not found[1] and (found[2] or found[0] not in OPEN):
                yield f"{here}: {included} is private"


def check_components(root):
    """What stays in a build includes nothing of what it may leave out."""
    for top in ("lib", "tools"):
        for path in sources(os.path.join(root, top)):
            here = os.path.relpath(path, root)
            for included in INCLUDE.findall(read(path)):
                for component in COMPONENTS:
                    if component in included.split("/")[:-1] and component not in here.split("/")[:-1]:
                        yield f'{here}: includes "{included}", which a build may leave out'


def unit_of(path):
    return re.sub(r"\.(h|cc)$", "", path)


def check_cycles(root):
    """Headers that include each other, directly or round about. A private header and its source are one
    unit; a public header, which stands for several sources, is one without them."""
    lib = os.path.join(root, "lib")
    includes = {}
    for path in sources(lib):
        unit = unit_of(re.sub(r"^include/", "", os.path.relpath(path, lib)))
        units = {unit_of(i) for i in INCLUDE.findall(read(path))}
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
        for name in sorted(set(TYPE.findall(without_comments(read(path))))):
            if name in seen:
                yield f"{here}: defines {name}, as {seen[name]} does"
            seen[name] = here


def check_places(root, edges):
    """Rooms that lib/CMakeLists.txt does not have, and files in none."""
    for top, others in (("lib", ("include", "modules", "precompiled")), (PUBLIC, ())):
        for name in sorted(os.listdir(os.path.join(root, top))):
            if os.path.isdir(os.path.join(root, top, name)):
                if name not in edges and name not in others:
                    yield f"{top}/{name}: not an innermap_room of lib/CMakeLists.txt"
            elif name.endswith((".cc", ".h")) and (top, name) != (PUBLIC, "innermap.h"):
                yield f"{top}/{name}: in no room"


def check(root):
    edges = read_edges(root)
    yield from check_places(root, edges)
    for top in ("tools", "tests/install"):
        yield from check_outside(root, top, edges)
    yield from check_cycles(root)
    yield from check_names(root)
    yield from check_components(root)
    for room in sorted(edges):
        yield from check_room(root, room, edges)
        yield from check_tests(root, room)
    public = sum(1 for _ in sources(os.path.join(root, PUBLIC)))
    if public > MOST_PUBLIC:
        yield f"{PUBLIC}: {public} headers, at most {MOST_PUBLIC} are wanted"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(here)
    found = list(check(root))
    print("\n".join(found) if found else "The layers are as the design says.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
