"""Shows that the blur of a baked fog is as long as that of the body around it: a ball that flies sideways, drawn
as a mesh and as fog, at rest and blurred, and the lengths measured in the pictures.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/motion_blur.py -- OUT.png [SAMPLES]

OUT.png has the mesh, the mesh blurred, the fog and the fog blurred, from the top down. Prints the lengths in
pixels and fails where they are not longer by the speed times the time that the shutter is open, or differ.
"""
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

import innermap

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools/blender"))
import innermap_blender  # noqa: E402

RADIUS, VOXEL = 0.5, 0.025
STEP, SHUTTER = 1.2, 0.5  # units a frame, frames
FRAMES = (1, 3)
SIZE, WIDTH = (400, 120), 4.0  # pixels, and units across
SEEN = 0.02  # of alpha


def linked(name, data):
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def flying_ball():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=RADIUS)
    ball = bpy.context.object
    ball.name = "body"
    # The middle of the picture in the middle frame.
    for frame in FRAMES:
        ball.location.x = STEP * (frame - sum(FRAMES) / 2)
        ball.keyframe_insert("location", frame=frame)
    for curve in ball.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = 'LINEAR'
    made = bpy.data.materials.new("bright")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.remove(nodes["Principled BSDF"])
    light = nodes.new('ShaderNodeEmission')
    made.node_tree.links.new(light.outputs[0], nodes["Material Output"].inputs["Surface"])
    ball.data.materials.append(made)
    return ball


def fog(folder):
    """Fills the ball in its first frame."""
    n = int(2 * RADIUS / VOXEL) + 4
    middle = STEP * (FRAMES[0] - sum(FRAMES) / 2)
    corner = -0.5 * (n - 1) * VOXEL
    matrix = np.diag([VOXEL, VOXEL, VOXEL, 1])
    matrix[:3, 3] = (middle + corner, corner, corner)
    at = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1) * VOXEL + corner
    inside = np.linalg.norm(at, axis=-1) < RADIUS - VOXEL
    path = os.path.join(folder, "fog.vdb")
    innermap.grids({"density": inside.astype(np.float32)}, matrix).write_vdb(path)
    volume = bpy.data.volumes.new("fog")
    volume.filepath = path
    made = bpy.data.materials.new("fog")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.remove(nodes["Principled BSDF"])
    smoke = nodes.new('ShaderNodeVolumePrincipled')
    smoke.inputs["Density"].default_value = 200
    made.node_tree.links.new(smoke.outputs[0], nodes["Material Output"].inputs["Volume"])
    volume.materials.append(made)
    return linked("fog", volume)


def set_up(samples):
    scene = bpy.context.scene
    bpy.ops.object.select_all(action='SELECT')
    bpy.ops.object.delete()
    scene.render.engine = 'CYCLES'
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = 'CPU', samples, False
    scene.cycles.volume_step_rate = 0.5
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scene.render.motion_blur_shutter = SHUTTER
    scene.frame_start, scene.frame_end = FRAMES
    camera = linked("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = 'ORTHO', WIDTH
    camera.location = (0, -5, 0)
    camera.rotation_euler = (np.pi / 2, 0, 0)
    scene.camera = camera
    return scene


def pixels(scene, path):
    scene.render.filepath = path
    scene.render.image_settings.color_depth = '16'
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    out = np.array(image.pixels[:], np.float32).reshape(SIZE[1], SIZE[0], 4)
    bpy.data.images.remove(image)
    return out


def length(image):
    """Pixels from the first to the last column, in the middle rows, that anything is in."""
    middle = image[SIZE[1] // 2 - 2:SIZE[1] // 2 + 2, :, 3].mean(axis=0)
    seen = np.flatnonzero(middle > SEEN)
    return int(seen[-1] - seen[0] + 1) if len(seen) else 0


def main(out, samples):
    with tempfile.TemporaryDirectory() as folder:
        scene = set_up(samples)
        innermap_blender.register()
        ball = flying_ball()
        smoke = fog(folder)
        scene.frame_set(FRAMES[0])
        settings = scene.innermap
        settings.body, settings.rest_frame, settings.quality = ball, FRAMES[0], 'DRAFT'
        settings.targets = bpy.data.collections.new("inside")
        settings.targets.objects.link(smoke)
        settings.folder = folder
        assert bpy.ops.innermap.bake() == {'FINISHED'}
        scene.frame_set(sum(FRAMES) // 2)
        lengths, rows = {}, []
        for shown, hidden in ((ball, smoke), (smoke, ball)):
            shown.hide_render, hidden.hide_render = False, True
            for blur in (False, True):
                scene.render.use_motion_blur = blur
                image = pixels(scene, os.path.join(folder, "one.png"))
                lengths[shown.name, blur] = length(image)
                rows.append(image)
        if out:
            picture = bpy.data.images.new("all", SIZE[0], 4 * SIZE[1], alpha=True)
            picture.pixels = np.concatenate(rows[::-1]).ravel()
            picture.filepath_raw, picture.file_format = os.path.abspath(out), 'PNG'
            picture.save()
    smear = STEP * SHUTTER * SIZE[0] / WIDTH
    for name in ("body", "fog"):
        still, blurred = lengths[name, False], lengths[name, True]
        print(f"{name}: {still} pixels still, {blurred} blurred, {blurred - still} longer; {smear:.0f} wanted")
    for name in ("body", "fog"):
        # What is nearly clear at the ends of the smear is not seen.
        assert abs(lengths[name, True] - lengths[name, False] - smear) <= 0.1 * smear + 2, lengths
    assert abs(lengths["body", True] - lengths["fog", True]) <= 4, lengths


arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
main(arguments[0] if arguments else "", int(arguments[1]) if len(arguments) > 1 else 64)
