"""The add-on for Blender, inside a Blender without a window; skipped where none is installed."""

import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import cli

SCENE = Path(__file__).with_name("scene.py")


def blender(*arguments):
    program = shutil.which("blender")
    if not program:
        raise cli.Skip("blender is not installed (apt-get install --no-install-recommends blender)")
    done = subprocess.run([program, "-b", "--factory-startup", "--python-exit-code", "1", *arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0, done.stdout
    return done.stdout


def scene(function):
    blender("--python", SCENE, "--", function)


def test_caches_follow_the_body():
    scene("caches")


def test_shape_keys_follow_the_body():
    scene("keys")


def test_volumes_follow_the_body_and_are_drawn_in_place():
    scene("volumes")


def test_a_lattice_carries_what_is_added_later():
    scene("live")


def test_errors_name_object_and_frame():
    scene("errors")


def test_a_changed_body_is_marked():
    scene("stale_mark")


def test_cancelling_changes_nothing():
    scene("cancelled")


def test_objects_have_files_of_their_own():
    scene("names")


def test_presets_are_kept():
    os.environ["BLENDER_USER_SCRIPTS"] = os.path.abspath("scripts")
    os.makedirs("scripts")
    scene("presets")


@cli.nightly
def test_blur_of_fog_is_as_long_as_the_bodys():
    blender("--python", cli.ROOT / "samples/render/motion_blur.py", "--", os.path.abspath("blur.png"), "16")
    assert os.path.getsize("blur.png") > 1000


def test_files_move_with_the_scene():
    scene("relative_paths")


def test_zip_installs():
    root = Path(os.environ["INNERMAP_ROOT"]) / "tools/blender"
    with zipfile.ZipFile("innermap_blender.zip", "w") as file:
        for path in sorted((root / "innermap_blender").glob("*.py")):
            file.write(path, path.relative_to(root))
    Path("install.py").write_text(
        "import bpy, os\n"
        "bpy.ops.preferences.addon_install(filepath=os.path.abspath('innermap_blender.zip'))\n"
        "bpy.ops.preferences.addon_enable(module='innermap_blender')\n"
        "assert bpy.ops.innermap.bake.poll() is False\n"
        "import innermap_blender.library as library\n"
        "assert library.preferences() and library.module().__version__\n"
        "library.NEEDED = (99, 0, 0)\n"
        "try: library.module()\n"
        "except library.Missing as e: assert '99.0.0' in str(e)\n"
        "else: raise AssertionError\n"
        "bpy.ops.preferences.addon_disable(module='innermap_blender')\n", encoding="utf-8")
    os.environ["BLENDER_USER_SCRIPTS"] = os.path.abspath("scripts")
    os.makedirs("scripts/addons")
    blender("--python", os.path.abspath("install.py"))
    assert Path("scripts/addons/innermap_blender/__init__.py").is_file()


if __name__ == "__main__":
    cli.run(globals())
