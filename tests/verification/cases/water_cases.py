"""The data sets with water, in small: coarser cells, and as the case is otherwise.

usage: water_cases.py PIVNP SOURCE
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
scratch = pathlib.Path(tempfile.mkdtemp(prefix="pivnp-test-"))


class Run:
    """A case simulated with some keys changed."""
    def __init__(self, case, *changes, without=None, file="case.toml"):
        text = (source / "datasets" / case / file).read_text()
        if without:
            assert without in text, without
            text = text.replace(without, "")
        folder = scratch / f"{case}{len(list(scratch.iterdir()))}"
        folder.mkdir()
        (folder / "case.toml").write_text(text)
        options = [part for change in changes for part in ("--set", change)]
        done = subprocess.run([program, "simulate", folder, "--out", folder / "out", "--threads", "1", "--quiet", *options], capture_output=True,
                              text=True, stdin=subprocess.DEVNULL, timeout=600)
        assert done.returncode == 0, done.stderr
        with h5py.File(folder / "out" / "record.h5") as record:
            motion, energy = record["motion/mpm"], record["energy"]
            self.time = motion["time"][:]
            self.x0, self.u, self.pressure = motion["x0"][:], motion["u"][:], motion["pressure"][:].astype("f8")
            self.moved = np.linalg.norm(self.u.astype("f8"), axis=2).max(axis=1)
            of = {name: energy[name][:] for name in energy}
        turned_over = np.abs(of["external"]).max() + (of["kinetic"] + of["elastic"] + of["water"])[0]
        self.residual = of["residual"].max() / turned_over
        self.came_in = of["water_inflow"][-1]
        self.lost = np.abs(of["water_mass"] - of["water_mass"][0] - of["water_inflow"]).max() / of["water_mass"].max()

    def at(self, time):
        return int(np.argmin(np.abs(self.time - time)))


def check(what, value, low, high):
    print(f"{what}: {value:.4g}, expected {low:.4g} to {high:.4g}")
    assert low <= value <= high, what


column = Run("terzaghi", "grid.spacing_m=0.02", "mpm.end_s=0.5", "mpm.output_rate_hz=100")
base = column.x0[:, 1] < 0.02
# T = c_v t/H^2 = 1.018 t. At the base, T .3: p/p0 = .607.
check("terzaghi, base at T = .3, Pa", column.pressure[column.at(0.3 / 1.018), base].mean(), 5900, 6200)
check("terzaghi, water lost", column.lost, 0, 1e-9)

under = Run("submerged_slope", "grid.spacing_m=0.25", "mpm.end_s=2")
check("submerged_slope, at rest before its strength falls, m", under.moved[under.at(0.2)], 0, 2e-4)
check("submerged_slope, after it, m", under.moved[-1], 0.03, 2)
check("submerged_slope, energy from nothing", under.residual, -1, 0.01)
check("submerged_slope, water lost", under.lost, 0, 1e-9)

rises = Run("rising_water", "grid.spacing_m=0.05")
check("rising_water, at 1 s, m", rises.moved[rises.at(1)], 0, 1e-3)
check("rising_water, at the end, m", rises.moved[-1], 0.01, 0.5)
check("rising_water, energy from nothing", rises.residual, -1, 0.01)
check("rising_water, water lost", rises.lost, 0, 1e-9)
toe = Run("rising_water", "grid.spacing_m=0.05", without="water_level_m = 0.46\n")
check("rising_water, at the toe alone, m", toe.moved[-1], 0, 2e-3)

# Gravity rises until .65 s, then water enters through the base, and the soil behind its front collapses.
COARSE = ("grid.spacing_px=48", "np.per_element=4")
wetted = Run("centrifuge_slope", *COARSE, file="wetting.toml")
crest = wetted.x0[:, 1] > 0.06


def sunk(run, start, end):
    return float(run.u[run.at(start), crest, 1].mean() - run.u[run.at(end), crest, 1].mean())


depth = 0.0868 - (wetted.x0[:, 1] + wetted.u[-1, :, 1])
hydrostatic = 1000 * 490.5 * depth
check("wetting, pressure while it is dry, Pa", np.abs(wetted.pressure[: wetted.at(0.65) + 1]).max(), 0, 1e-9)
check("wetting, share of wet points at the end", (wetted.pressure[-1] > 0).mean(), 0.99, 1)
check("wetting, pressure over that of the water outside", np.abs(wetted.pressure[-1] - hydrostatic).max() / hydrostatic.max(), 0, 0.05)
check("wetting, crest under its weight, m", sunk(wetted, 0, 0.65), 1.2e-3, 1.7e-3)
check("wetting, crest as water enters, m", sunk(wetted, 0.65, 1.3), 1.6e-3, 2.3e-3)
check("wetting, water that came in, kg/m", wetted.came_in, 2.7, 3.2)
check("wetting, water lost", wetted.lost, 0, 1e-9)
lifted = Run("centrifuge_slope", *COARSE, file="wetting.toml", without="wetting_collapse = 0.112")
check("wetting, crest as water enters soil that does not collapse, m", sunk(lifted, 0.65, 1.3), -1e-3, 0)
