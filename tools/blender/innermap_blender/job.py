"""One baking: reads Blender's data, computes without it, writes what came of it.

collect() and write() run in Blender's own thread, compute() in any. Until write() nothing of the
scene has changed, and files are made beside those that are there.
"""

import os
import shutil
import tempfile

import bpy
import numpy as np
from mathutils import Vector

from . import files, library, stale, targets
from .geometry import Refused, apply, body_mesh, body_places, evaluated, matrix, rest_points

CHARGES = {'DRAFT': 500, 'USUAL': 2000, 'FINE': 8000}


class Stopped(Exception):
    """The user cancelled."""


def frame_range(scene, settings):
    if settings.scene_range:
        return scene.frame_start, scene.frame_end
    return settings.frame_start, settings.frame_end


class Job:
    """Cancelled by `cancelled`; `stage` and `share` say how far it is."""

    def __init__(self, context, live=False):
        self.settings = settings = context.scene.innermap
        self.scene, self.body, self.live = context.scene, settings.body, live
        self.library = library.module()
        self.stage, self.share, self.cancelled, self.error, self.done = "", 0.0, False, None, False
        if self.body is None or self.body.type != 'MESH':
            raise Refused("Body: choose a mesh")
        first, last = frame_range(self.scene, settings)
        if last < first:
            raise Refused("Frames: the last is before the first")
        if first < 0:
            raise Refused("Frames: must not be negative")
        self.frames = list(range(first, last + 1))
        self.carried = []  # of each volume, for the thread: name, file, place, name of what is made
        self.values = {
            "charges": settings.charges if settings.quality == 'CUSTOM' else CHARGES[settings.quality]}
        self.outside = 1.0 if live else settings.outside
        self.objects = targets.chosen(context, settings, self.body)
        if live:
            self.objects = [ob for ob in self.objects if ob.type in {'MESH', 'CURVE'}]
        elif not self.objects:
            raise Refused("Inside: put meshes, curves, hair or volumes into the collection, or "
                          "select them")
        for ob in self.objects:
            self.require_own_data(ob)
            if targets.own_shape_keys(ob) and not live and \
                    (ob.type == 'CURVE' or settings.store == 'KEYS'):
                raise Refused(f"{ob.name}: has shape keys of its own; apply them" +
                              (" or store meshes as caches" if ob.type == 'MESH' else ""))
        self.folder = "" if live else files.folder_of(settings)
        self.made = None

    def require_own_data(self, ob):
        """Keys and the file of a volume stand in the data, which other objects may have too."""
        in_data = ob.type in {'CURVE', 'VOLUME'} or ob.type == 'MESH' and self.settings.store == 'KEYS'
        if in_data and not self.live and ob.data.users > 1:
            raise Refused(f"{ob.name}: shares its data with other objects; make it a single user "
                          "(Object > Relations)")

    # In Blender's thread.

    def collect(self):
        """A generator, a frame a step, of the share done. Sees to it that the frame is as before."""
        now = self.scene.frame_current
        try:
            self.scene.frame_set(self.settings.rest_frame)
            self.rest, self.triangles = body_mesh(self.body)
            self.check()
            self.take_points()
            self.poses, self.inverse = [], []
            for i, frame in enumerate(self.frames):
                self.scene.frame_set(frame)
                self.take_pose(frame)
                yield (i + 1) / len(self.frames)
        finally:
            self.scene.frame_set(now)
        if self.volumes:
            self.made = tempfile.mkdtemp(prefix=".baking-", dir=self.folder)
            render = self.scene.render
            self.with_velocity = self.settings.velocity and len(self.frames) > 1
            self.keep_mass = self.settings.density
            self.fps = render.fps / render.fps_base
            self.shutter = render.motion_blur_shutter

    def check(self):
        self.report = self.library.check(self.rest, self.triangles)
        if not self.report.closed and self.report.volume == 0:
            raise Refused(f"{self.body.name}: bounds nothing; close its "
                          f"{self.report.open_loops} holes")

    def take_points(self):
        self.spans, points, self.volumes, count = [], [], [], 0
        self.at_rest = []  # of each span, in the object's space
        self.body_name = self.body.name
        if self.live:
            self.lattice = self.library.lattice((self.rest.min(axis=0), self.rest.max(axis=0)),
                                                resolution=self.settings.lattice)
            points = [self.lattice[0]]
        for ob in self.objects if not self.live else ():
            if ob.type == 'VOLUME':
                self.take_volume(ob)
                continue
            self.at_rest.append(rest_points(ob))
            found = apply(matrix(evaluated(ob).matrix_world), self.at_rest[-1])
            self.spans.append((ob, count, count + len(found)))
            points.append(found)
            count += len(found)
        self.points = np.concatenate(points) if points else np.empty((0, 3))

    def take_volume(self, ob):
        rest = targets.rest_volume(ob)
        place = evaluated(ob).matrix_world.copy()
        moved = ob.delta_location - Vector(rest["delta"])
        if ob.parent:
            moved = (ob.parent.matrix_world @ ob.matrix_parent_inverse).to_3x3() @ moved
        place.translation -= moved
        self.volumes.append((ob, rest))
        self.carried.append((ob.name, bpy.path.abspath(rest["frame_path"]), matrix(place),
                             files.file_name(ob) + ".####.vdb"))

    def take_pose(self, frame):
        places = body_places(self.body)
        if len(places) != len(self.rest):
            raise Refused(f"{self.body.name}: has {len(places)} vertices in frame {frame}, "
                          f"{len(self.rest)} in the rest frame; no modifier may change its faces")
        self.poses.append(places)
        self.inverse.append([matrix(evaluated(ob).matrix_world.inverted()) for ob, _, _ in self.spans])

    # In any thread: no bpy.

    def tick(self, stage, share):
        self.stage, self.share = stage, share
        if self.cancelled:
            raise Stopped()

    def compute(self):
        try:
            self.carry_points()
            for volume in self.carried:
                self.carry_volume(*volume)
        except Stopped:
            self.cancelled = True
        except Exception as error:  # whatever it is, the operator shows it
            self.error = str(error) or type(error).__name__
        finally:
            self.done = True

    def carry_points(self):
        self.found, self.places, self.figures = np.zeros(0, bool), [], {}
        if not len(self.points):
            return
        deformer = self.library.Deformer((self.rest, self.triangles), self.points,
                                         outside=self.outside, progress=self.tick, **self.values)
        self.found = deformer.found
        for i, (frame, pose) in enumerate(zip(self.frames, self.poses)):
            try:
                self.tick(f"frame {frame}", i / len(self.frames))
                self.places.append(deformer(pose))
            except self.library.Error as error:
                raise Refused(f"{self.body_name}, frame {frame}: {error}") from error
        # The error of the one that is farthest from the rest says enough.
        far = int(np.argmax([np.abs(pose - self.rest).max() for pose in self.poses]))
        self.figures = {"frame": self.frames[far], **deformer.measure(self.poses[far])}

    def carry_volume(self, name, path, place, pattern):
        back = np.linalg.inv(place)
        try:
            table = self.library.deform(
                (apply(back, self.rest), self.triangles), path,
                [apply(back, pose) for pose in self.poses], os.path.join(self.made, pattern),
                numbers=self.frames, velocity=self.with_velocity, fps=self.fps,
                shutter=self.shutter, outside=self.outside,
                densities=["density"] if self.keep_mass and self.has_density(path) else None,
                names="blender", progress=self.tick, **self.values)
        except self.library.Error as error:
            raise Refused(f"{name}: {error}") from error
        for frame, wrong in zip(table["frame"], table["error"]):
            if wrong:
                raise Refused(f"{name}, frame {frame}: {wrong}")

    def has_density(self, path):
        return "density" in self.library.read_vdb(path)

    # In Blender's thread again.

    def write(self):
        """Puts all in place; gives what to tell, as (kind, text)."""
        told, lost = [], []
        for (ob, begin, end), number in zip(self.spans, range(len(self.spans))):
            local = np.array([apply(inverse[number], places[begin:end])
                              for inverse, places in zip(self.inverse, self.places)])
            missing = ~self.found[begin:end]
            if missing.any():
                local[:, missing] = self.at_rest[number][missing]
                lost.append(f"{int(missing.sum())} of {ob.name}")
            self.play(ob, local)
        for (ob, rest), (_, _, _, name) in zip(self.volumes, self.carried):
            pattern, made = os.path.join(self.folder, name), os.path.join(self.made, name)
            targets.clear(ob)
            targets.move_frames(made, pattern, self.frames)
            first = self.library.read_vdb(pattern.replace("####", f"{self.frames[0]:04d}"))
            targets.play_volume(ob, pattern, rest, self.frames, self.settings, first.matrix)
            ob["innermap_baked"] = 'VOLUME'
        if self.live:
            self.write_lattice()
        stale.remember(self.scene, self.frames, self.poses)
        if lost:
            told.append(('WARNING', "points outside the body stay where they are (see Outside): "
                         + ", ".join(lost)))
        count = len(self.objects)
        text = f"{count} object{'s' if count != 1 else ''} through {len(self.frames)} frames"
        if self.figures:
            text += (f"; the map meets the body to {100 * self.figures['boundary_p99']:.2g}% of its "
                     f"size in frame {self.figures['frame']}")
            if self.figures["folded_fraction"] > 0:
                told.append(('WARNING', f"{self.body.name}, frame {self.figures['frame']}: the map "
                             f"folds on {100 * self.figures['folded_fraction']:.2g}% of the inside"))
        return [('INFO', text)] + told

    def play(self, ob, local):
        targets.clear(ob)
        path = os.path.join(self.folder, files.file_name(ob) + ".pc2")
        kind = {'CURVE': 'CURVE', 'CURVES': 'HAIR'}.get(ob.type, self.settings.store)
        if kind == 'CACHE':
            targets.play_cache(ob, path, local, self.frames, self.settings)
        elif kind == 'HAIR':
            targets.play_hair(ob, path, local, self.frames, self.settings)
        else:
            targets.play_keys(ob, local, self.frames)
        ob["innermap_baked"] = kind

    def write_lattice(self):
        points, counts, cell = self.lattice
        name = f"{targets.NAME} of {self.body.name}"
        # The object stays, for what else has a modifier with it.
        lattice = next((ob for ob in bpy.data.objects if ob.get("innermap_lattice")
                        and ob.get("innermap_body") == self.body), None)
        data = bpy.data.lattices.new(name)
        data.points_u, data.points_v, data.points_w = counts
        data.interpolation_type_u = data.interpolation_type_v = data.interpolation_type_w = \
            'KEY_CATMULL_ROM'
        if lattice:
            old, lattice.data = lattice.data, data
            bpy.data.lattices.remove(old)
        else:
            lattice = bpy.data.objects.new(name, data)
            self.scene.collection.objects.link(lattice)
            lattice["innermap_lattice"], lattice["innermap_body"] = True, self.body
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        lattice.location, lattice.scale = middle, (cell,) * 3  # its points are one unit apart
        targets.play_keys(lattice, (np.array(self.places) - middle) / cell, self.frames)
        for ob in self.objects:
            targets.clear(ob, keep=lattice)
            ob.modifiers.new(targets.NAME, 'LATTICE').object = lattice
            ob["innermap_baked"] = 'LIVE'

    def close(self):
        if self.made:
            shutil.rmtree(self.made, ignore_errors=True)
            self.made = None
