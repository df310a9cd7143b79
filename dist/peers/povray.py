#!/usr/bin/env python3
"""Times steam over a glass, figure 8 of the gas paper, here and in POV-Ray's media, at as many samples a ray.

    dist/peers/povray.py [--fumarole target/release/fumarole] [--samples 20,40,80] [--size 360x250] [--rounds 3]
                         [--picture povray.png]

Needs povray (Debian). The scene is written anew in POV-Ray's language: the same room, glass, light, camera and frustum of
steam, with POV-Ray's own noise in six octaves and its own shading, without refraction and shadows of surfaces as here.
Scattering media shadow themselves and what lies behind, as `traced` does; `table` is the paper's way to the same shadows.

POV-Ray takes so many samples of every ray, however short it is in the steam; ours takes steps of one length, so many along the
steam's longest side, and gets twice as many of them as POV-Ray has samples: rays that meet gas are then sampled as often in the
mean (14,758 samples of 1,496 such rays by 20 steps, 27,460 by 40, at 120x83).

The two take turns on the same cores, and medians count: of POV-Ray the time that it states for tracing, without parsing; of
ours a whole frame, without loading.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import tempfile

STEPS_A_SAMPLE = 2  # along the steam's longest side, for a sample of a ray in the mean

SCENE = """
#version 3.7;
#include "functions.inc"
global_settings {{ assumed_gamma 1 ambient_light rgb 1 max_trace_level 8 }}
camera {{
    perspective location <0.6, 2.1, -5.2> right x * image_width / image_height up y
    angle degrees(2 * atan(tan(0.60 / 2) * image_width / image_height)) look_at <0, 1.15, 0>
}}
light_source {{ <1.8, 4.0, -3.2> rgb 0.85 }}
#declare Plain = finish {{ ambient 0.22 diffuse 1 }}
plane {{ y, 0 pigment {{ checker rgb <0.34, 0.20, 0.12> rgb <0.24, 0.14, 0.09> scale 0.6 }} finish {{ Plain }} }}
box {{ <-6, 0, 1.5>, <6, 5, 1.7> pigment {{ rgb <0.28, 0.34, 0.45> }} finish {{ Plain }} }}
lathe {{
    linear_spline 14, <0, 0>, <0.40, 0>, <0.44, 0.35>, <0.48, 0.8>, <0.50, 1.2>, <0.46, 1.2>, <0.44, 0.8>, <0.40, 0.35>,
    <0.36, 0.08>, <0.20, 0.08>, <0.10, 0.08>, <0.05, 0.08>, <0, 0.08>, <0, 0>
    pigment {{ rgb <0.75, 0.85, 0.9> transmit 0.84 }} finish {{ ambient 0.22 diffuse 1 phong 2.5 phong_size 60 }} no_shadow
}}
lathe {{
    linear_spline 7, <0, 0.09>, <0.355, 0.09>, <0.395, 0.35>, <0.435, 0.80>, <0.438, 0.85>, <0, 0.85>, <0, 0.09>
    pigment {{ rgb <0.20, 0.08, 0.03> }} finish {{ ambient 0.22 diffuse 1 phong 0.3 phong_size 30 }} no_shadow
}}
#declare Turbulence = function(x, y, z) {{
    abs(2 * f_noise3d(x, y, z) - 1) + abs(2 * f_noise3d(2 * x, 2 * y, 2 * z) - 1) / 2
    + abs(2 * f_noise3d(4 * x, 4 * y, 4 * z) - 1) / 4 + abs(2 * f_noise3d(8 * x, 8 * y, 8 * z) - 1) / 8
    + abs(2 * f_noise3d(16 * x, 16 * y, 16 * z) - 1) / 16 + abs(2 * f_noise3d(32 * x, 32 * y, 32 * z) - 1) / 32
}}
cone {{
    <0, 0.85, 0>, 0.42, <0, 2.95, 0>, 0.75 hollow
    pigment {{ rgbt 1 }}
    interior {{ media {{
        method 2 jitter 0 intervals 1 samples {samples}, {samples}
        scattering {{ 1, rgb 9 extinction 1 }}
        density {{ function {{
            min(1, pow(Turbulence(2.2 * x + 7.3, 2.2 * y + 2.1, 2.2 * z + 4.7) * 0.7, 3))
            * max(0, 1 - (x * x + z * z) / 0.5)
        }} density_map {{ [0 rgb 0] [1 rgb 1] }} }}
    }} }}
}}
"""


def povray(scene, size, picture):
    """Seconds of tracing."""
    width, height = size.split("x")
    command = ["povray", f"+I{scene}", f"+O{picture}", f"+W{width}", f"+H{height}", "-D", "-A"]
    command.append(f"+WT{len(os.sched_getaffinity(0))}")
    done = subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    told = re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", done.stderr)
    if told is None:
        raise SystemExit(f"povray told no time for tracing:\n{done.stderr}")
    return float(told.group(1))


def ours(program, size, samples):
    """Milliseconds of a frame of each variant."""
    command = [program, "gas", "bench", "--preset", "fig-8", "--variant", "none,traced,table", "--size", size]
    command += ["--steps", str(STEPS_A_SAMPLE * samples), "--frames", "1", "--repeat", "3", "--warmup", "1", "--no-limits"]
    command += ["--quiet", "--json"]
    record = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return {run["variant"]: run["frame_ms"]["median"] for run in record["runs"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fumarole", default="target/release/fumarole")
    parser.add_argument("--samples", default="20,40,80")
    parser.add_argument("--size", default="360x250")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--picture", help="keep POV-Ray's picture of the last")
    arguments = parser.parse_args()
    print(f"{arguments.size}, {len(os.sched_getaffinity(0))} cores; milliseconds")
    print("| samples | POV-Ray | none | traced | table | POV-Ray / traced | POV-Ray / table |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for samples in map(int, arguments.samples.split(",")):
            scene = folder / "steam.pov"
            scene.write_text(SCENE.format(samples=samples))
            picture = pathlib.Path(arguments.picture) if arguments.picture else folder / "steam.png"
            theirs_ms, frames_ms = [], {"none": [], "traced": [], "table": []}
            for _ in range(arguments.rounds):
                theirs_ms.append(1e3 * povray(scene, arguments.size, picture))
                for variant, frame_ms in ours(arguments.fumarole, arguments.size, samples).items():
                    frames_ms[variant].append(frame_ms)
            theirs = statistics.median(theirs_ms)
            none, traced, table = (statistics.median(frames_ms[name]) for name in ["none", "traced", "table"])
            times = f"{theirs:.0f} | {none:.0f} | {traced:.0f} | {table:.0f}"
            print(f"| {samples} | {times} | {theirs / traced:.1f} | {theirs / table:.1f} |", flush=True)


if __name__ == "__main__":
    main()
