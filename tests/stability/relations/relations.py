#!/usr/bin/python3
"""Relations that hold on any scene: random scenes (scenes.py), each run beside a partner that must give the same, or nearly.

usage: relations.py PIVNP COUNT [FIRST] [--all] [--only RELATION] [--jobs N] [--keep]

COUNT scenes from seed FIRST (1) on take the relations in turn. A violation prints relation, seed, scene, measured value and bound, and
keeps both cases; the exit code is then 1. A table of all relations ends the output (PIVNP_VERIFICATION_DIR: a row of each for
docs/verification.md).
--all: scenes as well in which a relation is known not to hold (`known`); these are counted apart.
--keep: keeps the cases of every scene.

A new relation: its bound and the reason for it in BOUNDS, one function (scene, simulate) -> measured value, and its row in RELATIONS.
"""
import argparse
import collections
import concurrent.futures
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from program import CpuLimit, folder, run as run_program  # noqa: E402

import scenes  # noqa: E402
from cases import HEIGHTS, Map, changed, sections, toml  # noqa: E402
from runs import Run, block_by_block, blocks, paired, point_by_point  # noqa: E402

# Differences of points are over the greatest displacement, stress, pressure, and over 1 of F; those of blocks (means of 2 x 2 cells) are
# root mean squares over all times, over that of the displacement. N: rows of cells over the height, 5 to 10.
ROUND_OFF = 2e-6
IN_CONTACT = 1e-3  # in place of it between bodies: the normal is searched for in steps, and ties are decided by round-off
BOUNDS = {
    "threads": (0.0, "the same bits"),
    "checkpoint": (0.0, "the same bits"),
    "similarity": (ROUND_OFF, "records have 24 bits"),
    "moved": (ROUND_OFF, "records have 24 bits"),
    "turned": (ROUND_OFF, "records have 24 bits"),
    "mirrored": (ROUND_OFF, "records have 24 bits"),
    "units": (ROUND_OFF, "records have 24 bits"),
    "region in two": (ROUND_OFF, "records have 24 bits"),
    "load in two": (ROUND_OFF, "records have 24 bits"),
    "idle physics": (ROUND_OFF, "records have 24 bits"),
    "beyond reach": (ROUND_OFF, "records have 24 bits"),
    "output times": (0.01, "steps are trimmed to end on them: as another step"),
    "step": (0.02, "half the step; second order in the step, about 1/N of a wave's period"),
    "rest": (0.02, "equilibrium to 1e-3 of the force, twice that in motion, tenfold at single points; over rho g H^2/E"),
    "grid": (0.05, "half of the first order, 1/N"),
    "points": (0.05, "9 for 4 a cell: bending differs by 5 % (limits.md)"),
    "cells": (0.75, "difference of h/2 and h/4 over that of h and h/2, or 0.02 if that is less: an order of 0.4 at least"),
    "border": (1.0, "half a cell is half of a whole one, but for 1/N^2 and the square of the change c: over 0.02 + c^2/4"),
    "wall as body": (0.10, "contact is of first order in the cell, 1/N"),
    "weight as load": (0.03, "a third of the first order at one face, 1/N"),
    "stiffness": (0.10, "E x 4 where the motion is plastic"),
}
# A scene is chaotic, and says nothing about round-off, if its own answer to so little more gravity passes that bound.
LEAST = (1e-14, 1e-12)


class Ended(Exception):
    """A run that did not come to its end."""



# --- the relations -------------------------------------------------------------------------------------------------------------------
def threads(scene, simulate):
    return point_by_point(simulate(scene.case), simulate(scene.case, threads=3), scene.h)


def checkpoint(scene, simulate):
    """Killed when its first segment (64 states) is closed, and resumed."""
    mpm = scene.case["mpm"]
    case = changed(scene.case, {"mpm": {"output_rate_hz": 160 / mpm["end_s"]}})
    return point_by_point(simulate(case), simulate(case, interrupted=True), scene.h)


def mapped(scene, simulate, **how):
    by = Map(**how)
    return point_by_point(simulate(scene.case), by.back(simulate(by.of_case(scene.case))), scene.h)


def similarity(scene, simulate):
    return mapped(scene, simulate, scale=scene.dice.one_of([1e-3, 7.0, 1e3]))


def moved(scene, simulate):
    return mapped(scene, simulate, shift=[scene.height * scene.dice.between(-5, 5) for _ in (0, 1)])


def turned(scene, simulate):
    return mapped(scene, simulate, quarter_turns=scene.dice.one_of([1, 2, 3]))


def mirrored(scene, simulate):
    return mapped(scene, simulate, mirror=True)


def units(scene, simulate):
    """Lengths in another unit, named. What else has a length in its unit stays in SI units."""
    unit, per_metre = scene.dice.one_of([("mm", 1000.0), ("cm", 100.0), ("km", 0.001)])
    by = Map(scale=per_metre)
    lengths = by.of_case(scene.case)
    in_lengths = ("line_m", "polygon_m", "area_m", "circle_m", "spacing_m", "softening_length_m", *HEIGHTS)
    other = {title: {key: lengths[title][key] if key in in_lengths else value for key, value in entries.items()}
             for title, entries in scene.case.items()}
    if "level_history" in other.get("water", {}):
        other["water"]["level_history"] = [[t, per_metre * y] for t, y in scene.case["water"]["level_history"]]
    found = simulate({**other, "camera": {"length_unit": unit}})
    found.x0, found.u = found.x0 / per_metre, found.u / per_metre
    return point_by_point(simulate(scene.case), found, scene.h)


def region_in_two(scene, simulate):
    region = scene.dice.one_of(sections(scene.case, "region"))
    outline = scene.case[region]["polygon_m"]
    axis = scene.dice.one_of([0, 1])
    low, high = min(p[axis] for p in outline), max(p[axis] for p in outline)
    at = low + 0.5137 * (high - low)
    name = region.split(".")[1]
    changes = {region: {"polygon_m": cut(outline, axis, at, 1)},
               "region.other_half": {"polygon_m": cut(outline, axis, at, -1), "material": name}}
    for title in sections(scene.case, "contact"):
        if name in scene.case[title]["regions"]:
            changes[title] = {"regions": scene.case[title]["regions"] + ["other_half"]}
    return point_by_point(simulate(scene.case), simulate(changed(scene.case, changes)), scene.h)


def cut(outline, axis, at, sense):
    """What of a polygon lies to one side."""
    kept = []
    for p, q in zip(outline, outline[1:] + outline[:1]):
        before, after = sense * (at - p[axis]), sense * (at - q[axis])
        if before >= 0:
            kept.append(p)
        if before * after < 0:
            share = before / (before - after)
            kept.append([p[k] + share * (q[k] - p[k]) for k in (0, 1)])
    return kept


def load_in_two(scene, simulate):
    load = scene.case["boundary.load"]
    x, y = load["traction_pa"]
    share = scene.dice.between(0.2, 0.8)
    other = changed(scene.case, {"boundary.load": {"traction_pa": [share * x, share * y]},
                                 "boundary.rest_of_load": {**load, "traction_pa": [x - share * x, y - share * y]}})
    return point_by_point(simulate(scene.case), simulate(other), scene.h)


def widened(case, right, h):
    """The grid with more room on its right."""
    (x, y), (x2, y2) = case["grid"]["area_m"]
    return {"grid": {"area_m": [[x, y], [x2 + right * h, y2]]}}


def idle_physics(scene, simulate):
    """Something is named that cannot matter."""
    case, h = changed(scene.case, {"mpm": {"courant": 0.4}}), scene.h
    never = 10 * case["mpm"]["end_s"]
    (x, y), (x2, y2) = case["grid"]["area_m"]
    every = sections(case, "material")
    models = {case[m]["model"] for m in every}
    choices = {"room": {}, "wall": {"boundary.far": {"line_m": [[x2 + 6 * h, y], [x2 + 6 * h, y2]], "type": "roller"}},
               "body": {"body.far": {"circle_m": [x2 + 8 * h, y + 3 * h, 2 * h], "velocity_m_s": [0.0, 0.0]}},
               "gravity": {"mpm": {"gravity_from_m_s2": case["mpm"]["gravity_m_s2"], "gravity_ramp_s": never / 20}},
               "excavation": {m: {"removed_s": never} for m in every}}
    if "gravity_ramp_s" in case["mpm"]:
        del choices["gravity"]
    if scene.walls:
        choices["gate"] = {scene.walls[0]: {"until_s": never}} if "until_s" not in case[scene.walls[0]] else {}
    if "wet" not in scene.traits:
        choices["density"] = {m: {"density_end_kg_m3": case[m]["density_kg_m3"], "density_until_s": never / 20} for m in every}
        if models <= set(scenes.SOILS):
            choices["pores"] = {"water": {"density_kg_m3": 1e-6, "bulk_modulus_pa": 1e6}} | {
                m: {"density_kg_m3": None, "porosity": 0.375, "grain_density_kg_m3": case[m]["density_kg_m3"] / 0.625,
                    "permeability_m_s": 1e-3, "drained": True} for m in every}
    if not models & {"linear_elastic", "neo_hookean", "water"}:
        choices["strength"] = {m: {"reduction_factor": 1.0, "reduction_from_s": 0.0, "reduction_until_s": never / 20} for m in every}
    what = scene.dice.one_of(sorted(choices))
    scene.note = what
    return point_by_point(simulate(case), simulate(changed(changed(case, widened(case, 12, h)), choices[what])), h)


def beyond_reach(scene, simulate):
    """A low block on a base of its own, too far away to touch anything and too slow to ask for other steps."""
    case, h = changed(scene.case, {"mpm": {"courant": 0.4}}), scene.h
    x, y = case["grid"]["area_m"][1][0] + 6 * h, case["grid"]["area_m"][0][1] + 3 * h
    of = [case[m] for m in sections(case, "material")]
    stiffest = min(m.get("young_pa", m.get("bulk_pa")) for m in of)
    other = changed(changed(case, widened(case, 16, h)), {
        "region.far": {"polygon_m": [[x, y], [x + 3 * h, y], [x + 3 * h, y + h], [x, y + h]]},
        "material.far": {"model": "linear_elastic", "young_pa": 0.5 * stiffest, "poisson": 0.0,
                         "density_kg_m3": max(m.get("density_kg_m3", 0) for m in of)},
        "boundary.far": {"line_m": [[x - 2 * h, y], [x + 5 * h, y]], "type": "fixed"}})
    return point_by_point(simulate(case), simulate(other), h)


def output_times(scene, simulate):
    other = simulate(changed(scene.case, {"mpm": {"output_rate_hz": 3 * scene.case["mpm"]["output_rate_hz"]}}))
    return block_by_block(simulate(scene.case), other.at_times(slice(0, None, 3)), scene.h)


def step(scene, simulate):
    return block_by_block(*(simulate(changed(scene.case, {"mpm": {"courant": c}})) for c in (0.4, 0.2)), scene.h)


def rest(scene, simulate):
    run, of = simulate(scene.case), [scene.case[m] for m in sections(scene.case, "material")]
    settlement = 2000 * 9.81 * scene.height**2 / min(m["young_pa"] for m in of)
    return np.abs(run.u).max() / settlement


def grid(scene, simulate):
    """The grid alone is moved."""
    by = [scene.h * scene.dice.between(0.1, 0.9) for _ in (0, 1)]
    area = [[p[k] + by[k] for k in (0, 1)] for p in scene.case["grid"]["area_m"]]
    return block_by_block(simulate(scene.case), simulate(changed(scene.case, {"grid": {"area_m": area}})), scene.h)


def points(scene, simulate):
    return block_by_block(*(simulate(changed(scene.case, {"mpm": {"per_element": n}})) for n in (4, 9)), scene.h)


def cells(scene, simulate):
    def run(n):
        return simulate(changed(scene.case, {"grid": {"spacing_m": scene.h / n}, "mpm": {"per_element": 4}}))
    coarse, middle, fine = map(run, (1, 2, 4))
    return block_by_block(middle, fine, scene.h) / max(block_by_block(coarse, middle, scene.h), 0.02)


def border(scene, simulate):
    """The border of the lowest two layers is moved by half a cell, and by a whole one."""
    names = sections(scene.case, "region")[:2]

    def run(by):
        lower, upper = ([list(p) for p in scene.case[name]["polygon_m"]] for name in names)
        for corner, rise in ((lower[2], by), (lower[3], by), (upper[0], by), (upper[1], by)):
            corner[1] += rise * scene.h
        return simulate(changed(scene.case, dict(zip(names, ({"polygon_m": lower}, {"polygon_m": upper}))) |
                                {"mpm": {"per_element": 4}}))  # (one row of points is passed each time)
    none, half, whole = (blocks(run(by), scene.h) for by in (0.0, 0.5, 1.0))
    middle = (none[2] + whole[2]) / 2

    def over_all(difference):
        return float(np.sqrt((difference**2).sum() / (middle**2).sum()))
    return over_all(half[2] - middle) / (0.02 + over_all(whole[2] - none[2])**2 / 4)


def wall_as_body(scene, simulate):
    """A frictional base, and a body at rest below the same line."""
    base, h = scene.case["boundary.base"], scene.h
    (x, y), (x2, _) = base["line_m"]
    body = {"polygon_m": [[x, y - 2.5 * h], [x2, y - 2.5 * h], [x2, y], [x, y]], "velocity_m_s": [0.0, 0.0], "friction": base["friction"]}
    other = changed(scene.case, {"boundary.base": None, "body.base": body})
    return block_by_block(simulate(scene.case), simulate(other), h)


def weight_as_load(scene, simulate):
    """A confined column that comes to rest (damped) under a traction, and under a free body of that weight."""
    (left, y), (right, _) = scene.case["boundary.load"]["line_m"]
    pressure = -scene.case["boundary.load"]["traction_pa"][1]
    slow = 3 * scene.case["mpm"]["end_s"]
    case = changed(scene.case, {"mpm": {"damping": 0.4, "end_s": slow, "output_rate_hz": 1 / slow, "gravity_m_s2": [0.0, -9.81]},
                                "boundary.load": {"rise_s": 0.0}, "boundary.left": {"type": "roller", "friction": None},
                                "boundary.right": {"type": "roller", "friction": None}})
    side = right - left
    body = {"polygon_m": [[left, y], [right, y], [right, y + 3 * scene.h], [left, y + 3 * scene.h]], "friction": 0.0,
            "mass_kg_m": pressure * side / 9.81, "turns": False}
    one, two = simulate(case), simulate(changed(case, {"boundary.load": None, "body.weight": body}))
    last = slice(-1, None)
    return block_by_block(one.at_times(last), two.at_times(last), scene.h)


def stiffness(scene, simulate):
    stiffer = {m: {"young_pa": 4 * scene.case[m]["young_pa"]} for m in sections(scene.case, "material")}
    return block_by_block(simulate(scene.case), simulate(changed(scene.case, stiffer)), scene.h)


# --- where they apply ----------------------------------------------------------------------------------------------------------------
def any_scene(scene):
    return True


def no_level(scene):
    return "level" not in scene.traits


def no_start(scene):
    """Regions without an initial motion of their own, which a spin about their own centre would be."""
    return scene.kind != "flight"


def loaded(scene):
    return "load" in scene.traits


def dry(scene):
    return "wet" not in scene.traits


def no_search(scene):
    """Neither a search for equilibrium, whose end is one number of all points, nor water, whose steps are those of all points."""
    return dry(scene) and "equilibrium" not in scene.traits


def smooth(scene):
    """Motion that a refined mesh must converge to: elastic, dry, without contact and tools that hit; bilinear functions with FLIP and
    MUSL alone (docs/limits.md)."""
    mpm = scene.case["mpm"]
    stable = mpm.get("shape") != "bilinear" or (mpm["transfer"], mpm["stress_update"]) == ("flip", "musl")
    unsteady = {"yields", "contact", "body", "equilibrium", "meeting"}
    return dry(scene) and stable and not scene.traits & unsteady and "boundary.gate" not in scene.case


def at_rest(scene):
    return ("equilibrium" in scene.traits and dry(scene) and not scene.traits & {"body", "load", "contact"}
            and scene.case["mpm"]["gravity_m_s2"][0] == 0 and "gravity_ramp_s" not in scene.case["mpm"] and ("yields" not in scene.traits or scene.kind == "box"))


def layered(scene):
    return smooth(scene) and "layers" in scene.traits and "dip" not in scene.traits and scene.kind == "box"


def frictional_base(scene):
    return (dry(scene) and not scene.traits & {"contact", "body", "equilibrium", "yields"} and scene.kind in ("heap", "column", "box")
            and scene.case["boundary.base"]["type"] == "frictional" and scene.case["mpm"].get("scheme") != "geopart")


def pressed_box(scene):
    return loaded(scene) and scene.kind == "box" and not scene.traits & {"yields", "wet", "dip", "layers"}


def collapses(scene):
    return (scene.kind in ("column", "slope", "heap") and "yields" in scene.traits and dry(scene)
            and not scene.traits & {"body", "contact"}
            and all("young_pa" in scene.case[m] for m in sections(scene.case, "material")))


def never(scene):
    return ""


def off_lines(scene):
    """The row at a wall with 9 points a cell, and bodies, between lines."""
    return "walls between grid lines" if scene.traits & {"between lines", "inclined"} else ""


def bad_wall(scene):
    """Inclined, or of nodes that stay in the lattice wherever it lies."""
    mpm = scene.case["mpm"]
    return "inclined" in scene.traits or mpm.get("shape") == "bilinear" or mpm.get("scheme") == "geopart"


def walls_between_lines(scene):
    return "free faces between grid lines" if scene.walls else ""


def between_lines(scene):
    return "walls between grid lines" if scene.traits & {"between lines", "inclined"} and bad_wall(scene) else ""


def with_body_or_slope(scene):
    if "inclined" in scene.traits:
        return "walls between grid lines"
    return "the pieces of a body, in their order" if "body" in scene.traits else ""


def joined(scene):
    return "bodies in contact are weighed as a whole" if "contact" in scene.traits else ""


def under_load(scene):
    return "loads end at the border of a region" if loaded(scene) else ""


# Known faults, by scene: such scenes are drawn with --all only, and counted apart. When one is mended its word goes.
RELATIONS = {
    "threads": (threads, any_scene, never), "checkpoint": (checkpoint, any_scene, never),
    "similarity": (similarity, any_scene, never), "moved": (moved, any_scene, never), "turned": (turned, no_level, with_body_or_slope),
    "mirrored": (mirrored, any_scene, with_body_or_slope), "units": (units, any_scene, lambda scene: "units of lengths"),
    "region in two": (region_in_two, no_start, under_load), "load in two": (load_in_two, loaded, never),
    "idle physics": (idle_physics, any_scene, never), "beyond reach": (beyond_reach, no_search, joined),
    "output times": (output_times, smooth, between_lines), "step": (step, smooth, between_lines), "rest": (rest, at_rest, between_lines),
    "grid": (grid, smooth, walls_between_lines), "points": (points, smooth, off_lines), "cells": (cells, smooth, between_lines),
    "border": (border, layered, lambda scene: "borders inside a cell"), "wall as body": (wall_as_body, frictional_base, off_lines),
    "weight as load": (weight_as_load, pressed_box, off_lines),
    "stiffness": (stiffness, collapses, lambda scene: "run-out by step, cells and stiffness"),
}


# --- running them --------------------------------------------------------------------------------------------------------------------
class Simulation:
    """Runs cases in a folder of their own, each once."""

    def __init__(self, program, there):
        self.program, self.there, self.done = program, there, {}

    def __call__(self, case, threads=1, interrupted=False):
        key = (toml(case), threads, interrupted)
        if key not in self.done:
            there = self.there / ("scene" if not self.done else f"partner{len(self.done)}")
            there.mkdir(parents=True)
            (there / "case.toml").write_text(key[0])
            self.done[key] = self._run(there, threads, interrupted)
        if isinstance(self.done[key], Ended):
            raise self.done[key]
        return self.done[key]

    def _run(self, there, threads, interrupted):
        arguments = ["simulate", there, "--out", there / "out", "--threads", threads, "--quiet", "--no-report"]
        if interrupted:
            self._kill_after_a_segment(arguments, there / "out" / "parts")
            arguments.append("--resume")
        done = run_program(self.program, *arguments, timeout=3600, preexec_fn=CpuLimit(120))
        if done.returncode != 0:
            return Ended(f"exit {done.returncode}: {done.stderr.strip()[-300:]}")
        found = Run(there / "out" / "record.h5")
        shutil.rmtree(there / "out")
        return found

    def _kill_after_a_segment(self, arguments, parts):
        process = subprocess.Popen([self.program, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and not list(parts.glob("*.00000000.h5")):
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        process.wait()


def chaotic(scene, simulate, bound):
    def answer(by):
        gravity = [(1 + by) * g for g in scene.case["mpm"]["gravity_m_s2"]]
        return point_by_point(simulate(scene.case), simulate(changed(scene.case, {"mpm": {"gravity_m_s2": gravity}})), scene.h)
    try:
        return any(answer(by) > bound for by in LEAST)
    except Ended:
        return True


def scene_for(name, seed, all_of_them):
    """The first scene to which the relation applies; so no relation is short of scenes."""
    _, applies, known = RELATIONS[name]
    for n in range(10000):
        scene = scenes.Scene(1000003 * n + seed)
        if applies(scene) and (all_of_them or not known(scene)):
            return scene
    return None


def attempt(program, scratch, name, seed, all_of_them, keep):
    scene = scene_for(name, seed, all_of_them)
    if scene is None:
        return name, "none", 0.0, ""
    function, _, known = RELATIONS[name]
    bound = BOUNDS[name][0]
    exact = bound == ROUND_OFF
    if exact and "contact" in scene.traits:
        bound = IN_CONTACT
    there = scratch / f"{name.replace(' ', '_')}_{seed}"
    simulate = Simulation(program, there)
    what = f"{name}, seed {seed}: {scene.case['']['name']}, {', '.join(sorted(scene.traits))}"
    try:
        simulate(scene.case)
    except Ended as ended:
        outcome = "ended" if re.search(r"mpm: at t|initial equilibrium|mpm\.initial_equilibrium", str(ended)) else "refused"
        if keep or outcome == "refused":
            print(f"{outcome}: {what}: {ended} {there}", flush=True)
        return name, outcome, 0.0, ""
    try:
        measured, why = function(scene, simulate), ""
    except Ended as ended:
        measured, why = math.inf, f" the partner: {ended}"
    what += f", {scene.note}" if hasattr(scene, "note") else ""
    if measured > bound and exact and not known(scene) and chaotic(scene, simulate, bound):
        return name, "chaotic", 0.0, ""
    if measured <= bound:
        if not keep:
            shutil.rmtree(there)
        return name, "held", measured, ""
    word = known(scene)
    return name, f"known: {word}" if word else "violated", measured, f"{what}: {measured:.3g}, bound {bound:g}.{why} {there}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], usage=__doc__.split("usage: ")[1].splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=1)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", action="append")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", action="store_true")
    options = parser.parse_args()
    drawn = options.only or [name for name in RELATIONS if options.all or scene_for(name, options.first, False)]
    scratch = folder()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = []
        for result in pool.map(lambda n: attempt(options.program, scratch, drawn[n % len(drawn)], options.first + n, options.all, options.keep),
                               range(options.count)):
            results.append(result)
            if result[3]:
                print(f"{result[1]}: {result[3]}", flush=True)
    rows = []
    print(f"{'relation':16} scenes ended chaotic known violated   worst   bound")
    for name in drawn:
        of = [(outcome, measured) for n, outcome, measured, _ in results if n == name]
        count = collections.Counter(outcome.split(":")[0] for outcome, _ in of)
        compared = [measured for outcome, measured in of if outcome in ("held", "violated")]
        worst = max(compared, default=0.0)
        print(f"{name:16} {len(of):6} {count['ended'] + count['refused']:5} {count['chaotic']:7} {count['known']:5} {count['violated']:8} {worst:7.2g} {BOUNDS[name][0]:7.2g}")
        rows.append((f"relation on random scenes: {name}", f"{BOUNDS[name][0]:g}: {BOUNDS[name][1]}",
                     f"{len(compared)} scenes, {count['violated']} violations, worst {worst:.2g}; {count['known']} of known faults"
                     f", {count['chaotic']} chaotic, {count['ended'] + count['refused']} ended", "relations.py"))
    if into := os.environ.get("PIVNP_VERIFICATION_DIR"):
        (pathlib.Path(into) / "relations.tsv").write_text("".join("\t".join(row) + "\n" for row in rows))
    if sum(outcome in ("held", "violated", "chaotic") or outcome.startswith("known") for _, outcome, _, _ in results) < 0.6 * len(results):
        sys.exit("too few scenes came to their end")
    if any(outcome == "violated" for _, outcome, _, _ in results):
        sys.exit(f"violations; both cases of each are below {scratch}")
    shutil.rmtree(scratch)


if __name__ == "__main__":
    main()
