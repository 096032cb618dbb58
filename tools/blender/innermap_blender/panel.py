"""The settings of a scene, and the panel that shows them."""

import bpy
from bl_operators.presets import AddPresetBase
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, \
    StringProperty

from . import stale
from .operators import VERDICT


# What a preset keeps: how things are carried and stored, not which.
PRESET = ("store", "quality", "charges", "outside", "density", "velocity", "lattice", "folder")


class InnermapSettings(bpy.types.PropertyGroup):
    body: PointerProperty(
        type=bpy.types.Object, name="Body", poll=lambda self, ob: ob.type == 'MESH',
        description="The closed mesh that moves")
    targets: PointerProperty(
        type=bpy.types.Collection, name="Inside",
        description="Meshes, curves, hair and volumes that are carried; the selected ones if empty")
    rest_frame: IntProperty(
        name="Rest frame", default=1, description="Frame in which the body and the objects inside fit together")
    scene_range: BoolProperty(
        name="Scene range", default=True, description="Bake the frames of the scene")
    frame_start: IntProperty(name="First", default=1, min=0)
    frame_end: IntProperty(name="Last", default=10, min=0)
    store: EnumProperty(
        name="Meshes as", default='CACHE',
        items=(('CACHE', "Mesh cache", "A .pc2 file and a Mesh Cache modifier"),
               ('KEYS', "Shape keys", "In the .blend file: for small meshes and few frames")))
    quality: EnumProperty(
        name="Quality", default='USUAL',
        items=(('DRAFT', "Draft", "500 charges, at once"), ('USUAL', "Usual", "2000 charges"),
               ('FINE', "Fine", "8000 charges: follows small detail of the body, takes longer"),
               ('CUSTOM', "Custom", "A number of charges")))
    charges: IntProperty(name="Charges", default=4000, min=50, max=100000)
    outside: FloatProperty(
        name="Outside", default=0.02, min=0, max=1,
        description="Also carry things up to this far outside, as a fraction of the body's diagonal")
    density: BoolProperty(
        name="Keep mass", default=True,
        description="A grid named density gets thinner where the body swells and denser where it "
                    "is squeezed")
    velocity: BoolProperty(
        name="Velocity", default=True, description="Volumes get a grid for motion blur")
    lattice: IntProperty(
        name="Lattice points", default=32, min=4, max=64, description="Along the longest side")
    folder: StringProperty(name="Folder", subtype='DIR_PATH', default="//innermap")


class Panel:
    bl_space_type, bl_region_type, bl_category = 'VIEW_3D', 'UI', "Inner map"

    @staticmethod
    def column(layout):
        col = layout.column()
        col.use_property_split, col.use_property_decorate = True, False
        return col


class INNERMAP_MT_presets(bpy.types.Menu):
    bl_label = "Presets"
    preset_subdir = "innermap"
    preset_operator = "script.execute_preset"
    draw = bpy.types.Menu.draw_preset


class INNERMAP_OT_preset_add(AddPresetBase, bpy.types.Operator):
    bl_idname = "innermap.preset_add"
    bl_label = "Add a preset"
    bl_description = "Keeps these settings under a name, for any scene"
    preset_menu = "INNERMAP_MT_presets"
    preset_subdir = "innermap"
    preset_defines = ["settings = bpy.context.scene.innermap"]
    preset_values = [f"settings.{name}" for name in PRESET]


class INNERMAP_PT_main(Panel, bpy.types.Panel):
    bl_label = "Inner map"

    def draw(self, context):
        s = context.scene.innermap
        row = self.layout.row(align=True)
        row.menu("INNERMAP_MT_presets", text=bpy.types.INNERMAP_MT_presets.bl_label)
        row.operator("innermap.preset_add", text="", icon='ADD')
        row.operator("innermap.preset_add", text="", icon='REMOVE').remove_active = True
        col = self.column(self.layout)
        for name in ("body", "targets", "rest_frame", "scene_range"):
            col.prop(s, name)
        if not s.scene_range:
            row = col.column(align=True)
            row.prop(s, "frame_start")
            row.prop(s, "frame_end")
        col.prop(s, "quality")
        if s.quality == 'CUSTOM':
            col.prop(s, "charges")
        col.operator("innermap.check", icon='CHECKMARK')
        for line in VERDICT.get(s.body.name, ()) if s.body else ():
            col.label(text=line, icon='INFO')
        differs = stale.stale_frames(context.scene)
        if differs:
            col.label(text=f"Changed (frame {differs[0]})", icon='ERROR')
        row = self.layout.row(align=True)
        row.operator("innermap.bake", icon='REC')
        row.operator("innermap.live", icon='LATTICE_DATA')
        self.layout.operator("innermap.clear", icon='TRASH')


class INNERMAP_PT_options(Panel, bpy.types.Panel):
    bl_label = "How it is stored"
    bl_parent_id = "INNERMAP_PT_main"
    bl_options = {'DEFAULT_CLOSED'}

    def draw(self, context):
        col = self.column(self.layout)
        for name in ("folder", "store", "outside", "density", "velocity", "lattice"):
            col.prop(context.scene.innermap, name)


CLASSES = (InnermapSettings, INNERMAP_MT_presets, INNERMAP_OT_preset_add, INNERMAP_PT_main, INNERMAP_PT_options)


def register():
    bpy.types.Scene.innermap = PointerProperty(type=InnermapSettings)


def unregister():
    del bpy.types.Scene.innermap
