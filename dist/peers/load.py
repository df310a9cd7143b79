#!/usr/bin/env python3
"""Times how long meshes take to load here, in assimp and in trimesh, vertices joined in each, on files made for it.

    dist/peers/load.py [--fumarole target/release/fumarole] [--triangles 1000000,10000000] [--runs 3] [--folder DIR]

Needs numpy; assimp-utils (Debian) and trimesh (PyPI) where they are to be measured: what is missing is said and left out.
Every run is a process of its own, the file in the system's cache; the three take turns, and the median counts. Of ours
it is `load_ms` of the record, which reads, joins, computes normals and orders for the vertex cache, and beside it the
part that reads and joins, which is what the others do; of assimp the program's own time for its import, or the whole
process where it tells none; of trimesh the time of `load` after it was imported.
"""

import argparse
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np


def wavy_grid(triangles):
    """Positions and indices of a closed-form height field of about so many triangles."""
    side = max(2, int((triangles / 2) ** 0.5) + 1)
    x, z = np.meshgrid(np.arange(side, dtype=np.float32), np.arange(side, dtype=np.float32))
    positions = np.stack([x, np.sin(x / 9) + np.cos(z / 7), z], axis=-1).reshape(-1, 3).astype("<f4")
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)[None, :]).reshape(-1)
    cells = [[corner, corner + side, corner + 1], [corner + 1, corner + side, corner + side + 1]]
    indices = np.stack([np.stack(cell, axis=-1) for cell in cells], axis=1).reshape(-1, 3).astype("<i4")
    return positions, indices


def write_stl(path, positions, indices):
    facets = np.zeros(len(indices), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    facets["corners"] = positions[indices]
    with open(path, "wb") as file:
        file.write(bytes(80) + np.uint32(len(indices)).tobytes())
        facets.tofile(file)


def write_ply(path, positions, indices):
    faces = np.zeros(len(indices), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, indices
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(indices)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode())
        positions.tofile(file)
        faces.tofile(file)


def write_obj(path, positions, indices):
    with open(path, "w") as file:
        np.savetxt(file, positions, fmt="v %.6g %.6g %.6g")
        np.savetxt(file, indices + 1, fmt="f %d %d %d")


def ours(program, path):
    """Seconds of the whole load, and of reading and joining."""
    command = [program, "caustics", "bench", "--mesh", path, "--variant", "level-map", "--planes", "3", "--no-cache"]
    command += ["--size", "32x24", "--map-size", "16", "--water-triangles", "100", "--frames", "1", "--repeat", "1"]
    command += ["--warmup", "1", "--no-limits", "--quiet", "--json"]
    run = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["runs"][0]
    parts = run["loading"]
    return run["load_ms"] / 1e3, (parts["read_ms"] + parts["weld_ms"]) / 1e3


def assimp(path):
    started = time.monotonic()
    done = subprocess.run(["assimp", "info", path, "-jiv"], check=True, stdout=subprocess.PIPE, text=True)
    whole = time.monotonic() - started
    told = re.search(r"import took approx\.\s*([0-9.]+)\s*seconds", done.stdout)
    return float(told.group(1)) if told else whole


def trimesh(path):
    script = (
        "import sys, time, trimesh\nstarted = time.monotonic()\n"
        "mesh = trimesh.load(sys.argv[1], process=True)\nprint(time.monotonic() - started)"
    )
    done = subprocess.run([sys.executable, "-c", script, path], check=True, stdout=subprocess.PIPE, text=True)
    return float(done.stdout.split()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fumarole", default="target/release/fumarole", help="our program")
    parser.add_argument("--triangles", default="1000000,10000000", help="sizes of the files, comma-separated")
    parser.add_argument("--formats", default="stl,ply,obj", help="of stl, ply and obj, comma-separated")
    parser.add_argument("--runs", type=int, default=3, help="of each, in turn")
    parser.add_argument("--folder", help="where the files are made, and removed [default: a temporary one]")
    arguments = parser.parse_args()
    has_assimp = shutil.which("assimp") is not None
    probe = subprocess.run([sys.executable, "-c", "import trimesh"], stderr=subprocess.DEVNULL)
    has_trimesh = probe.returncode == 0
    for name, is_there in [("assimp", has_assimp), ("trimesh", has_trimesh)]:
        if not is_there:
            print(f"SKIPPED: {name} is not installed", file=sys.stderr)
    writers = {"stl": write_stl, "ply": write_ply, "obj": write_obj}
    print("| file | MB | ours, read and joined s | ours, whole load s | assimp s | trimesh s |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        for triangles in map(int, arguments.triangles.split(",")):
            positions, indices = wavy_grid(triangles)
            for ending in arguments.formats.split(","):
                path = pathlib.Path(folder, f"mesh.{ending}")
                writers[ending](path, positions, indices)
                times = {"whole": [], "joined": [], "assimp": [], "trimesh": []}
                for _ in range(arguments.runs):
                    whole, joined = ours(arguments.fumarole, str(path))
                    times["whole"].append(whole)
                    times["joined"].append(joined)
                    if has_assimp:
                        times["assimp"].append(assimp(str(path)))
                    if has_trimesh:
                        times["trimesh"].append(trimesh(str(path)))
                shown = {key: f"{statistics.median(values):.2f}" if values else "" for key, values in times.items()}
                print(
                    f"| {len(indices)} triangles, {ending} | {path.stat().st_size / 1e6:.0f} | {shown['joined']} "
                    f"| {shown['whole']} | {shown['assimp']} | {shown['trimesh']} |",
                    flush=True,
                )
                path.unlink()


if __name__ == "__main__":
    main()
