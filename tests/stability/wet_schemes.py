#!/usr/bin/python3
"""Every scheme of the step beside water in the pores, each with everything else that may stand beside it: a case runs to its end
with numbers, water and energy that are in order, or it is refused by one line that names a key.

usage: wet_schemes.py PIVNP [EACH]

EACH: only every so many of the cases, evenly.
"""
import collections
import concurrent.futures
import itertools
import re
import shutil
import sys

import h5py
import numpy as np

from program import folder, run

SHAPES = ("bilinear", "gimp", "bspline")
TRANSFERS = ("flip", "apic", "xpic")
UPDATES = ("usf", "usl", "musl")
LOCKING = ("none", "fbar", "selective", "full")
PRESSURES = ("explicit", "projected")

SOIL = """
[material.soil]
model = "mohr_coulomb"
young_pa = 1e6
poisson = 0.3
friction_deg = 30.0
cohesion_pa = 1000.0
porosity = 0.4
permeability_m_s = 1e-5
grain_density_kg_m3 = 2650.0
"""
BLOCK = "\n[region.soil]\npolygon_m = [[0.0, 0.0], [0.08, 0.0], [0.08, 0.08], [0.0, 0.08]]\n"
HALVES = """
[region.soil]
polygon_m = [[0.0, 0.0], [0.08, 0.0], [0.08, 0.04], [0.0, 0.04]]

[region.above]
polygon_m = [[0.0, 0.04], [0.08, 0.04], [0.08, 0.08], [0.0, 0.08]]
material = "{}"
"""
# What stands beside the water: regions and materials, and the rest.
BESIDE = {
    "a free block": (BLOCK + SOIL, ""),
    "a lake": (BLOCK + SOIL, "\n[water]\nbulk_modulus_pa = 1e8\nlevel_m = 0.12\n"),
    "a surface inside": (BLOCK + SOIL, "\n[water]\nbulk_modulus_pa = 1e8\nlevel_m = 0.05\n"),
    "contact": (HALVES.format("soil") + SOIL, '\n[contact.joint]\nregions = ["above"]\nfriction = 0.4\n'),
    "contact with dry soil": (HALVES.format("dry") + SOIL + '\n[material.dry]\nmodel = "linear_elastic"\nyoung_pa = 1e6\ndensity_kg_m3 = 1600.0\n',
                              '\n[contact.joint]\nregions = ["above"]\nfriction = 0.4\n'),
    "a rigid body": (BLOCK + SOIL, "\n[body.ball]\ncircle_m = [0.04, 0.105, 0.025]\nvelocity_m_s = [0.0, -0.2]\nfriction = 0.3\n"),
    "a free body": (BLOCK + SOIL, "\n[body.ball]\ncircle_m = [0.04, 0.106, 0.025]\nmass_kg_m = 5.0\n"),
    "a moving wall": (BLOCK + SOIL, '\n[boundary.side]\nline_m = [[0.0, 0.0], [0.0, 0.16]]\ntype = "fixed"\nvelocity_m_s = [0.05, 0.0]\n'),
    "a gate": (BLOCK + SOIL, '\n[boundary.side]\nline_m = [[0.08, 0.0], [0.08, 0.16]]\ntype = "roller"\nuntil_s = 0.002\n'),
    "a frictional wall": (BLOCK + SOIL, '\n[boundary.side]\nline_m = [[0.0, 0.0], [0.0, 0.16]]\ntype = "frictional"\nfriction = 0.3\n'),
    "excavation": (HALVES.format("taken") + SOIL + SOIL.replace("soil", "taken") + "removed_s = 0.002\n", ""),
    "softening": (BLOCK + SOIL + "friction_residual_deg = 20.0\ncohesion_residual_pa = 100.0\nsoftening_shape = 10.0\n", ""),
    "a drained load": (BLOCK + SOIL, '\n[boundary.load]\nline_m = [[0.0, 0.08], [0.08, 0.08]]\ntype = "traction"\ntraction_pa = [0.0, -500.0]\ndrained = true\n'),
    "sides that are tied": (BLOCK + SOIL, '\n[boundary.side]\nline_m = [[0.0, 0.0], [0.0, 0.16]]\ntype = "tied"\nacross_m = [0.08, 0.0]\n'),
}


def case_text(shape, transfer, update, locking, pressure, beside):
    material, more = BESIDE[beside]
    water = "" if "[water]" in more else "\n[water]\nbulk_modulus_pa = 1e8\n"
    return f"""name = "{beside}"

[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.14, 0.16]]
{material}{water}
[mpm]
shape = "{shape}"
transfer = "{transfer}"
stress_update = "{update}"
locking = "{locking}"
pressure = "{pressure}"
initial_equilibrium = false
energy_limit = 1e9
end_at_rest = false
end_s = 0.005
output_rate_hz = 800.0

[boundary.base]
line_m = [[0.0, 0.0], [0.14, 0.0]]
type = "fixed"
{more}"""


def faults_of(record):
    with h5py.File(record) as file:
        motion, energy = file["motion/mpm"], {name: file["energy"][name][:].astype("f8") for name in file["energy"]}
        followed = motion["status"][:] == 1
        if any(not np.isfinite(motion[name][:][followed]).all() for name in ("u", "v", "stress", "F", "pressure", "porosity", "water_flow")):
            return "a value is not finite", 0
        if not all(np.isfinite(values).all() for values in energy.values()):
            return "an energy is not finite", 0
        lost = np.abs(energy["water_mass"] - energy["water_mass"][0] - energy["water_inflow"]).max() / energy["water_mass"].max()
        stored = energy["kinetic"] + energy["elastic"] + energy["water"]
        turned_over = np.maximum.accumulate(stored[0] + np.abs(energy["external"]) + energy["plastic"] + energy["darcy"] + np.abs(energy["damping"]))
        gained = (energy["residual"] / np.maximum(turned_over, 1e-6)).max()
        moved = np.abs(motion["u"][:][followed]).max()
        if lost > 1e-9:
            return f"water from nothing: {lost:.3g} of it", gained
        if gained > 0.5:  # (loads, walls and gates act at once: that leaves a residual, docs/limits.md)
            return f"energy from nothing: {gained:.3g} of what was turned over", gained
        if moved > 0.02:
            return f"moved by {moved:.3g} m in {motion['time'][-1]:.3g} s", gained
        return "", gained


# (That the others are refused, dry or wet, is tested elsewhere.)
def exists(shape, transfer, update, locking):
    return (transfer != "xpic" or update == "usl") and (shape == "bilinear" or locking in ("none", "fbar"))


def main():
    program, each = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1
    scratch = folder()
    cases = [case for case in itertools.product(SHAPES, TRANSFERS, UPDATES, LOCKING, PRESSURES, BESIDE) if exists(*case[:4])][::each]

    def attempt(number):
        case = cases[number]
        there = scratch / str(number)
        there.mkdir()
        (there / "case.toml").write_text(case_text(*case))
        done = run(program, "simulate", there, "--out", there / "out", "--threads", "1", "--quiet")
        name = ", ".join(case)
        errors = [line for line in done.stderr.splitlines() if line.startswith("pivnp: error:")]
        wrong, gained, outcome = "", 0.0, "ran"
        if done.returncode == 0:
            wrong, gained = faults_of(there / "out" / "record.h5")
        elif done.returncode == 2 and len(errors) == 1 and re.search(r"\b(mpm|water|boundary|contact|body|material)\.[a-z_.]+: ", errors[0]):
            outcome = "refused: " + re.sub(r".*?((mpm|water|boundary|contact|body|material)\.)", r"\1", errors[0])
        else:
            wrong = f"exit {done.returncode}: {done.stderr.strip()[-300:]}"
        shutil.rmtree(there)
        return name, outcome, gained, wrong

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(attempt, range(len(cases))))
    for outcome, count in sorted(collections.Counter(outcome for _, outcome, _, _ in results).items()):
        print(f"{count:5} {outcome}")
    gained = sorted(((g, name) for name, _, g, _ in results), reverse=True)
    print("greatest gains of energy, over what was turned over:", *(f"{g:.3g} ({name})" for g, name in gained[:8]), sep="\n  ")
    faults = [f"{name}: {wrong}" for name, _, _, wrong in results if wrong]
    print(f"{len(results)} cases, {len(faults)} faults")
    if sum(outcome == "ran" for _, outcome, _, _ in results) < 0.3 * len(results):
        faults.append("too few cases were run")
    if faults:
        sys.exit("\n".join(faults))


main()
