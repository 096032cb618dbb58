"""How each kind of object is baked: what plays it, and how that is cleared again.

Objects that something was baked onto have a property innermap_baked with the kind.
"""

import os

import bpy
from mathutils import Vector

from . import files
from .geometry import evaluated, rest_points, write_key

NAME = "Inner map"
POINT_TYPES = {'MESH', 'CURVE', 'CURVES'}
TYPES = POINT_TYPES | {'VOLUME'}


def chosen(context, settings, body):
    """What is inside: the collection's objects, else the selected ones."""
    objects = settings.targets.all_objects if settings.targets else context.selected_objects
    return [ob for ob in objects if ob.type in TYPES and ob != body]


def own_shape_keys(ob):
    return ob.type in {'MESH', 'CURVE'} and ob.data.shape_keys is not None and \
        ob.get("innermap_baked") not in {'KEYS', 'CURVE'}


def clear(ob, keep=None):
    """Takes away what was baked onto an object, but for the lattice `keep`; True if there was something."""
    kind = ob.get("innermap_baked")
    if not kind:
        return False
    for modifier in [m for m in ob.modifiers if m.name == NAME]:
        helper = getattr(modifier, "object", None) if kind == 'LIVE' else None
        tree = getattr(modifier, "node_group", None) if kind == 'HAIR' else None
        ob.modifiers.remove(modifier)
        if helper and helper != keep and helper.users <= 1 and helper.get("innermap_lattice"):
            bpy.data.lattices.remove(helper.data)
        if tree:
            bpy.data.node_groups.remove(tree)
    if kind in {'KEYS', 'CURVE'} and ob.data.shape_keys:
        for key in list(ob.data.shape_keys.key_blocks)[::-1]:
            ob.shape_key_remove(key)
    if kind == 'HAIR':
        clear_hair(ob)
    if kind == 'VOLUME':
        clear_volume(ob)
    del ob["innermap_baked"]
    return True


def first_modifier(ob, kind):
    modifier = ob.modifiers.new(NAME, kind)
    if hasattr(ob.modifiers, "move"):  # Blender 4
        ob.modifiers.move(len(ob.modifiers) - 1, 0)
        return ob.modifiers[0]
    with bpy.context.temp_override(object=ob):
        bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)
    return ob.modifiers[0]


def play_cache(ob, path, places, frames, settings):
    """A point cache and the modifier that plays it, before all others."""
    files.write_pc2(path, places, frames[0])
    modifier = first_modifier(ob, 'MESH_CACHE')
    modifier.cache_format, modifier.filepath = 'PC2', files.stored(path, settings)
    modifier.frame_start = frames[0]  # the default, 0, plays one frame off


def play_keys(ob, places, frames):
    """Absolute shape keys, one a frame: a single curve drives them, and no key mixes with a third."""
    rest = rest_points(ob) if ob.type != 'LATTICE' else None
    basis = ob.shape_key_add(name="Rest", from_mix=False)
    if rest is not None:
        write_key(ob, basis, rest)
    for frame, points in zip(frames, places):
        write_key(ob, ob.shape_key_add(name=f"Frame {frame}", from_mix=False), points)
    keys = ob.data.shape_keys
    keys.use_relative = False
    blocks = keys.key_blocks
    for block in blocks:
        block.interpolation = 'KEY_LINEAR'
    for frame, block in ((frames[0], blocks[1]), (frames[-1], blocks[-1])):
        keys.eval_time = block.frame
        keys.keyframe_insert("eval_time", frame=frame)
    for curve in curves_of(keys.animation_data):
        for point in curve.keyframe_points:
            point.interpolation = 'LINEAR'


def curves_of(animation):
    """The curves of an action; Blender 5 has them in the bag of the slot that is animated."""
    action = animation.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    bags = (strip.channelbag(animation.action_slot) for layer in action.layers for strip in layer.strips)
    return [curve for bag in bags if bag for curve in bag.fcurves]


def new_socket(tree, way):
    """way: 'INPUT' or 'OUTPUT' of a geometry."""
    if hasattr(tree, "interface"):  # Blender 4
        tree.interface.new_socket("Geometry", in_out=way, socket_type='NodeSocketGeometry')
    else:
        (tree.inputs if way == 'INPUT' else tree.outputs).new('NodeSocketGeometry', "Geometry")


def play_hair(ob, path, places, frames, settings):
    """Hair has neither caches nor keys: a hidden mesh with its points does, and nodes copy them."""
    mesh = bpy.data.meshes.new(f"{NAME} {ob.name}")
    mesh.vertices.add(places.shape[1])
    carrier = bpy.data.objects.new(mesh.name, mesh)
    bpy.context.scene.collection.objects.link(carrier)
    carrier.hide_render = True
    carrier.hide_set(True)
    play_cache(carrier, path, places, frames, settings)
    ob["innermap_points"] = carrier
    tree = bpy.data.node_groups.new(f"{NAME} {ob.name}", 'GeometryNodeTree')
    new_socket(tree, 'INPUT')
    new_socket(tree, 'OUTPUT')
    node = tree.nodes.new
    start, end, info, sample, position, index, move = map(node, (
        'NodeGroupInput', 'NodeGroupOutput', 'GeometryNodeObjectInfo', 'GeometryNodeSampleIndex',
        'GeometryNodeInputPosition', 'GeometryNodeInputIndex', 'GeometryNodeSetPosition'))
    info.inputs["Object"].default_value = carrier
    sample.data_type, sample.domain = 'FLOAT_VECTOR', 'POINT'
    value = [s for s in sample.inputs if s.name == "Value" and s.enabled][0]
    out = [s for s in sample.outputs if s.enabled][0]
    for a, b in ((info.outputs["Geometry"], sample.inputs["Geometry"]),
                 (position.outputs[0], value), (index.outputs[0], sample.inputs["Index"]),
                 (start.outputs[0], move.inputs["Geometry"]), (out, move.inputs["Position"]),
                 (move.outputs[0], end.inputs[0])):
        tree.links.new(a, b)
    first_modifier(ob, 'NODES').node_group = tree


def clear_hair(ob):
    carrier = ob.pop("innermap_points", None)
    if carrier:
        bpy.data.meshes.remove(carrier.data)


# Volumes. Blender draws a .vdb half a voxel off along each axis: an object that plays what was
# baked is moved back by that, and what it was before stands in its property innermap_rest.

PLAYED = ("is_sequence", "frame_start", "frame_duration", "frame_offset", "velocity_unit",
          "velocity_scale")


def rest_volume(ob):
    """What a volume was before anything was baked onto it."""
    if ob.get("innermap_baked") == 'VOLUME':
        return ob["innermap_rest"].to_dict()
    grids = evaluated(ob).data.grids  # of a sequence, those of the frame
    if not grids.load() or not len(grids):
        raise ValueError(f"{ob.name}: {ob.data.filepath} has no grids ({grids.error_message})")
    played = {name: getattr(ob.data, name) for name in PLAYED}
    return {"filepath": ob.data.filepath, "frame_path": grids.frame_filepath,
            "delta": list(ob.delta_location), **played}


def play_volume(ob, pattern, rest, frames, settings, grid):
    """grid: (4, 4), from voxels to the object's space."""
    data = ob.data
    ob["innermap_rest"] = rest
    data.filepath = files.stored(pattern.replace("####", f"{frames[0]:04d}"), settings)
    data.is_sequence = True
    data.frame_start, data.frame_duration, data.frame_offset = frames[0], len(frames), frames[0] - 1
    data.velocity_unit, data.velocity_scale = 'SECOND', 1  # per frame, as it is, ignores the shutter
    half = ob.matrix_basis.to_3x3() @ Vector(grid[:3, :3] @ [0.5, 0.5, 0.5])
    ob.delta_location = Vector(rest["delta"]) - half


def clear_volume(ob):
    rest = ob.pop("innermap_rest", None)
    if rest is None:
        return
    ob.data.filepath = rest["filepath"]
    for name in PLAYED:
        if name in rest:
            setattr(ob.data, name, type(getattr(ob.data, name))(rest[name]))
    ob.delta_location = rest["delta"]


def move_frames(made, pattern, frames):
    """The frames of a volume from where they were made to where they are played."""
    for frame in frames:
        os.replace(made.replace("####", f"{frame:04d}"), pattern.replace("####", f"{frame:04d}"))
