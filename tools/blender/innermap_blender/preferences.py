"""Where the Python module is."""

import bpy
from bpy.props import StringProperty

from . import library


class InnermapPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    folder: StringProperty(
        name="Folder of the Python module", subtype='DIR_PATH',
        description="The folder that holds innermap/, if Python does not find it by itself")

    def draw(self, _context):
        self.layout.prop(self, "folder")
        try:
            self.layout.label(text=f"innermap {library.module().__version__}", icon='CHECKMARK')
        except library.Missing as error:
            self.layout.label(text=str(error), icon='ERROR')


CLASSES = (InnermapPreferences,)
