#!/usr/bin/python3
"""Random scenes (scripts/random-scene): each is simulated to its end, or ends with one line that says when and why. No value
of a particle that is followed is NaN, no deformation gradient has lost its meaning, what ended has a reason and a time.

usage: random_scenes.py PIVNP RANDOM_SCENE COUNT [FIRST] [--wet]

--wet: with water in the pores. Then water is where it was or went through a boundary (1e-9 of it). A scene in which energy comes from
nothing (more than 1 % of the energy supplied) is run with drained pores, too: it is the water's fault if then none does. At most a
fiftieth of the scenes may be of that kind (docs/limits.md). Every third scene is not as the generator makes it: what holds it is taken away, or gravity is fifty times as large.
"""
import collections
import concurrent.futures
import re
import shutil
import signal
import subprocess
import sys

import h5py
import numpy as np

from program import CpuLimit, folder, run

wet = "--wet" in sys.argv
arguments = [a for a in sys.argv[1:] if a != "--wet"]
program, generator, count = arguments[0], arguments[1], int(arguments[2])
first = int(arguments[3]) if len(arguments) > 3 else 1
scratch = folder()
most_gained = 0.01
of_the_skeleton, of_the_water = "gained, drained too", "gained by water"
most_seconds = 300
FAILURES = re.compile(r"mpm: at t = .* s, step \d+: |initial equilibrium: |mpm\.initial_equilibrium: ")


def scene(seed):
    text = subprocess.run([generator, str(seed)] + ["--wet"] * wet, capture_output=True, text=True, check=True).stdout
    text = re.sub(r"^energy_limit = .*\n", "", text, flags=re.M)
    text = re.sub(r"^end_s = .*$", "end_s = 0.15", text, flags=re.M)
    if seed % 6 == 0:  # nothing carries it
        text = re.sub(r"\[boundary\.base\]\n(?:[^\[\n]+.*\n)*", "", text)
        if seed % 12 == 0 and not wet and "neo_hookean" not in text and '"water"' not in text:
            text = text.replace("settle = false", "settle = true")
    elif seed % 6 == 3:
        text = re.sub(r"^gravity.*\n", "", text, flags=re.M)
        text = text.replace("[mpm]", "[mpm]\ngravity_m_s2 = [0.0, -490.5]")
        text = re.sub(r"^end_s = .*$", "end_s = 0.05", text, flags=re.M).replace("output_rate_hz = 40.0", "output_rate_hz = 200.0")
    return text


def drained(text):
    """The same scene, whose pores have no pressure of their own."""
    text = re.sub(r'^(drained = true|pressure = "projected")\n', "", text, flags=re.M)
    return re.sub(r"^permeability_m_s", "drained = true\npermeability_m_s", text, flags=re.M)


def nonsense(record):
    """What is wrong in a record, or nothing."""
    with h5py.File(record) as file:
        motion = file["motion/mpm"]
        status, F, u = motion["status"][:], motion["F"][:].astype("f8"), motion["u"][:]
        followed = status == 1
        for name in ("u", "v", "stress", "F", "plastic_dev"):
            if not np.isfinite(motion[name][:][followed]).all():
                return f"{name} of a particle that is followed is not finite"
        if (np.linalg.det(F)[followed] <= 0).any():
            return "det F <= 0 of a particle that is followed"
        if np.abs(F[followed]).max(initial=0) > 1e5:
            return f"|F| = {np.abs(F[followed]).max():.2g} of a particle that is followed"
        ended, reason, end = (status == 3).any(axis=0), motion["end_reason"][:], motion["end"][:]
        if (ended & ((reason == 0) | ~np.isfinite(end))).any() or (~ended & (reason != 0) & (end < motion["time"][-1])).any():
            return "a particle ended without reason or time"
        if not np.isfinite(u[status == 3]).all():
            return "an ended particle's last place is not finite"
        energy = file["energy"]
        if not all(np.isfinite(energy[name][:]).all() for name in energy):
            return "an energy is not finite"
        return out_of_books(energy)[1] if wet else ""


def out_of_books(energy):
    """Energy from nothing, over the energy supplied; and what is wrong with the water."""
    of = collections.defaultdict(float, {name: energy[name][:].astype("f8") for name in energy})  # (no water: all of it is drained)
    stored = of["kinetic"] + of["elastic"] + of["water"]
    turned_over = np.maximum.accumulate(stored[0] + np.abs(of["external"]) + of["plastic"] + of["darcy"] + np.abs(of["damping"]))
    gained = (of["residual"] / np.maximum(turned_over, 1e-3)).max()
    if "water" not in energy:
        return gained, ""
    lost = np.abs(of["water_mass"] - of["water_mass"][0] - of["water_inflow"]).max() / max(of["water_mass"].max(), 1e-9)
    return gained, f"water from nothing: {lost:.3g} of it" if lost > 1e-9 else ""


def simulate(there, text):
    there.mkdir()
    (there / "case.toml").write_text(text)
    return run(program, "simulate", there, "--out", there / "out", "--threads", "1", "--quiet", timeout=7200, preexec_fn=CpuLimit(most_seconds))


def gains(there, done):
    """Energy from nothing: in the record, or what the run was stopped for."""
    if done.returncode != 0:
        return "the energy residual is" in done.stderr
    with h5py.File(there / "out" / "record.h5") as file:
        return out_of_books(file["energy"])[0] > most_gained


def whose_gain(there, text, done):
    if not gains(there, done):
        return ""
    twin = there / "drained"
    again = simulate(twin, drained(text))
    return of_the_skeleton if again.returncode != 0 or gains(twin, again) else of_the_water


def attempt(seed):
    there = scratch / str(seed)
    text = scene(seed)
    done = simulate(there, text)
    if done.returncode == -signal.SIGXCPU:
        return "hang", f"seed {seed}: no end after {most_seconds} s of processor time"
    errors = [line for line in done.stderr.splitlines() if line.startswith("pivnp: error:")]
    wrong = ""
    if done.returncode == 0:
        wrong = nonsense(there / "out" / "record.h5")
    elif done.returncode not in (1, 2) or len(errors) != 1 or not FAILURES.search(errors[0]) or re.search(r"\bnan\b", errors[0]):
        wrong = f"exit {done.returncode}: {done.stderr.strip()[-300:]}"
    outcome = "finished" if done.returncode == 0 else FAILURES.search(errors[0])[0][:25] if errors and FAILURES.search(errors[0]) else "failed"
    gained = whose_gain(there, text, done) if wet and not wrong else ""
    if not wrong and gained != of_the_water:
        shutil.rmtree(there)
    elif wrong and outcome == "finished":
        outcome = "nonsense"
    if gained == of_the_water:
        print(f"seed {seed}: energy from nothing, and none with drained pores", flush=True)
    return f"{outcome}, {gained}" if gained else outcome, wrong and f"seed {seed}: {wrong}"


with concurrent.futures.ThreadPoolExecutor(2) as pool:
    results = list(pool.map(attempt, range(first, first + count)))
print(dict(collections.Counter(re.sub(r"\d[-+\d.e]*", "", outcome) for outcome, _ in results)))
faults = [wrong for _, wrong in results if wrong]
if sum(outcome.endswith(of_the_water) for outcome, _ in results) > max(1, count / 50):
    faults.append("energy from nothing by water in more than a fiftieth of the scenes")
if sum(outcome.startswith("finished") for outcome, _ in results) < (0.5 if wet else 0.6) * count:
    faults.append("too few scenes came to their end")
if faults:
    sys.exit("\n".join(faults) + f"\n{scratch}")
