"""Runs inside Blender: bakes a cylinder that bends, and compares with innermap.deform.

    blender -b --factory-startup --python-exit-code 1 --python scene.py -- FUNCTION
"""

import os
import sys
import threading
import time

import bpy
import numpy as np

import innermap

sys.path.insert(0, os.path.join(os.environ["INNERMAP_ROOT"], "tools/blender"))
import innermap_blender  # noqa: E402
from innermap_blender import stale  # noqa: E402
from innermap_blender.job import Job  # noqa: E402

FIRST, LAST, CHARGES = 5, 14, 500
FRAMES = list(range(FIRST, LAST + 1))


def linked(name, data):
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def cylinder(rings=24, around=24):
    """A closed cylinder about the x axis, from -2 to 2, that bends from frame FIRST to LAST."""
    angles = np.linspace(0, 2 * np.pi, around, endpoint=False)
    places = [(x, 0.5 * np.cos(a), 0.5 * np.sin(a)) for x in np.linspace(-2, 2, rings)
              for a in angles] + [(-2, 0, 0), (2, 0, 0)]
    faces = []
    for i in range(rings - 1):
        for k in range(around):
            a, b = i * around + k, i * around + (k + 1) % around
            faces.append((a, b, b + around, a + around))
    for k in range(around):
        faces.append((rings * around, (k + 1) % around, k))
        last = (rings - 1) * around
        faces.append((rings * around + 1, last + k, last + (k + 1) % around))
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(places, [], faces)
    body = linked("body", mesh)
    bend = body.modifiers.new("bend", 'SIMPLE_DEFORM')
    bend.deform_method, bend.deform_axis = 'BEND', 'Z'
    for frame, angle in ((FIRST, 0), (LAST, 1.2)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    return body


def things():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.3, location=(1, 0.1, 0))
    ball = bpy.context.object
    ball.name, ball.scale = "ball", (1.5, 1, 1)
    curve = bpy.data.curves.new("line", 'CURVE')
    curve.dimensions = '3D'
    line = curve.splines.new('POLY')
    line.points.add(7)
    for i, p in enumerate(line.points):
        p.co = (-1.7 + 0.45 * i, 0.2 * np.sin(i), 0.1, 1)
    bezier = curve.splines.new('BEZIER')
    bezier.bezier_points.add(1)
    for i, p in enumerate(bezier.bezier_points):
        p.co, p.handle_left, p.handle_right = ((i - 0.5 + s, 0, -0.2) for s in (0, -0.1, 0.1))
    wire = linked("wire", curve)
    wire.location = (0, 0, 0.05)
    bpy.ops.object.curves_random_add()
    hair = bpy.context.object
    hair.name = "hair"
    n = len(hair.data.points)
    t = np.linspace(0, 30, n)
    strands = np.stack([1.6 * np.sin(0.11 * t), 0.2 * np.cos(3 * t), 0.2 * np.sin(3 * t)], axis=1)
    hair.data.points.foreach_set("position", strands.astype(np.float32).ravel())
    hair.data.update_tag()
    return ball, wire, hair


def fog():
    n, voxel = 24, 0.05
    matrix = np.diag([voxel, voxel, voxel, 1])
    matrix[:3, 3] = (-1.2, -0.5 * (n - 1) * voxel / 2, -0.28)
    at = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1)
    away = np.linalg.norm(at - [12, 8, 6], axis=-1)
    density = np.clip(6 - away, 0, 1).astype(np.float32)
    innermap.grids({"density": density}, matrix).write_vdb("fog.vdb")
    volume = bpy.data.volumes.new("fog")
    volume.filepath = os.path.abspath("fog.vdb")
    smoke = linked("fog", volume)
    smoke.location, smoke.scale = (0.1, 0.02, 0), (1.1, 1.1, 1.1)
    return smoke


def world(m, points):
    m = np.array(m)
    return points @ m[:3, :3].T + m[:3, 3]


def vertices(ob):
    ev = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = ev.to_mesh()
    co = np.array([v.co[:] for v in mesh.vertices])
    out = world(ev.matrix_world, co)
    ev.to_mesh_clear()
    return out


def strands(ob):
    ev = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return world(ev.matrix_world, np.array([p.position[:] for p in ev.data.points]))


def poses(body):
    out = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        out.append(vertices(body))
    return out


def triangles(body):
    body.data.calc_loop_triangles()
    return np.array([t.vertices[:] for t in body.data.loop_triangles])


def start(store='CACHE'):
    bpy.ops.object.select_all(action='SELECT')
    bpy.ops.object.delete()
    innermap_blender.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.frame_current = FIRST, LAST, 7
    s = scene.innermap
    s.body, s.rest_frame, s.quality, s.folder, s.store = cylinder(), FIRST, 'DRAFT', "baked", store
    s.folder = os.path.abspath("baked")
    s.targets = bpy.data.collections.new("inside")
    return s


def put_inside(s, *objects):
    for ob in objects:
        s.targets.objects.link(ob)
    bpy.context.view_layer.update()


def expected(s, points, outside=0.02):
    """Where points of the rest frame are in all frames, by innermap.deform."""
    pose = poses(s.body)
    places, found = innermap.deform((pose[0], triangles(s.body)), points, pose, charges=CHARGES,
                                    outside=outside)
    assert found.all()
    return places


def compare(s, ob, read, within):
    bpy.context.scene.frame_set(FIRST)
    want = expected(s, read(ob))
    far = 0
    for frame, places in zip(FRAMES, want):
        bpy.context.scene.frame_set(frame)
        got = read(ob)
        off = np.abs(got - places).max()
        assert off < within, (ob.name, frame, off)
        far = max(far, np.abs(got - want[0]).max())
    assert far > 0.1, (ob.name, far)
    print(f"{ob.name}: moved by {far:.3f}, off by at most {within}")


def points_are_baked(store):
    s = start(store)
    ball, wire, hair = things()
    put_inside(s, ball, wire, hair)
    rest = {ob: read(ob) for ob, read in ((ball, vertices), (wire, vertices), (hair, strands))}
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    assert bpy.context.scene.frame_current == 7
    compare(s, ball, vertices, 2e-6)
    compare(s, hair, strands, 2e-6)
    points = 8  # of the poly spline: the other's are between its keys
    compare(s, wire, lambda ob: vertices(ob)[:points], 2e-6)
    assert bpy.ops.innermap.bake() == {'FINISHED'}  # again, from the same rest
    compare(s, ball, vertices, 2e-6)
    assert bpy.ops.innermap.clear() == {'FINISHED'}
    bpy.context.scene.frame_set(LAST)
    for ob, read in ((ball, vertices), (wire, vertices), (hair, strands)):
        off = np.abs(read(ob) - rest[ob]).max()
        assert off < 1e-6 and not len(ob.modifiers), (ob.name, off, ob.modifiers[:])
    assert not [m for m in bpy.data.meshes if m.name.startswith("Inner map")]


def caches():
    points_are_baked('CACHE')


def keys():
    points_are_baked('KEYS')


def volumes():
    s = start()
    smoke = fog()
    put_inside(s, smoke)
    place = np.array(smoke.matrix_world)
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    back = np.linalg.inv(place)
    pose = [world(back, p) for p in poses(s.body)]
    innermap.deform((pose[0], triangles(s.body)), "fog.vdb", pose, "want.####.vdb", numbers=FRAMES,
                    charges=CHARGES, outside=0.02, velocity=True, densities=["density"])
    mesh = linked("drawn", bpy.data.meshes.new("drawn"))
    drawn = mesh.modifiers.new("drawn", 'VOLUME_TO_MESH')
    drawn.object, drawn.grid_name, drawn.threshold = smoke, "density", 0.5
    for frame in FRAMES:
        got = innermap.read_vdb(f"baked/fog.{frame:04d}.vdb")
        want = innermap.read_vdb(f"want.{frame:04d}.vdb")
        assert np.allclose(got.matrix, want.matrix) and list(got) == ["density", "velocity"]
        for name in got:
            assert np.allclose(got[name], want[name], atol=1e-6), (name, frame)
        bpy.context.scene.frame_set(frame)
        density = got["density"]
        at = np.argwhere(density > 0.5)
        middle = world(place, world(got.matrix, at)).mean(axis=0)
        off = np.abs(vertices(mesh).mean(axis=0) - middle).max()
        assert off < 0.3 * got.voxel_size, (frame, off)
    data = smoke.data
    assert data.velocity_unit == 'SECOND' and data.frame_start == FIRST
    assert bpy.ops.innermap.clear() == {'FINISHED'}
    assert data.filepath.endswith("fog.vdb") and not data.is_sequence
    assert np.allclose(np.array(smoke.matrix_world), place)
    assert not [f for f in os.listdir("baked") if f.startswith(".")]


def live():
    s = start()
    ball, wire, _ = things()
    put_inside(s, ball, wire)
    assert bpy.ops.innermap.live() == {'FINISHED'}
    compare(s, ball, vertices, 1e-3)
    later = linked("later", ball.data.copy())  # what is added later follows, too
    later.location = (-1, 0, 0.1)
    later.modifiers.new("Lattice", 'LATTICE').object = ball.modifiers["Inner map"].object
    compare(s, later, vertices, 1e-3)
    # Again: the same lattice object, so that what was added still follows.
    lattice = later.modifiers["Lattice"].object
    assert bpy.ops.innermap.live() == {'FINISHED'}
    assert later.modifiers["Lattice"].object == lattice == ball.modifiers["Inner map"].object
    assert len([ob for ob in bpy.data.objects if ob.type == 'LATTICE']) == 1
    compare(s, later, vertices, 1e-3)
    later.modifiers.clear()
    assert bpy.ops.innermap.clear() == {'FINISHED'}
    assert not len(ball.modifiers) and not [ob for ob in bpy.data.objects if ob.type == 'LATTICE']


def refuses(operator, *words):
    try:
        operator()
    except RuntimeError as error:
        for word in words:
            assert word in str(error), (word, error)
    else:
        raise AssertionError(words)


def errors():
    s = start()
    refuses(bpy.ops.innermap.bake, "Inside")
    ball, wire, _ = things()
    put_inside(s, ball, wire)
    body = s.body
    decimate = body.modifiers.new("fewer", 'DECIMATE')
    for frame, ratio in ((9, 1.0), (10, 0.5)):
        decimate.ratio = ratio
        decimate.keyframe_insert("ratio", frame=frame)
    refuses(bpy.ops.innermap.bake, "body", "vertices in frame")
    assert not ball.get("innermap_baked") and bpy.context.scene.frame_current == 7
    body.modifiers.remove(decimate)
    wire.shape_key_add(name="own")
    refuses(bpy.ops.innermap.bake, "wire", "shape keys")
    wire.shape_key_clear()
    twin = linked("twin", wire.data)
    refuses(bpy.ops.innermap.bake, "wire", "single user")
    bpy.data.objects.remove(twin)
    s.targets.objects.unlink(wire)
    body.scale = (1, 1, 1)
    body.keyframe_insert("scale", frame=FIRST)
    body.scale = (1, 1, 0)
    body.keyframe_insert("scale", frame=LAST)
    refuses(bpy.ops.innermap.bake, "body", f"frame {LAST}")
    s.folder = "//somewhere"
    refuses(bpy.ops.innermap.bake, "Folder", "saved")


def stale_mark():
    s = start()
    ball, _, _ = things()
    put_inside(s, ball)
    bpy.ops.innermap.bake()
    scene = bpy.context.scene
    for frame in FRAMES:
        scene.frame_set(frame)
    assert not stale.stale_frames(scene)
    s.body.data.vertices[0].co.x += 0.1
    s.body.data.update()
    bpy.context.view_layer.update()
    scene.frame_set(FIRST + 2)
    assert FIRST + 2 in stale.stale_frames(scene)
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    scene.frame_set(FIRST + 2)
    assert not stale.stale_frames(scene)


def cancelled():
    """As Esc does in a window."""
    s = start()
    ball, _, _ = things()
    put_inside(s, ball, fog())
    job = Job(bpy.context)
    for _ in job.collect():
        pass
    thread = threading.Thread(target=job.compute)
    thread.start()
    while not job.stage:
        time.sleep(0.01)
    job.cancelled, began = True, time.monotonic()
    thread.join()
    print(f"cancelled in {time.monotonic() - began:.2f} s")
    job.close()
    assert job.done and not job.error and not job.places
    assert os.listdir("baked") == [] and not ball.get("innermap_baked")


def names():
    """Names that make the same file's name keep files of their own; points outside stay as at rest."""
    s = start()
    ball, _, _ = things()
    ball.name = "a b"
    other = linked("a/b", ball.data.copy())
    other.location = (-1, 0, 0.1)
    far = linked("far", ball.data.copy())
    far.location = (0, 0, 5)
    put_inside(s, ball, other, far)
    bpy.context.scene.frame_set(FIRST)
    rest = vertices(far)
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    assert len({ob.modifiers[0].filepath for ob in (ball, other, far)}) == 3
    compare(s, ball, vertices, 2e-6)
    bpy.context.scene.frame_set(LAST)
    assert np.abs(vertices(far) - rest).max() < 1e-6


def presets():
    s = start()
    s.quality, s.charges, s.store, s.outside = 'CUSTOM', 777, 'KEYS', 0.25
    assert bpy.ops.innermap.preset_add(name="mine") == {'FINISHED'}
    path = bpy.utils.preset_paths("innermap")[-1]
    assert os.listdir(path) == ["mine.py"], os.listdir(path)
    s.quality, s.charges, s.store, s.outside = 'DRAFT', 100, 'CACHE', 0
    body = s.body
    assert bpy.ops.script.execute_preset(filepath=os.path.join(path, "mine.py"),
                                         menu_idname="INNERMAP_MT_presets") == {'FINISHED'}
    assert (s.quality, s.charges, s.store, round(s.outside, 6)) == ('CUSTOM', 777, 'KEYS', 0.25)
    assert s.body == body
    assert bpy.ops.innermap.preset_add(name="mine", remove_name=True) == {'FINISHED'}
    assert os.listdir(path) == []


def relative_paths():
    s = start()
    ball, _, _ = things()
    smoke = fog()
    put_inside(s, ball, smoke)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("a.blend"))
    s.folder = "//baked"
    assert bpy.ops.innermap.bake() == {'FINISHED'}
    assert ball.modifiers[0].filepath == "//baked/ball.pc2"
    assert smoke.data.filepath == f"//baked/fog.{FIRST:04d}.vdb"
    os.makedirs("moved")
    bpy.ops.wm.save_mainfile()
    os.rename("a.blend", "moved/a.blend")
    os.rename("baked", "moved/baked")
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath("moved/a.blend"))
    ball, scene = bpy.data.objects["ball"], bpy.context.scene
    scene.frame_set(FIRST)
    first = vertices(ball)
    scene.frame_set(LAST)
    assert np.abs(vertices(ball) - first).max() > 0.1
    scene.frame_set(FIRST + 1)
    assert not stale.stale_frames(scene)


globals()[sys.argv[sys.argv.index("--") + 1]]()
