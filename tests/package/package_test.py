"""The installed package: installs the build into a temporary prefix, builds examples/ against it as a project of its own, and
holds what they print to the truth: a shifted picture, and the path of a block that slides.

usage: package_test.py CMAKE BUILD_FOLDER SOURCE_FOLDER
"""
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

cmake, build, source = sys.argv[1:]


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def grains(shift, seed=3, side=128):
    """A PGM picture of Gaussian grains moved by `shift` px, (right, down)."""
    random = np.random.default_rng(seed)
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    picture = np.full((side, side), 20.0)
    for x, y in random.uniform(-8, side + 8, (1200, 2)):
        picture += 80 * np.exp(-((column - x - shift[0])**2 + (row - y - shift[1])**2) / (2 * 1.2**2))
    return b"P5 %d %d 255\n" % (side, side) + np.clip(np.round(picture), 0, 255).astype("u1").tobytes()


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    prefix, programs = folder / "prefix", folder / "build"
    run(cmake, "--install", build, "--prefix", prefix)
    assert run(prefix / "bin" / "pivnp", "--version").strip(), "the installed program states no version"
    run(cmake, "-S", pathlib.Path(source) / "examples", "-B", programs, f"-DCMAKE_PREFIX_PATH={prefix}",
        "-DCMAKE_BUILD_TYPE=Release")
    run(cmake, "--build", programs)

    shift = (3.3, -1.6)
    for name, by in (("first.pgm", (0, 0)), ("second.pgm", shift)):
        (folder / name).write_bytes(grains(by))
    rows = [line.split() for line in run(programs / "correlate", folder / "first.pgm", folder / "second.pgm").splitlines()]
    vectors = np.array([[float(row[2]), float(row[3])] for row in rows if row[5] == "1"])
    assert len(rows) == 49 and len(vectors) >= 45, f"{len(vectors)} valid vectors of {len(rows)}, expected 49"
    error = np.abs(vectors - shift).max()
    assert error < 0.1, f"displacements are off by {error} px"
    print(f"correlate: {len(vectors)} of {len(rows)} vectors valid, off by {error:.3f} px at most")

    rows = [[float(value) for value in line.split()] for line in run(programs / "sliding_block").splitlines()]
    assert [row[0] for row in rows] == [0.1, 0.2, 0.3], rows
    for time, simulated, analytic in rows:
        angle = math.radians(30)
        exact = 0.5 * 9.81 * (math.sin(angle) - 0.2 * math.cos(angle)) * time**2
        assert abs(analytic - exact) < 1e-4, f"at {time} s the analytic path is {analytic}, expected {exact}"
        assert abs(simulated - exact) < 0.02 * exact + 1e-4, f"at {time} s: {simulated} m, expected {exact} m"
    print(f"sliding_block: {rows[-1][1]} m, analytic {rows[-1][2]} m")
