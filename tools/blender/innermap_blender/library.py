"""The Python module innermap, which does the work: where it is, and whether it is new enough."""

import importlib
import os
import sys

import bpy

NEEDED = (0, 1, 0)
NEEDED_NAMES = ("Deformer", "lattice")


class Missing(Exception):
    """No module that fits; the text says what to do."""


def preferences():
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences if addon else None


def module():
    """innermap, from where Python finds it, or from the folder that the preferences name."""
    settings = preferences()
    folder = bpy.path.abspath(settings.folder) if settings and settings.folder else ""
    if folder and os.path.isdir(folder) and folder not in sys.path:
        sys.path.append(folder)
    try:
        found = importlib.import_module("innermap")
    except ImportError as error:
        raise Missing(f"the Python module innermap is not found ({error}); build it for Python "
                      f"{sys.version_info.major}.{sys.version_info.minor} and name its folder in "
                      "the preferences of the add-on") from error
    lacking = [name for name in NEEDED_NAMES if not hasattr(found, name)]
    version = getattr(found, "__version__", "0")
    if lacking or numbers(version) < NEEDED:
        raise Missing(f"innermap {version} is too old for this add-on, which needs "
                      f"{'.'.join(map(str, NEEDED))} with {', '.join(NEEDED_NAMES)}; update it")
    return found


def numbers(version):
    """(0, 1, 0) of "0.1.0" or "0.1.0+3"."""
    out = []
    for part in version.split(".")[:3]:
        digits = "".join(c for c in part if c.isdigit() or c == " ").split()
        out.append(int(digits[0]) if digits else 0)
    return tuple(out + [0] * (3 - len(out)))
