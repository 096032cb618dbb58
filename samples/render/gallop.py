"""Smoke in a galloping horse, one round of its gallop as an animated WebP. Needs the test models beside the project,
and Debian's python3-pil.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \
        --python samples/render/gallop.py -- OUT.webp [SAMPLES]
"""
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

sys.path.append(str(Path(__file__).parent))
import innermap  # noqa: E402
import smoke  # noqa: E402
import studio  # noqa: E402

FRAMES = range(1, 25)  # after which the gallop begins anew
PIXELS = (480, 340)
MILLISECONDS = 1000 // 24  # of a frame


def main():
    out, samples = studio.arguments(__doc__)
    cycles = studio.scene(PIXELS, samples, 0.35).cycles
    cycles.volume_bounces, cycles.volume_step_rate = 0, 2
    V, F = innermap.read_mesh(smoke.HORSES / "reference.obj")
    height, long = np.ptp(V, axis=0)[1], np.ptp(V, axis=0).max()
    poses = [innermap.read_mesh(smoke.HORSES / f"frame.{k:04d}.obj").vertices for k in FRAMES]
    ground = min(pose[:, 1].min() for pose in poses)
    grids, made = smoke.smoke(V, F), smoke.materials(height)
    smoke.surroundings(height, 1.5 * long)
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        for k, pose in zip(FRAMES, poses):
            objects = smoke.stand(pose, F, smoke.posed(V, F, pose, grids), str(Path(folder) / f"{k}.vdb"), made,
                                  (0, 0, -ground))
            pixels = studio.drawn(0.08)[1]
            pictures.append(Image.fromarray((255 * np.clip(pixels[::-1], 0, 1) + 0.5).astype(np.uint8)))
            print(f"frame {k} of {len(poses)}", flush=True)
            for ob in objects:
                bpy.data.objects.remove(ob)
    pictures[0].save(out, save_all=True, append_images=pictures[1:], duration=MILLISECONDS, loop=0, quality=80, method=6)


if __name__ == "__main__":
    main()
