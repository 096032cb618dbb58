"""Harmonic maps and harmonic fields of solids that are given by their surfaces.

Meshes are arrays: V (n x 3, float64, world units) and F (m x 3, integers, counted from 0). Wherever
a mesh is asked for there may also stand a tuple (V, F), the path of a file (.obj, .ply, .off, .stl),
what read_mesh() returned, or an object with points and cells of triangles, such as meshio.Mesh.

    import innermap
    m = innermap.fit(V, F, V_target)     # the harmonic map of the inside
    Y, J = m(X, jacobian=True)           # points and derivatives
    X, found = m.inverse(Y)

Functions that take long let other threads run; Ctrl-C ends them within a second. All errors of the
library derive from innermap.Error.
"""
from innermap._innermap import *  # noqa: F401,F403
from innermap._innermap import __all__, __version__  # noqa: F401
from innermap._innermap import MemoryError  # noqa: F401  not by a star: it would hide Python's own
