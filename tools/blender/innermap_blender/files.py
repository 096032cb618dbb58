"""Files that Blender plays: point caches, and paths relative to the .blend file."""

import os
import struct
import zlib

import bpy
import numpy as np


def write_pc2(path, frames, first):
    """A point cache, (frames, points, 3) in the object's space; appears whole or not at all."""
    frames = np.asarray(frames)
    temporary = f"{path}.{os.getpid()}.part"
    try:
        with open(temporary, "wb") as file:
            file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, frames.shape[1], float(first),
                                   1.0, len(frames)))
            file.write(frames.astype("<f4").tobytes())
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def folder_of(settings):
    """The folder of what is baked, absolute; made if missing."""
    if settings.folder.startswith("//") and not bpy.data.filepath:
        raise ValueError("Folder: is relative to the .blend file, which is not saved yet; save it "
                         "or choose another folder")
    folder = bpy.path.abspath(settings.folder)
    os.makedirs(folder, exist_ok=True)
    return folder


def stored(path, settings):
    """How a path stands in the .blend file: relative where the folder is."""
    return bpy.path.relpath(path) if settings.folder.startswith("//") else path


def file_name(ob):
    """Of its own for each object: "a b" and "a/b" would both be "a_b"."""
    clean = bpy.path.clean_name(ob.name)
    return clean if clean == ob.name else f"{clean}-{zlib.crc32(ob.name.encode()):08x}"
