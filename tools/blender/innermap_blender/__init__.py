"""Inner map: meshes, curves, hair and volumes that follow the inside of a body that moves.

Licensed under the Apache License 2.0, as innermap is.
"""

bl_info = {
    "name": "Inner map",
    "author": "innermap",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "category": "Animation",
    "location": "3D View > Sidebar > Inner map",
    "description": "Carries meshes, curves, hair and volumes inside a body through its animation",
}

import bpy  # noqa: E402  Blender reads bl_info before it imports anything

from . import operators, panel, preferences, stale  # noqa: E402

CLASSES = panel.CLASSES + preferences.CLASSES + operators.CLASSES


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    panel.register()
    stale.register()


def unregister():
    stale.unregister()
    panel.unregister()
    for cls in CLASSES[::-1]:
        bpy.utils.unregister_class(cls)
