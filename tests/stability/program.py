"""Small cases and how to run them. A script none of whose runs ends well has tested nothing, and fails."""
import atexit
import os
import pathlib
import random
import resource
import subprocess
import sys
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


ended_well = []


@atexit.register
def tested_something():
    if not ended_well:
        print("no run ended well: nothing was tested", file=sys.stderr, flush=True)
        os._exit(1)


def run(program, *arguments, cwd=None, timeout=300, env=None, **more):
    env = dict(env or os.environ, QT_QPA_PLATFORM="offscreen")
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, env=env,
                          stdin=subprocess.DEVNULL, timeout=timeout, **more)
    if done.returncode == 0:
        ended_well.append(arguments)
    return done


def fault_of(result, codes=(0, 1, 2)):
    """Whatever happens, a run ends with one of these codes, and with one line if it is not 0."""
    if result.returncode not in codes:
        return f"exit {result.returncode}: {result.stderr.strip()[-300:]}"
    said = [line for line in result.stderr.splitlines() if line.startswith("pivnp: error:")]
    return "" if len(said) == (result.returncode != 0) else f"exit {result.returncode} with {len(said)} lines: {result.stderr.strip()[-300:]}"


def seeded():
    """The seed of this run, printed; PIVNP_TEST_SEED repeats it."""
    seed = int(os.environ.get("PIVNP_TEST_SEED", random.randrange(10**6)))
    print("seed", seed, flush=True)
    return random.Random(seed)


class CpuLimit:
    """preexec_fn of a process that may take so many seconds of processor time: a busy machine makes no hang."""

    def __init__(self, seconds):
        self.seconds = seconds

    def __call__(self):
        resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds + 60))
