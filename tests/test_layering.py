#!/usr/bin/python3
"""Shows that layering.py finds what it is for: a tree that breaks each rule once."""
import os
import tempfile
import unittest

import layering

CLEAN = {
    "lib/CMakeLists.txt": "innermap_room(core LINK x)\ninnermap_room(mesh DEPENDS core)\n"
                          "innermap_room(solve DEPENDS core LINK y)\n"
                          "innermap_room(sample DEPENDS mesh GRIDS)\n",
    "lib/include/innermap/innermap.h": "",
    "lib/include/innermap/core/a.h": "",
    "tests/unit/core/a_test.cc": '#include "innermap/core/a.h"\nTEST(A, B) {}\n',
    "lib/mesh/m.cc": '#include "innermap/core/a.h"\n',
    "lib/mesh/detail/own.h": "",
    "lib/mesh/n.cc": '#include "core/all.h"\n#include "mesh/detail/own.h"\n',
    "lib/core/all.h": "",
    "lib/sample/s.cc": '#include "core/all.h"\n#include <vector>\n',
    "lib/solve/s.cc": "// no mesh here\nint x;\n",
    "tools/innermap/t.cc": '#include "core/all.h"\n#include "innermap/core/a.h"\n#include "option.h"\n',
    "tools/innermap/study/s.cc": '#include "study/s.h"\n',
}
BROKEN = {
    "edge upwards": ({"lib/mesh/m.cc": '#include "sample/t.h"\n', "lib/sample/t.h": ""},
                     "mesh must not include sample"),
    "edge aside": ({"lib/solve/s.cc": '#  include <sample/s.h>\n'}, "solve must not include sample"),
    "core below all": ({"lib/include/innermap/core/a.h": '#include "innermap/mesh/m.h"\n'},
                       "core must not include mesh"),
    "include of nothing": ({"lib/mesh/m.cc": '#include "innermap/core/b.h"\n'}, "not there"),
    "private include of nothing": ({"lib/mesh/m.cc": '#include "core/b.h"\n'}, "not there"),
    "include round the rule": ({"lib/mesh/m.cc": '#include "../core/all.h"\n'}, "not by its path"),
    "include of a neighbour": ({"lib/core/c.cc": '#include "all.h"\n'}, "not by its path"),
    "another room's own": ({"lib/sample/s.cc": '#include "mesh/detail/own.h"\n'}, "is mesh's own"),
    "public includes private": ({"lib/include/innermap/core/a.h": '#include "core/all.h"\n'},
                                "is public and includes"),
    "cycle": ({"lib/mesh/detail/b.h": '#include "mesh/detail/c.h"\n', "lib/mesh/detail/c.h": "",
               "lib/mesh/detail/c.cc": '#include "mesh/detail/b.h"\n'},
              "includes itself"),
    "what may be left out": ({"tools/innermap/study/s.h": "", "tools/innermap/t.cc": '#include "study/s.h"\n'},
                             "which a build may leave out"),
    "private header in a tool": ({"tools/innermap/t.cc": '#include "mesh/x.h"\n'}, "mesh/x.h is private"),
    "core's own in a tool": ({"tools/innermap/t.cc": '#include "core/detail/x.h"\n'}, "x.h is private"),
    "grid in solve": ({"lib/solve/s.cc": "openvdb::FloatGrid grid;\n"}, "must not know of"),
    "two types of one name": ({"lib/mesh/detail/own.h": "struct Side {\n  int x;\n};\n",
                               "lib/core/all.h": "enum class Side { in, out };\n"},
                              "defines Side, as"),
    "unknown room": ({"lib/other/o.cc": ""}, "not an innermap_room"),
    "loose file": ({"lib/loose.cc": ""}, "in no room"),
    "loose header": ({"lib/include/innermap/loose.h": ""}, "in no room"),
    "no test": ({"lib/include/innermap/mesh/n.h": ""}, "no test in tests/unit/mesh/"),
    "empty test": ({"tests/unit/core/a_test.cc": '#include "innermap/core/a.h"\n'}, "no test in"),
    "test of another": ({"tests/unit/core/a_test.cc": "TEST(A, B) {}\n"}, "no test in"),
}


def findings(files):
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = os.path.join(root, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        return list(layering.check(root))


class Layering(unittest.TestCase):
    def test_clean_tree(self):
        self.assertEqual(findings(CLEAN), [])

    def test_each_break_is_found_alone(self):
        for name, (change, message) in BROKEN.items():
            with self.subTest(name):
                found = findings({**CLEAN, **change})
                self.assertEqual(len(found), 1, found)
                self.assertIn(message, found[0])

    def test_too_many_public_headers(self):
        many = [f"h{number}" for number in range(layering.MOST_PUBLIC)]
        files = {f"lib/include/innermap/core/{name}.h": "" for name in many}
        files["tests/unit/core/h_test.cc"] = "TEST(A, B) {}\n" + "".join(
            f'#include "innermap/core/{name}.h"\n' for name in many)
        found = findings({**CLEAN, **files})
        self.assertEqual(len(found), 1, found)
        self.assertIn("headers, at most", found[0])


if __name__ == "__main__":
    unittest.main()
