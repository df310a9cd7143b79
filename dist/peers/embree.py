#!/usr/bin/env python3
"""Times the rays of one view over land, here and in Embree, on maps made for it.

    dist/peers/embree.py [--fumarole target/release/fumarole] [--samples 512,1024,2048] [--size 800x600] [--rounds 3]
                         [--variants gpu-compute,dda-compute,dda-fragment] [--lod exact]

Needs numpy and mitsuba (PyPI), which brings Embree. The two take turns on the same cores, and medians count. Of ours it is
the pass `depth`, and `start` where rays begin with their tile: they make their rays themselves and meet bilinear patches.
Of Embree it is the intersection of rays that are prepared outside of the time, with two triangles for each cell, in single
precision. What each builds before its first ray stands beside it: of Embree the tree, of ours the whole loading of the map with its levels. A hit of one alone and
the distance between hits of both tell that the same view is compared.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np

SPACING_M = 10.0
# The field of view of the program's cameras.
VERTICAL_FOV_RAD = np.pi / 4
# The surface of a hit in the last three bits of its code, beside sky, base and walls (`shaders/terrain/terrain.glsl`).
TERRAIN = 2


def ridged_land(samples):
    """Heights in metres of rough land, the same shape at every size: ridged noise of nine octaves."""
    generator = np.random.default_rng(1)
    heights = np.zeros((samples, samples))
    for octave in range(9):
        lattice = generator.uniform(-1, 1, (3 * 2**octave + 2,) * 2)
        at = np.linspace(0, 3 * 2**octave, samples)
        cell = np.minimum(at.astype(int), 3 * 2**octave - 1)
        part = at - cell
        part = part * part * (3 - 2 * part)
        rows = lattice[cell] * (1 - part[:, None]) + lattice[cell + 1] * part[:, None]
        noise = rows[:, cell] * (1 - part) + rows[:, cell + 1] * part
        heights += (1 - np.abs(noise)) * 0.5**octave
    return (heights * 0.05 * samples * SPACING_M).astype("<f4")


def write_bil(path, heights):
    rows, columns = heights.shape
    heights.tofile(path.with_suffix(".bil"))
    fields = {"BYTEORDER": "I", "LAYOUT": "BIL", "NROWS": rows, "NCOLS": columns, "NBANDS": 1, "NBITS": 32}
    fields |= {"BANDROWBYTES": 4 * columns, "TOTALROWBYTES": 4 * columns, "PIXELTYPE": "FLOAT"}
    fields |= {"ULXMAP": 0, "ULYMAP": 0, "XDIM": SPACING_M, "YDIM": SPACING_M}
    path.with_suffix(".hdr").write_text("".join(f"{name} {value}\n" for name, value in fields.items()))


def camera(heights):
    """Eye above the southern border and target in the middle, so that no wall of the map's is seen, which ours has: metres
    east, up, south."""
    reach = heights.shape[0] * SPACING_M
    top, middle = float(heights.max()), float(heights.mean())
    return np.array([0.0, top + 0.12 * reach, 0.47 * reach]), np.array([0.0, middle, 0.0])


def directions(eye, target, width, height):
    """Through the middles of the pixels, 1 along the view: a hit's ray parameter is its depth."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    pixel = 2 * np.tan(VERTICAL_FOV_RAD / 2) / height
    x = (np.arange(width) - (width - 1) / 2) * pixel
    y = ((height - 1) / 2 - np.arange(height)) * pixel
    return (forward + x[None, :, None] * right + y[:, None, None] * up).reshape(-1, 3).astype(np.float32)


class Embree:
    """The land as triangles in Embree."""

    def __init__(self, heights):
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_mono")
        self.drjit, self.mitsuba = drjit, mitsuba
        samples = heights.shape[0]
        at = ((np.arange(samples) - (samples - 1) / 2) * SPACING_M).astype(np.float32)
        east, south = np.meshgrid(at, at)
        corner = (np.arange(samples - 1)[:, None] * samples + np.arange(samples - 1)[None, :]).reshape(-1)
        triangles = np.stack(
            [corner, corner + samples, corner + 1, corner + 1, corner + samples, corner + samples + 1], axis=-1
        )
        mesh = mitsuba.Mesh("land", vertex_count=samples**2, face_count=2 * (samples - 1) ** 2)
        parameters = mitsuba.traverse(mesh)
        parameters["vertex_positions"] = np.stack([east, heights, south], axis=-1).reshape(-1)
        parameters["faces"] = triangles.reshape(-1).astype(np.uint32)
        parameters.update()
        drjit.sync_thread()
        started = time.monotonic()
        self.scene = mitsuba.load_dict({"type": "scene", "land": mesh})
        drjit.sync_thread()
        self.build_ms = 1e3 * (time.monotonic() - started)

    def prepare(self, eye, rays):
        point, vector = self.mitsuba.Point3f(eye.astype(np.float32)), self.mitsuba.Vector3f(rays.T)
        self.ray = self.mitsuba.Ray3f(point, vector)
        self.drjit.eval(self.ray)
        self.drjit.sync_thread()

    def trace(self):
        """Milliseconds, and the ray parameters, infinite where nothing is met."""
        started = time.monotonic()
        found = self.scene.ray_intersect_preliminary(self.ray, coherent=True)
        self.drjit.eval(found)
        self.drjit.sync_thread()
        spent_ms = 1e3 * (time.monotonic() - started)
        return spent_ms, np.where(np.array(found.is_valid()), np.array(found.t), np.inf)


def place(point):
    return ",".join(f"{value:.6f}" for value in point)


def ours(arguments, land, eye, target, folder):
    """The run of each variant in the record, and the depths of the first."""
    scene = ["--map", str(land.with_suffix(".hdr")), "--spacing", str(SPACING_M), "--base-level", "0"]
    scene += ["--camera", f"{place(eye)},{place(target)}", "--lod", arguments.lod, "--size", arguments.size, "--quiet"]
    program = [arguments.fumarole, "terrain"]
    bench = [*program, "bench", *scene, "--variant", arguments.variants, "--no-limits", "--json"]
    record = json.loads(subprocess.run(bench, check=True, stdout=subprocess.PIPE).stdout)
    depths = folder / "depth.npy"
    render = [*program, "render", *scene, "--variant", record["runs"][0]["variant"], "--image", str(folder / "land.png")]
    subprocess.run([*render, "--dump", f"depth={depths}"], check=True, stdout=subprocess.DEVNULL)
    found = np.load(depths).reshape(-1, 4)
    return record["runs"], found


def rays_ms(run):
    """Median of the passes that cast the rays."""
    return sum(entry["gpu_ms"]["median"] for entry in run["passes"] if entry["name"] in ("start", "depth"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fumarole", default="target/release/fumarole")
    parser.add_argument("--samples", default="512,1024,2048")
    parser.add_argument("--size", default="800x600")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--variants", default="gpu-compute,dda-compute,dda-fragment")
    parser.add_argument("--lod", default="exact", choices=["exact", "pixel"])
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    print(f"{arguments.size} rays, --lod {arguments.lod}, {len(os.sched_getaffinity(0))} cores; milliseconds")
    names = arguments.variants.split(",")
    print("| samples a side | Embree | its build | " + " | ".join(names) + " | loading | hits of one alone | between hits |")
    print("| --- | --- | --- | " + "--- | " * len(names) + "--- | --- | --- |")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for samples in map(int, arguments.samples.split(",")):
            heights = ridged_land(samples)
            write_bil(folder / "land", heights)
            eye, target = camera(heights)
            embree = Embree(heights)
            embree.prepare(eye, directions(eye, target, width, height))
            embree.trace()
            times = {name: [] for name in names}
            theirs_ms, loads_ms = [], []
            for _ in range(arguments.rounds):
                for _ in range(10):
                    spent_ms, theirs = embree.trace()
                    theirs_ms.append(spent_ms)
                runs, found = ours(arguments, folder / "land", eye, target, folder)
                loads_ms.append(runs[0]["load_ms"])
                for run in runs:
                    times[run["variant"]].append(rays_ms(run))
            depth = np.where(found[:, 3].astype(int) % 8 == TERRAIN, found[:, 0], np.inf)
            one_alone = np.isfinite(depth) != np.isfinite(theirs)
            both = np.isfinite(depth) & np.isfinite(theirs)
            apart = np.median(np.abs(depth[both] - theirs[both])) / SPACING_M
            cells = [f"{samples}", f"{statistics.median(theirs_ms):.1f}", f"{embree.build_ms:.0f}"]
            cells += [f"{statistics.median(times[name]):.1f}" for name in names]
            cells += [f"{statistics.median(loads_ms):.0f}", f"{100 * one_alone.mean():.2f} %", f"{apart:.4f} cells"]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
