#!/usr/bin/python3
"""Shows that layering.py finds what it is for: a tree that breaks each rule once."""
import os
import tempfile
import unittest

import layering

CLEAN = {
    "lib/CMakeLists.txt": "innermap_folder(core LINK x)\ninnermap_folder(mesh DEPENDS core)\n"
                          "innermap_folder(solve DEPENDS core LINK y)\n"
                          "innermap_folder(sample DEPENDS mesh GRIDS)\n",
    "lib/innermap/core/a.h": "",
    "tests/unit/core/a_test.cc": '#include "innermap/core/a.h"\nTEST(A, B) {}\n',
    "lib/innermap/mesh/m.cc": '#include "innermap/core/a.h"\n',
    "lib/innermap/mesh/detail/own.h": "",
    "lib/innermap/mesh/n.cc": '#include "innermap/core/detail/all.h"\n',
    "lib/innermap/core/detail/all.h": "",
    "lib/innermap/sample/s.cc": '#include "innermap/mesh/m.cc"\n#include <vector>\n',
    "lib/innermap/solve/s.cc": "// no mesh here\nint x;\n",
}
BROKEN = {
    "edge upwards": ({"lib/innermap/mesh/m.cc": '#include "innermap/sample/detail/t.h"\n',
                      "lib/innermap/sample/detail/t.h": ""},
                     "mesh must not include sample"),
    "edge aside": ({"lib/innermap/solve/s.cc": '#  include <innermap/sample/s.cc>\n'},
                   "solve must not include sample"),
    "core below all": ({"lib/innermap/core/a.h": '#include "innermap/mesh/detail/own.h"\n'},
                       "core must not include mesh"),
    "include of nothing": ({"lib/innermap/mesh/m.cc": '#include "innermap/core/b.h"\n'},
                           "not there"),
    "include round the rule": ({"lib/innermap/mesh/m.cc": '#include "../core/a.h"\n'},
                               "not by its path"),
    "cycle": ({"lib/innermap/mesh/detail/b.h": '#include "innermap/mesh/detail/c.h"\n',
               "lib/innermap/mesh/detail/c.h": "",
               "lib/innermap/mesh/detail/c.cc": '#include "innermap/mesh/detail/b.h"\n'},
              "includes itself"),
    "internal header in a tool": ({"tools/t.cc": '#include "innermap/mesh/detail/own.h"\n'},
                                  "is internal to its folder"),
    "grid in solve": ({"lib/innermap/solve/s.cc": "openvdb::FloatGrid grid;\n"},
                      "must not know of"),
    "two types of one name": ({"lib/innermap/mesh/detail/own.h": "struct Side {\n  int x;\n};\n",
                               "lib/innermap/core/detail/all.h": "enum class Side { in, out };\n"},
                              "defines Side, as"),
    "unknown folder": ({"lib/innermap/other/o.cc": ""}, "not an innermap_folder"),
    "loose file": ({"lib/innermap/loose.cc": ""}, "in no folder"),
    "no test": ({"lib/innermap/mesh/n.h": ""}, "tests/unit/mesh/n_test.cc is missing"),
    "empty test": ({"tests/unit/core/a_test.cc": '#include "innermap/core/a.h"\n'}, "has no test"),
    "test of another": ({"tests/unit/core/a_test.cc": "TEST(A, B) {}\n"}, "does not include"),
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


if __name__ == "__main__":
    unittest.main()
