"""Renders volumes side by side with Blender's Cycles:

    blender -b --factory-startup -noaudio --python-exit-code 3 --python samples/render_volume.py \\
        -- OUT.png FILE.vdb...

Density from the grid `density`, colour from `color`; the y axis points up.
"""
import math
import os
import sys

import bpy
from mathutils import Vector

out, *files = sys.argv[sys.argv.index("--") + 1:]


def node_tree():
    material = bpy.data.materials.new("volume")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 60
    volume.inputs["Density Attribute"].default_value = "density"
    volume.inputs["Color Attribute"].default_value = "color"
    links.new(volume.outputs["Volume"], output.inputs["Volume"])
    return material


bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
material = node_tree()
offset, size = 0.0, 0.0
for path in files:
    bpy.ops.object.volume_import(filepath=os.path.abspath(path))
    volume = bpy.context.object
    volume.data.grids.load()
    corners = [Vector(c) for c in volume.bound_box]
    low = [min(c[a] for c in corners) for a in range(3)]
    high = [max(c[a] for c in corners) for a in range(3)]
    width = high[2] - low[2]
    # World y up, seen along -x: z of the file runs to the left.
    volume.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    volume.location = (offset + width / 2 + (low[2] + high[2]) / 2, 0, -(low[1] + high[1]) / 2)
    volume.data.materials.append(material)
    offset += 1.1 * width
    size = max(size, high[1] - low[1])

camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.type = "ORTHO"
camera.data.ortho_scale = 1.02 * max(offset, size)
camera.location = (offset / 2 - 0.05, -10, 0)
camera.rotation_euler = (math.pi / 2, 0, 0)
scene.collection.objects.link(camera)
scene.camera = camera
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy = 6
sun.rotation_euler = (0.9, 0.2, 0.5)
scene.collection.objects.link(sun)
world = bpy.data.worlds.new("world")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs[0].default_value = (0.6, 0.65, 0.7, 1)
scene.world = world
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 96
scene.cycles.use_denoising = False
scene.cycles.volume_bounces = 2
scene.cycles.seed = 1
scene.render.resolution_x = 720
scene.render.resolution_y = max(200, int(720 * size * 1.1 / max(offset, size)))
scene.view_settings.view_transform = "Standard"
scene.render.filepath = os.path.abspath(out)
bpy.ops.render.render(write_still=True)
