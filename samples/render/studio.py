"""What the picture scripts of this folder share: a scene with soft light, cameras, materials, meshes made of
arrays, cuts, and labels. Runs inside Blender 3.4, whose Cycles has no denoiser on Debian: the one here takes
its place."""
import math
import sys
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[2]
MODELS = ROOT.parent / "shared/models"
PAPER = (0.80, 0.83, 0.87)


def arguments(usage):
    """OUT [SAMPLES], after "--" of Blender's command line."""
    given = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if not given:
        sys.exit(usage)
    return str(Path(given[0]).resolve()), int(given[1]) if len(given) > 1 else 64


def scene(size, samples, world=0.75):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = bpy.context.scene
    made.render.engine = 'CYCLES'
    made.cycles.samples, made.cycles.use_denoising = samples, False
    made.cycles.max_bounces, made.cycles.transparent_max_bounces = 6, 24
    made.cycles.volume_bounces = 1
    made.render.resolution_x, made.render.resolution_y = size
    made.render.resolution_percentage = 100
    made.render.filter_size = 1.2
    made.view_settings.view_transform = 'Standard'
    made.world = bpy.data.worlds.new("world")
    made.world.use_nodes = True
    background = made.world.node_tree.nodes["Background"]
    background.inputs[0].default_value = (0.92, 0.95, 1, 1)
    background.inputs[1].default_value = world
    return made


def linked(name, data, at=(0, 0, 0)):
    ob = bpy.data.objects.new(name, data)
    ob.location = at
    bpy.context.scene.collection.objects.link(ob)
    return ob


def camera(at, to, lens=50, across=None):
    """Looks from `at` to `to`; `across`: orthographic, so many units wide."""
    ob = linked("camera", bpy.data.cameras.new("camera"), at)
    ob.rotation_euler = (Vector(to) - Vector(at)).to_track_quat('-Z', 'Y').to_euler()
    ob.data.lens = lens
    if across:
        ob.data.type, ob.data.ortho_scale = 'ORTHO', across
    bpy.context.scene.camera = ob
    return ob


def light(at, to, size, watts, colour=(1, 1, 1)):
    ob = linked("light", bpy.data.lights.new("light", 'AREA'), at)
    ob.data.energy, ob.data.size, ob.data.color = watts, size, colour
    ob.rotation_euler = (Vector(to) - Vector(at)).to_track_quat('-Z', 'Y').to_euler()
    return ob


def material(name):
    """An empty material: itself, its nodes, links and output."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    return made, nodes, made.node_tree.links, nodes.new('ShaderNodeOutputMaterial')


def plain(name, colour, rough=0.5):
    made, nodes, links, out = material(name)
    shader = nodes.new('ShaderNodeBsdfPrincipled')
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = rough
    links.new(shader.outputs[0], out.inputs["Surface"])
    return made


def painted(name, rough=0.4, specular=0.4):
    """Takes its colour from the mesh's attribute "rgb"."""
    made, nodes, links, out = material(name)
    shader, colour = nodes.new('ShaderNodeBsdfPrincipled'), nodes.new('ShaderNodeVertexColor')
    colour.layer_name = "rgb"
    shader.inputs["Roughness"].default_value = rough
    shader.inputs["Specular"].default_value = specular
    links.new(colour.outputs[0], shader.inputs["Base Color"])
    links.new(shader.outputs[0], out.inputs["Surface"])
    return made


def glass(name, colour, facing=0.05, edge=0.8, power=2.0):
    """See-through where it faces the camera, coloured along the outline."""
    made, nodes, links, out = material(name)
    clear, solid = nodes.new('ShaderNodeBsdfTransparent'), nodes.new('ShaderNodeBsdfPrincipled')
    solid.inputs["Base Color"].default_value = (*colour, 1)
    solid.inputs["Roughness"].default_value = 0.3
    weight, curve = nodes.new('ShaderNodeLayerWeight'), nodes.new('ShaderNodeMath')
    curve.operation, curve.inputs[1].default_value = 'POWER', power
    share, mix = nodes.new('ShaderNodeMapRange'), nodes.new('ShaderNodeMixShader')
    share.inputs[3].default_value, share.inputs[4].default_value = facing, edge
    links.new(weight.outputs["Facing"], curve.inputs[0])
    links.new(curve.outputs[0], share.inputs[0])
    links.new(share.outputs[0], mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(solid.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], out.inputs["Surface"])
    return made


def mesh(name, points, faces, made, rgb=None, at=(0, 0, 0), smooth=True):
    """An object of the mesh; rgb: linear colours of the points."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(np.asarray(points).tolist(), [], np.asarray(faces).tolist())
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    if rgb is not None:
        layer = data.color_attributes.new("rgb", 'FLOAT_COLOR', 'POINT')
        layer.data.foreach_set("color", np.c_[rgb, np.ones(len(rgb))].astype(np.float32).ravel())
    data.materials.append(made)
    return linked(name, data, at)


def floor(height, colour=PAPER):
    """A floor that rises behind, without an edge."""
    rows = [(-40, height)] + [(6 + 8 * math.sin(a), height + 8 * (1 - math.cos(a)))
                              for a in np.linspace(0, math.pi / 2, 24)] + [(14, height + 40)]
    points = [(x, y, z) for y, z in rows for x in (-60, 60)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(rows) - 1)]
    return mesh("floor", points, faces, plain("paper", colour, 0.9))


def cut(ob, at, normal, cap):
    """Takes away what lies along `normal` from `at` (in the object's space), and closes the cut with `cap`."""
    shape = bmesh.new()
    shape.from_mesh(ob.data)
    found = bmesh.ops.bisect_plane(shape, geom=shape.verts[:] + shape.edges[:] + shape.faces[:],
                                   plane_co=at, plane_no=normal, clear_outer=True)
    rim = [e for e in found["geom_cut"] if isinstance(e, bmesh.types.BMEdge)]
    filled = bmesh.ops.triangle_fill(shape, edges=rim, use_beauty=False, use_dissolve=False)
    ob.data.materials.append(cap)
    for face in filled["geom"]:
        if isinstance(face, bmesh.types.BMFace):
            face.material_index, face.smooth = 1, False
    shape.to_mesh(ob.data)
    shape.free()


def srgb(colour):
    """Linear from what screens show."""
    c = np.asarray(colour, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def ramp(share):
    """Colours of the turbo colour map (Mikhailov 2019, a polynomial), linear."""
    x = np.clip(np.asarray(share, float), 0, 1)[..., None]
    powers = np.concatenate([x ** k for k in range(6)], axis=-1)
    rows = np.array([[0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943],
                     [0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604],
                     [0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973]])
    return srgb(np.clip(powers @ rows.T, 0, 1))


def label(text, at, size, camera_ob, colour=(0.10, 0.12, 0.15)):
    """Words that face the camera; `at` is the middle of their line."""
    curve = bpy.data.curves.new("label", 'FONT')
    curve.body, curve.size = text, size
    curve.align_x, curve.align_y = 'CENTER', 'CENTER'
    fonts = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
    if fonts.exists():
        curve.font = bpy.data.fonts.load(str(fonts))
    made, nodes, links, out = material("ink")
    ink = nodes.new('ShaderNodeEmission')
    ink.inputs[0].default_value = (*colour, 1)
    links.new(ink.outputs[0], out.inputs["Surface"])
    curve.materials.append(made)
    ob = linked("label", curve, at)
    ob.rotation_euler = camera_ob.rotation_euler
    ob.visible_shadow = False
    return ob


def box_mean(image, radius):
    """The mean over a square of pixels about each."""
    padded = np.pad(image, radius, mode='edge')
    total = np.pad(padded.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    n = 2 * radius + 1
    return (total[n:, n:] - total[:-n, n:] - total[n:, :-n] + total[:-n, :-n]) / n ** 2


def without_noise(image, strength, reach=5):
    """Non-local means (Buades, Coll and Morel 2005): each pixel becomes the mean of those about it that have
    like neighbours. strength: how far colours may differ, in 0 to 1."""
    high, wide = image.shape[:2]
    padded = np.pad(image, ((reach, reach), (reach, reach), (0, 0)), mode='reflect')
    total, weights = np.zeros_like(image), np.zeros((high, wide, 1))
    for y in range(2 * reach + 1):
        for x in range(2 * reach + 1):
            other = padded[y:y + high, x:x + wide]
            apart = box_mean(((other - image) ** 2).mean(axis=2), 1)
            weight = np.exp(-apart / strength ** 2)[..., None]
            total += weight * other
            weights += weight
    return total / weights


def drawn(strength):
    """The picture without noise, as an image of Blender and as its pixels, sRGB from below."""
    settings = bpy.context.scene.render
    settings.filepath = str(Path(bpy.app.tempdir) / "noisy.png")
    settings.image_settings.file_format = 'PNG'
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(settings.filepath, check_existing=False)
    wide, high = image.size
    pixels = np.array(image.pixels[:]).reshape(high, wide, -1)[..., :3]
    return image, without_noise(pixels, strength) if strength else pixels


def render(out, strength=0.06, quality=90):
    """Draws into OUT, JPEG or PNG by its ending, and takes the noise away."""
    image, pixels = drawn(strength)
    image.pixels = np.concatenate([pixels, np.ones((*pixels.shape[:2], 1))], axis=2).astype(np.float32).ravel()
    settings = bpy.context.scene.render
    settings.image_settings.file_format = 'JPEG' if out.endswith("jpg") else 'PNG'
    settings.image_settings.quality = quality
    image.save_render(out)
