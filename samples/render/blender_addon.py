"""Draws docs/hosts/blender.jpg: a gecko at rest and in a stride, marbles and a ball of fog around each of
them, which the add-on for Blender carried. Marbles are a mesh and the fog is a volume: that each marble stays in
the middle of its fog shows that both go the same way.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/blender_addon.py -- OUT.jpg [SAMPLES]
"""
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

import innermap

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools/blender"))
import innermap_blender  # noqa: E402

FIRST, LAST = 1, 12
MARBLES, VOXEL = 15, 0.008
SIZE = (560, 760)


def linked(name, data):
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def material(name):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    for node in list(nodes):
        if node.type != 'OUTPUT_MATERIAL':
            nodes.remove(node)
    return made, nodes, made.node_tree.links, nodes["Material Output"]


def skin():
    """Clear where it faces the camera, bright along the outline."""
    made, nodes, links, out = material("skin")
    facing, mix = nodes.new('ShaderNodeLayerWeight'), nodes.new('ShaderNodeMixShader')
    clear, solid = nodes.new('ShaderNodeBsdfTransparent'), nodes.new('ShaderNodeBsdfDiffuse')
    solid.inputs["Color"].default_value = (0.6, 0.8, 0.9, 1)
    facing.inputs["Blend"].default_value = 0.25
    links.new(facing.outputs["Facing"], mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(solid.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], out.inputs["Surface"])
    return made


def fog_material():
    made, nodes, links, out = material("fog")
    fog = nodes.new('ShaderNodeVolumePrincipled')
    fog.inputs["Color"].default_value = (0.9, 0.95, 1, 1)
    fog.inputs["Density"].default_value = 14
    links.new(fog.outputs[0], out.inputs["Volume"])
    return made


def body(rest, triangles, pose):
    mesh = bpy.data.meshes.new("gecko")
    mesh.from_pydata(rest.tolist(), [], triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(skin())
    ob = linked("gecko", mesh)
    ob.shape_key_add(name="rest")
    key = ob.shape_key_add(name="stride")
    key.data.foreach_set("co", pose.astype(np.float32).ravel())
    for frame, value in ((FIRST, 0), (LAST, 1)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return ob


def centres(rest):
    """Along the spine, and how far the skin is from each."""
    low, high = rest[:, 1].min(), rest[:, 1].max()
    out = []
    for y in np.linspace(low, high, MARBLES + 2)[1:-1]:
        near = rest[np.abs(rest[:, 1] - y) < 0.05]
        near = near[np.abs(near[:, 0]) < 0.25]
        at = np.array([near[:, 0].mean(), y, (near[:, 2].min() + near[:, 2].max()) / 2])
        out.append((at, np.linalg.norm(rest - at, axis=1).min()))
    return out


def marbles(places):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1)
    ball = bpy.context.object.data
    unit = np.array([v.co[:] for v in ball.vertices])
    faces = [tuple(p.vertices) for p in ball.polygons]
    bpy.data.objects.remove(bpy.context.object)
    points = np.concatenate([c + 0.4 * r * unit for c, r in places])
    mesh = bpy.data.meshes.new("marbles")
    mesh.from_pydata(points.tolist(), [],
                     [tuple(v + i * len(unit) for v in f) for i in range(len(places)) for f in faces])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    made, nodes, links, out = material("marble")
    shader = nodes.new('ShaderNodeBsdfPrincipled')
    shader.inputs["Base Color"].default_value = (0.9, 0.18, 0.03, 1)
    shader.inputs["Roughness"].default_value = 0.2
    links.new(shader.outputs[0], out.inputs["Surface"])
    mesh.materials.append(made)
    return linked("marbles", mesh)


def fog(places, folder):
    points = np.array([c for c, _ in places])
    most = max(r for _, r in places)
    low, high = points.min(axis=0) - most, points.max(axis=0) + most
    axes = [np.arange(a, b, VOXEL) for a, b in zip(low, high)]
    at = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    density = np.zeros(at.shape[:3], np.float32)
    for c, r in places:
        away = np.linalg.norm(at - c, axis=-1) / (0.85 * r)
        density = np.maximum(density, np.clip(4 * (1 - away), 0, 1))
    matrix = np.diag([VOXEL, VOXEL, VOXEL, 1])
    matrix[:3, 3] = low
    path = str(Path(folder) / "fog.vdb")
    innermap.grids({"density": density.astype(np.float32)}, matrix).write_vdb(path)
    volume = bpy.data.volumes.new("fog")
    volume.filepath = path
    volume.materials.append(fog_material())
    return linked("fog", volume)


def look_down(scene, middle, samples):
    camera = linked("camera", bpy.data.cameras.new("camera"))
    camera.location = (middle[0], middle[1], 6)
    camera.data.type, camera.data.ortho_scale = 'ORTHO', 2.75
    scene.camera = camera
    for place, power in (((-2, 2, 4), 260), ((3, -1, 3), 90)):
        light = linked("light", bpy.data.lights.new("light", 'AREA'))
        light.data.energy, light.data.size, light.location = power, 2, place
        light.rotation_euler = (-light.location).to_track_quat('-Z', 'Y').to_euler()
    scene.world.color = (0.02, 0.03, 0.05)
    scene.world.use_nodes = False
    scene.render.engine = 'CYCLES'
    scene.cycles.samples, scene.cycles.use_denoising = samples, False
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = 'Standard'


def rendered(scene, frame, path):
    scene.frame_set(frame)
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    return np.array(image.pixels[:]).reshape(SIZE[1], SIZE[0], 4)


def main(out, samples, folder):
    rest, triangles = innermap.read_mesh(ROOT / "samples/gecko.obj")
    pose, _ = innermap.read_mesh(ROOT / "samples/gecko_step.obj")
    bpy.ops.object.select_all(action='SELECT')
    bpy.ops.object.delete()
    innermap_blender.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    scene.innermap.body = body(rest, triangles, pose)
    places = centres(rest)
    inside = bpy.data.collections.new("inside")
    for ob in marbles(places), fog(places, folder):
        inside.objects.link(ob)
    settings = scene.innermap
    settings.targets, settings.folder, settings.rest_frame = inside, folder, FIRST
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    look_down(scene, (rest.min(axis=0) + rest.max(axis=0)) / 2, samples)
    both = np.concatenate([rendered(scene, frame, str(Path(folder) / f"{frame}.png"))
                           for frame in (FIRST, LAST)], axis=1)
    image = bpy.data.images.new("both", both.shape[1], both.shape[0])
    image.pixels = both.astype(np.float32).ravel()
    image.filepath_raw, image.file_format = out, 'JPEG'
    image.save()


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1:]
    with tempfile.TemporaryDirectory() as temporary:
        main(str(Path(given[0]).resolve()), int(given[1]) if len(given) > 1 else 64, temporary)
