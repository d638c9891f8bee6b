"""Small cases and how to run them."""
import os
import pathlib
import resource
import subprocess
import tempfile

CASE = """
name = "small"
[frames]
rate_hz = 10.0
[camera]
metres_per_pixel = 0.001
[grid]
spacing_px = 16
[region.soil]
polygon_m = [[0.03, 0.03], [0.13, 0.03], [0.13, 0.09], [0.03, 0.09]]
[piv]
window_px = 32
[material.soil]
model = "linear_elastic"
density_kg_m3 = 2000.0
young_pa = 1e6
poisson = 0.3
[mpm]
[boundary.base]
line_m = [[0.0, 0.032], [0.16, 0.032]]
[synth]
motion = "affine"
width_px = 160
height_px = 128
frames = 5
shift_px_per_frame = [1.5, 0.5]
"""


def folder():
    return pathlib.Path(tempfile.mkdtemp(prefix="pivnp-test-"))


def run(program, *arguments, cwd=None, timeout=300, **more):
    env = dict(os.environ, QT_QPA_PLATFORM="offscreen")
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, env=env,
                          stdin=subprocess.DEVNULL, timeout=timeout, **more)


class CpuLimit:
    """preexec_fn of a process that may take so many seconds of processor time: a busy machine makes no hang."""

    def __init__(self, seconds):
        self.seconds = seconds

    def __call__(self):
        resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds + 60))
