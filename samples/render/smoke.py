"""Smoke in a horse at rest, and in frames of its gallop. Needs the test models beside the project.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/smoke.py -- OUT.jpg [SAMPLES]
"""
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector

sys.path.append(str(Path(__file__).parent))
import innermap  # noqa: E402
import studio  # noqa: E402

FRAMES = (4, 8, 12)
HORSES = studio.MODELS / "horse-gallop"


def smoke(V, F):
    """Swirls: sheets of a stretched random field, thick in the middle; colours from nose to tail."""
    grids = innermap.voxelize(V, F, resolution=130, fog=True)
    fog, matrix = np.asarray(grids["density"]), grids.matrix
    at = np.stack(np.meshgrid(*[np.arange(n) for n in fog.shape], indexing="ij"), axis=-1).astype(float)
    size = np.ptp(V, axis=0).max()
    P = (at @ matrix[:3, :3].T + matrix[:3, 3] - V.min(axis=0)) / size
    rng = np.random.default_rng(8)
    bent = P + 0.03 * np.sin(P[..., ::-1] @ rng.normal(0, 16, (3, 3)) + rng.uniform(0, 6, 3))
    sheets = np.sin(bent @ rng.normal(0, 30, 3)) * np.sin(bent @ rng.normal(0, 34, 3) + 2)
    density = fog * np.clip(0.10 + 1.5 * np.maximum(sheets, 0) ** 1.5, 0, 1)
    along = P[..., int(np.argmax(np.ptp(V, axis=0)))]
    return innermap.grids({"density": density.astype(np.float32),
                           "Cd": studio.ramp(0.1 + 0.85 * along).astype(np.float32)}, matrix)


def cloud(scale):
    made, nodes, links, out = studio.material("smoke")
    fog = nodes.new('ShaderNodeVolumePrincipled')
    fog.inputs["Color Attribute"].default_value = "Cd"
    fog.inputs["Density Attribute"].default_value = ""
    values, dense, glow, colour = (nodes.new(f'ShaderNode{n}') for n in ("Attribute", "Math", "Math", "Attribute"))
    values.attribute_name, colour.attribute_name = "density", "Cd"
    dense.operation = glow.operation = 'MULTIPLY'
    dense.inputs[1].default_value, glow.inputs[1].default_value = scale, 0.45
    links.new(values.outputs["Fac"], dense.inputs[0])
    links.new(dense.outputs[0], fog.inputs["Density"])
    links.new(dense.outputs[0], glow.inputs[0])
    links.new(glow.outputs[0], fog.inputs["Emission Strength"])
    links.new(colour.outputs["Color"], fog.inputs["Emission Color"])
    links.new(fog.outputs[0], out.inputs["Volume"])
    return made


def posed(V, F, pose, grids):
    """The smoke at rest, or where the pose takes it."""
    if pose is V:
        return grids
    fit = innermap.fit(V, F, pose, tolerance=3e-3, one_to_one="off")
    return innermap.push(fit, grids, densities=["density"], resolution=130)


def stand(pose, F, grids, path, materials, foot):
    """A horse of glass with its smoke, which `path` will hold, with the middle of its box above `foot`, facing
    along x. Gives back what it made."""
    grids.write_vdb(path)
    size, middle = np.ptp(pose, axis=0), (pose.min(axis=0) + pose.max(axis=0)) / 2
    turn = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()
    place = Euler((0, 0, np.pi / 2 if np.argmax(size) == 2 else 0)).to_matrix().to_4x4() @ turn
    shift = Vector(foot) - place @ Vector((middle[0], 0, middle[2]))
    body = studio.mesh("horse", pose, F, materials[0])
    body.visible_shadow = False
    data = bpy.data.volumes.new("smoke")
    data.filepath = path
    data.grids.load()
    data.materials.append(materials[1])
    volume = studio.linked("smoke", data)
    half = Vector((0.5, 0.5, 0.5)) * float(np.asarray(grids.matrix)[0, 0])  # Blender's voxels begin at their corner
    for ob, off in ((body, Vector((0, 0, 0))), (volume, half)):
        ob.matrix_world = place
        ob.location = shift - (place.to_3x3() @ off)
    return body, volume


def materials(height):
    return studio.glass("skin", (0.70, 0.85, 0.95), 0.06, 0.9, 1.6), cloud(34 / height)


def surroundings(height, wide):
    """Floor, camera and lights for horses so high, in a picture so wide."""
    studio.floor(0, (0.045, 0.07, 0.095))
    studio.camera((0, -9 * height, 1.5 * height), (0, 0, 0.5 * height), across=wide)
    studio.light((-3 * height, -3 * height, 5 * height), (0, 0, 0), 2 * height, 170 * height ** 2, (1, 0.96, 0.9))
    studio.light((4 * height, -4 * height, 3 * height), (0, 0, 0), 3 * height, 120 * height ** 2, (0.85, 0.93, 1))


def main():
    out, samples = studio.arguments(__doc__)
    studio.scene((1240, 380), samples, 0.35).cycles.volume_bounces = 0
    V, F = innermap.read_mesh(HORSES / "reference.obj")
    height, long = np.ptp(V, axis=0)[1], np.ptp(V, axis=0).max()
    grids, made = smoke(V, F), materials(height)
    with tempfile.TemporaryDirectory() as folder:
        for i, pose in enumerate([V] + [innermap.read_mesh(HORSES / f"frame.{k:04d}.obj").vertices for k in FRAMES]):
            stand(pose, F, posed(V, F, pose, grids), str(Path(folder) / f"{i}.vdb"), made,
                  ((i - 1.5) * 1.24 * long, 0, -pose[:, 1].min()))
        surroundings(height, 5.15 * long)
        studio.render(out, 0.06)


if __name__ == "__main__":
    main()
