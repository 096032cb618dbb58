"""Draws volumes side by side, from above, each cut open half way down: grids `density` and `Cd` as
`innermap texture`, `push` and `deform` write them.

    blender -b --factory-startup --python-exit-code 1 --python samples/render/volume.py -- \
        OUT.jpg SAMPLES FIRST.vdb [SECOND.vdb ...]
"""
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.append(str(Path(__file__).parent))
import studio  # noqa: E402

PIXELS = (600, 640)  # of each volume


def flesh(height):
    """The volume's colours; nothing above `height`, in the object's space."""
    made, nodes, links, out = studio.material("flesh")
    fog = nodes.new('ShaderNodeVolumePrincipled')
    fog.inputs["Color Attribute"].default_value = "Cd"
    fog.inputs["Density Attribute"].default_value = ""
    values, place = nodes.new('ShaderNodeAttribute'), nodes.new('ShaderNodeTexCoord')
    values.attribute_name = "density"
    parts, below = nodes.new('ShaderNodeSeparateXYZ'), nodes.new('ShaderNodeMath')
    below.operation, below.inputs[1].default_value = 'LESS_THAN', height + 0.02
    dense, scale = nodes.new('ShaderNodeMath'), nodes.new('ShaderNodeMath')
    dense.operation = scale.operation = 'MULTIPLY'
    scale.inputs[1].default_value = 260
    links.new(place.outputs["Object"], parts.inputs[0])
    links.new(parts.outputs["Z"], below.inputs[0])
    links.new(values.outputs["Fac"], dense.inputs[0])
    links.new(below.outputs[0], dense.inputs[1])
    links.new(dense.outputs[0], scale.inputs[0])
    links.new(scale.outputs[0], fog.inputs["Density"])
    # What is dense swallows most light on its way in: half of the colour is its own.
    colour, glow = nodes.new('ShaderNodeAttribute'), nodes.new('ShaderNodeMath')
    colour.attribute_name = "Cd"
    glow.operation, glow.inputs[1].default_value = 'MULTIPLY', 0.5
    links.new(scale.outputs[0], glow.inputs[0])
    links.new(glow.outputs[0], fog.inputs["Emission Strength"])
    links.new(colour.outputs["Color"], fog.inputs["Emission Color"])
    links.new(fog.outputs[0], out.inputs["Volume"])
    return made


def placed(path, x):
    """The volume with its middle at x; how wide and high it is."""
    data = bpy.data.volumes.new(Path(path).stem)
    data.filepath = str(Path(path).resolve())
    ob = studio.linked(data.name, data)
    if not data.grids.load():
        sys.exit(f"{path}: {data.grids.error_message}")
    half = data.grids[0].matrix_object.to_3x3() @ Vector((0.5, 0.5, 0.5))  # Blender's voxels begin at their corner
    bpy.context.view_layer.update()
    box = np.array([corner[:] for corner in ob.bound_box])
    middle = (box.min(axis=0) + box.max(axis=0)) / 2
    data.materials.append(flesh(middle[2]))
    data.render.step_size = 0
    ob.location = Vector((x - middle[0], -middle[1], -box[:, 2].min())) - half
    return np.ptp(box, axis=0)


def main():
    given = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(given) < 3:
        sys.exit(__doc__)
    out, samples, paths = str(Path(given[0]).resolve()), int(given[1]), given[2:]
    made = studio.scene((PIXELS[0] * len(paths), PIXELS[1]), samples, 0.45)
    made.cycles.volume_step_rate = 1.0
    made.cycles.volume_bounces = 2
    # Places come after sizes are known: all volumes side by side, as wide as the widest.
    sizes = [placed(path, 0) for path in paths]
    wide, high = np.max([s[0] for s in sizes]), np.max([s[1] for s in sizes])
    wide = max(1.05 * wide, 1.05 * high * PIXELS[0] / PIXELS[1])
    volumes = [ob for ob in bpy.data.objects if ob.type == 'VOLUME']
    for i, ob in enumerate(volumes):
        ob.location.x += (i - (len(volumes) - 1) / 2) * wide
    studio.mesh("floor", [(-90, -90, 0), (90, -90, 0), (90, 90, 0), (-90, 90, 0)], [(0, 1, 2, 3)],
                studio.plain("paper", studio.PAPER, 0.9))
    studio.camera((0, 0, 10), (0, 0, 0), across=wide * len(volumes))
    size = wide * len(volumes)
    studio.light((-0.8 * size, 0.8 * size, 1.2 * size), (0, 0, 0), 0.5 * size, 15 * size * size, (1, 0.96, 0.9))
    studio.light((size, -size, size), (0, 0, 0), size, 5 * size * size, (0.85, 0.93, 1))
    studio.render(out)


if __name__ == "__main__":
    main()
