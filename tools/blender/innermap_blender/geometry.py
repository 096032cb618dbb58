"""Points and meshes out of Blender, as arrays in world space."""

import bpy
import numpy as np


class Refused(Exception):
    """What cannot be done, with the object's name and the frame."""


def matrix(m):
    return np.array(m, np.float64)


def apply(m, points):
    return points @ m[:3, :3].T + m[:3, 3]


def evaluated(ob):
    return ob.evaluated_get(bpy.context.evaluated_depsgraph_get())


def coordinates(collection, name="co"):
    out = np.empty(3 * len(collection), np.float32)
    collection.foreach_get(name, out)
    return out.reshape(-1, 3).astype(np.float64)


def body_places(ob):
    """World places of the vertices as they are now, modifiers applied."""
    ev = evaluated(ob)
    mesh = ev.to_mesh()
    try:
        return apply(matrix(ev.matrix_world), coordinates(mesh.vertices))
    finally:
        ev.to_mesh_clear()


def body_mesh(ob):
    """The same, with triangles. Of one frame alone: others may be cut along other diagonals."""
    ev = evaluated(ob)
    mesh = ev.to_mesh()
    try:
        places = apply(matrix(ev.matrix_world), coordinates(mesh.vertices))
        mesh.calc_loop_triangles()
        triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
    finally:
        ev.to_mesh_clear()
    if len(triangles) == 0:
        raise Refused(f"{ob.name}: has no faces; choose a closed mesh as the body")
    triangles = triangles.reshape(-1, 3)
    if np.linalg.det(matrix(ev.matrix_world)[:3, :3]) < 0:  # mirrored objects are inside out
        triangles = triangles[:, ::-1].copy()
    return places, triangles


# Points of what is carried, in the object's own space: (n, 3).

def key_points(ob):
    """The shape keys' own points, key by key in one order, of a key or of a curve's splines."""
    rows = []
    for spline in ob.data.splines:
        if spline.type == 'BEZIER':
            for p in spline.bezier_points:
                rows += [p.handle_left[:], p.co[:], p.handle_right[:]]
        else:
            rows += [p.co[:3] for p in spline.points]
    return np.array(rows, np.float64).reshape(-1, 3)


def rest_points(ob):
    if ob.type == 'MESH':
        if ob.data.shape_keys and ob.get("innermap_baked") != 'KEYS':
            active = ob.active_shape_key_index
            key = ob.shape_key_add(name="innermap", from_mix=True)
            try:
                return coordinates(key.data)
            finally:
                ob.shape_key_remove(key)
                ob.active_shape_key_index = active
        return coordinates(ob.data.vertices)
    if ob.type == 'CURVES':
        return coordinates(ob.data.points, "position")
    return key_points(ob)


def write_key(ob, key, points):
    if ob.type in {'MESH', 'LATTICE'}:
        key.data.foreach_set("co", points.astype(np.float32).ravel())
        return
    at = 0
    for d in key.data:
        if hasattr(d, "handle_left"):
            d.handle_left, d.co, d.handle_right = points[at:at + 3]
            at += 3
        else:
            d.co = points[at]
            at += 1
