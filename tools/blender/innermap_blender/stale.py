"""Whether the body still moves as it did when things were baked.

A number for each frame's places stands in the scene; whenever the body is evaluated anew, that of
the frame is compared. What was found is kept for the session: nothing is written while one edits.
"""

import zlib

import bpy
import numpy as np

from .geometry import body_places

FOUND = {}  # of scenes: frames at which the body differs


def number(places):
    return zlib.crc32(np.ascontiguousarray(places, np.float32).tobytes())


def remember(scene, frames, poses):
    scene["innermap_poses"] = {str(f): f"{number(p):08x}" for f, p in zip(frames, poses)}
    FOUND.pop(scene.name, None)


def forget(scene):
    scene.pop("innermap_poses", None)
    FOUND.pop(scene.name, None)


def look(scene):
    """Compares the frame that is shown."""
    body = scene.innermap.body
    baked = scene.get("innermap_poses")
    if baked is None:
        FOUND.pop(scene.name, None)  # undone
        return
    if body is None or body.mode != 'OBJECT':
        return
    known = baked.get(str(scene.frame_current))
    if known is None:
        return
    differs = FOUND.setdefault(scene.name, set())
    if f"{number(body_places(body)):08x}" != known:
        differs.add(scene.frame_current)
    else:
        differs.discard(scene.frame_current)


def stale_frames(scene):
    return sorted(FOUND.get(scene.name, ()))


def busy():
    """While a scene is rendered its own thread changes frames: nothing else may evaluate then."""
    screen = bpy.context.screen
    return bpy.app.is_job_running('RENDER') or screen and screen.is_animation_playing


@bpy.app.handlers.persistent
def after_update(scene, depsgraph=None):
    body = scene.innermap.body
    if body is None or busy():
        return
    if depsgraph is None or any(u.id.original == body for u in depsgraph.updates):
        look(scene)


@bpy.app.handlers.persistent
def after_frame(scene, _depsgraph=None):
    after_update(scene)


HANDLERS = ((bpy.app.handlers.depsgraph_update_post, after_update),
            (bpy.app.handlers.frame_change_post, after_frame))


def register():
    for handlers, function in HANDLERS:
        handlers.append(function)


def unregister():
    for handlers, function in HANDLERS:
        if function in handlers:
            handlers.remove(function)
