#!/usr/bin/python3
"""What a case's text can tell is told before anything is computed: by `check`, and by `run` within seconds, with exit code 2,
one line with file, line and key, and no file left behind. Sizes that no machine has; fields and zones that are none; what
is no file; command lines that ask for too much."""
import os
import subprocess
import sys
import time

from program import CASE, folder, run

program = sys.argv[1]
faults = []
LEAST = CASE.replace("frames = 5", "frames = 3")
COLUMN = """
name = "column"
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.08, 0.16]]
[region.soil]
polygon_m = [[0.0, 0.0], [0.08, 0.0], [0.08, 0.12], [0.0, 0.12]]
[material.soil]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
[mpm]
end_s = 0.02
output_rate_hz = 100.0
[boundary.base]
line_m = [[0.0, 0.0], [0.08, 0.0]]
"""


def lines_of(result):
    return [line for line in result.stderr.splitlines() if line.startswith("pivnp: error:")]


def expect(name, result, seconds, *words):
    lines = lines_of(result)
    wrong = [f"'{word}' is not named" for word in words if not any(word in line for line in lines)]
    if result.returncode != 2:
        wrong.append(f"exit code {result.returncode}, expected 2")
    if len(lines) != 1 or len(lines[0]) > 2200:
        wrong.append(f"{len(lines)} error lines, expected a short one")
    if seconds > 20:
        wrong.append(f"took {seconds:.0f} s")
    print(("FAIL " if wrong else "ok   ") + name + ": " + (lines[0][:300] if lines else result.stderr[-300:]))
    if wrong:
        faults.append(name + ": " + "; ".join(wrong))


def timed(*arguments, **more):
    start = time.monotonic()
    return run(program, *arguments, **more), time.monotonic() - start


def line_of(text, words):
    return "case.toml:" + str(1 + next(k for k, line in enumerate(text.splitlines()) if words in line))


def refused(name, text, at, *words):
    """`at`: what stands in the line that the message names."""
    for command in ("check", "run"):
        there = folder()
        (there / "case.toml").write_text(text)
        result, seconds = timed(command, there / "case.toml", "--out", there / "new" / "out")
        expect(f"{command}: {name}", result, seconds, line_of(text, at), *words)
        if command == "check" and sorted(p.name for p in there.iterdir()) != ["case.toml"]:
            faults.append(f"{name}: check left {sorted(str(p) for p in there.rglob('*'))}")


def changed(text, old, new):
    assert old in text, old
    return text.replace(old, new)


# Sizes.
refused("millimetres", changed(COLUMN, "area_m = [[0.0, 0.0], [0.08, 0.16]]", "area_m = [[0.0, 0.0], [800.0, 1600.0]]"),
        "spacing_m", "grid.spacing_m", "nodes")
refused("cells too small", changed(COLUMN, "spacing_m = 0.02", "spacing_m = 1.6e-6"), "spacing_m", "grid.spacing_m", "nodes")
refused("domain", changed(COLUMN, "[mpm]", "[mpm]\ndomain_m = [[0.0, 0.0], [800.0, 1600.0]]"), "domain_m", "mpm.domain_m", "nodes")
refused("rate", changed(COLUMN, "output_rate_hz = 100.0", "output_rate_hz = 1e9"), "output_rate_hz", "mpm.output_rate_hz", "states")
refused("end before the first output", changed(COLUMN, "output_rate_hz = 100.0", "output_rate_hz = 40.0"), "end_s", "mpm.end_s: found 0.02 s", "0.025 s")
refused("courant", changed(COLUMN, "[mpm]", "[mpm]\ncourant = 1e-300"), "courant", "mpm.courant", "steps")
refused("points", changed(changed(COLUMN, "spacing_m = 0.02", "spacing_m = 2e-5"), "[mpm]", "[mpm]\nper_element = 100"),
        "spacing_m", "grid.spacing_m", "points")
refused("blobs", LEAST + "[synth.texture]\ndensity_per_px = 1e9\n", "density_per_px", "synth.texture.density_per_px", "blobs")

# Fields and zones.
refused("report.fields", LEAST + '[report]\nfields = ["strain_div"]\n', "strain_div", "report.fields", "strain_dev")
for key in ("reference_m", "fixed_zone_m"):
    refused(key, LEAST + f"[compare]\n{key} = [[5.0, 5.0], [5.1, 5.0], [5.1, 5.1]]\n", key, "compare." + key, "particles")
refused("still zone", LEAST + "[np]\nstill_zone_m = [[5.0, 5.0], [5.1, 5.0], [5.1, 5.1]]\n", "still_zone_m", "np.still_zone_m", "particle")
refused("empty region", changed(LEAST, "[[0.03, 0.03], [0.13, 0.03], [0.13, 0.09], [0.03, 0.09]]", "[[3.0, 3.0], [4.0, 3.0], [4.0, 4.0]]"),
        "polygon_m = [[3.0", "region.soil")
refused("mask over all", LEAST + "[mask.all]\ncircle_px = [80.0, 64.0, 900.0]\n", "[mask", "mask")
refused("held by nothing", changed(COLUMN, "[[0.0, 0.0], [0.08, 0.0], [0.08, 0.12], [0.0, 0.12]]",
                                   "[[0.0, 0.06], [0.08, 0.06], [0.08, 0.12], [0.0, 0.12]]"), "[mpm]", "mpm.initial_equilibrium", "soil")

# A valid case is told its size.
there = folder()
(there / "case.toml").write_text(COLUMN)
result = run(program, "check", there, "--out", there / "out")
if result.returncode != 0 or "material points" not in result.stdout or (there / "out").exists():
    faults.append("size of a valid case: " + result.stdout + result.stderr)

# Two frames are drawn for the check; those that a case uses are counted without them.
(there / "later.toml").write_text(changed(LEAST, "[frames]", "[frames]\nlast = 2"))
result = run(program, "check", there / "later.toml", "--out", there / "o")
if result.returncode != 0:
    faults.append("frames.last within synth.frames: " + result.stderr)

# What is no file, and texts without measure.
os.mkfifo(there / "pipe.png")
os.mkfifo(there / "pipe.toml")
for name in ("pipe.h5", "pipe_1.csv", "pipe_1.h5", "pipe_1.vtk"):
    os.mkfifo(there / name)
for name, arguments in (("report of a pipe", ["report", "pipe.h5"]), ("verify of a pipe", ["verify", "pipe.h5"]),
                        ("compare of a pipe", ["compare", "pipe.h5", "pipe.h5"]), ("front of a pipe", ["compare", "front=pipe.h5", "pipe.h5"]),
                        *((f"{kind} from a pipe", ["compare", f"{kind}=pipe_{which}.{ending}", "pipe.h5"])
                          for kind, ending in (("csv", "csv"), ("cbgeo", "h5"), ("vtk", "vtk")) for which in "1*")):
    expect(name, *timed(*arguments, cwd=there), "pipe")
(there / "frames.toml").write_text(changed(LEAST, "[frames]", f'[frames]\npath = "pipe.png"'))
for name, arguments in (("frames from a pipe", ["run", there / "frames.toml"]), ("case from a pipe", ["run", there / "pipe.toml"]),
                        ("empty name", ["run", ""])):
    expect(name, *timed(*arguments, "--out", there / "o", cwd=there))
for name, text in (("deep key", "a." * 20000 + "b = 1\n"), ("deep list", "a = " + "[" * 20000 + "]" * 20000 + "\n"),
                   ("long key", "k" * 100000 + " = 1\n"), ("long value", changed(LEAST, 'motion = "affine"', 'motion = "' + "m" * 100000 + '"'))):
    (there / "long.toml").write_text(text)
    expect(name, *timed("check", there / "long.toml", "--out", there / "o"), "long.toml:")

# Threads that are not to be had.
for name, arguments, environment in (("--threads 4096", ["--threads", "4096"], {}), ("OMP_NUM_THREADS", [], {"OMP_NUM_THREADS": "1000000"})):
    start = time.monotonic()
    (there / "case.toml").write_text(LEAST)
    done = subprocess.run([program, "run", str(there), "--out", str(there / "threads"), "--force", *arguments], capture_output=True, text=True,
                          env=dict(os.environ, QT_QPA_PLATFORM="offscreen", **environment), stdin=subprocess.DEVNULL, timeout=120)
    if done.returncode != 0 or time.monotonic() - start > 60:
        faults.append(f"{name}: exit {done.returncode} after {time.monotonic() - start:.0f} s: {done.stderr[-300:]}")

# Threads that wait do not spin for long, unless the user says how they wait.
for environment, brief in (({}, True), ({"OMP_WAIT_POLICY": "active"}, False)):
    given = {k: v for k, v in os.environ.items() if k not in ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY")}
    run = subprocess.Popen([program, "run", str(there), "--out", str(there / "waiting"), "--force"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                           env=dict(given, QT_QPA_PLATFORM="offscreen", **environment), stdin=subprocess.DEVNULL)
    seen = False
    while run.poll() is None:
        try:
            seen |= b"GOMP_SPINCOUNT=1000" in open(f"/proc/{run.pid}/environ", "rb").read()
        except OSError:
            pass  # it has just ended
        time.sleep(.002)
    if run.returncode != 0 or seen != brief:
        faults.append(f"waiting threads, {environment}: exit {run.returncode}, GOMP_SPINCOUNT set: {seen}")

# Standard descriptors that are closed: what is meant for them goes into no file of the run. Results that cannot be printed: exit 1.
(there / "column.toml").write_text(COLUMN)
for closed in ((2,), (1, 2), (0, 1, 2)):
    def close(descriptors=closed):
        for descriptor in descriptors:
            os.close(descriptor)
    out = there / ("closed" + "".join(map(str, closed)))
    done = subprocess.run([program, "simulate", str(there / "column.toml"), "--out", str(out), "--no-report"],
                          env=dict(os.environ, QT_QPA_PLATFORM="offscreen"), preexec_fn=close, timeout=120)
    written = [path.name for path in out.rglob("*") if path.is_file() and b"simulation" in path.read_bytes() and path.suffix != ".h5"]
    if not (out / "record.h5").is_file() or written or done.returncode != (1 in closed):
        faults.append(f"closed descriptors {closed}: exit {done.returncode}, found output in {written}")

# Called by the loader, as bundles with a C library of their own do.
loader = [line.split()[0] for line in subprocess.run(["ldd", program], capture_output=True, text=True).stdout.splitlines() if "/ld-" in line]
done = subprocess.run([*loader[:1], program, "check", str(there)], capture_output=True, text=True,
                      env={k: v for k, v in os.environ.items() if k not in ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY")}, stdin=subprocess.DEVNULL)
if not loader or done.returncode != 0:
    faults.append(f"called by {loader}: exit {done.returncode}: {done.stdout[-300:]}{done.stderr[-300:]}")

if faults:
    sys.exit("\n".join(faults))
