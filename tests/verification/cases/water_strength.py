"""Water and strength: a vertical cut in soil of a shear strength, which is reduced; then it is held until the cut is at rest.

1. Under a lake: sigma' of the saturated skeleton is that of dry soil of the weight rho - rho_w (exactly, whatever the geometry). Criterion: the
   crest settles by what it settles by dry, on the same mesh, with strengths within 2 %: that is the error of the factor of safety.
2. The lake falls at once, and nothing drains: the whole weight, the same strength. Criterion: the crest settles by more than that of dry soil
   of the same weight and Poisson's ratio .499, and by less than with .3, between which its stiffness lies (undrained .4993; .3 at the start).
3. The same where the skeleton has .495, so that stiffness does not change as the lake falls. Criterion: as in 1, within 2 % of dry soil of .495;
   what of the pressure alternates from cell to cell is below 3 % of its mean.
4. A slope of 1 in 1.5 with friction and cohesion (phi 25 degrees), under a lake, drained: as in 1.
5. The same with water that flows. Consolidation asks for steps fifty times as short, and APIC takes energy out in each step; the slope is
   still moving when its strength has gone, and comes to rest the sooner. So the soil moves by FLIP, in which steps count for little, dry and
   wet, explicit and (left out) projected. Criterion: as in 1.

usage: water_strength.py PIVNP [--small]   (--small: the first, on coarse cells)
"""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

program, small = sys.argv[1], "--small" in sys.argv
scratch = pathlib.Path(tempfile.mkdtemp(prefix="pivnp-test-"))
POROSITY, HEIGHT = 0.4, 1.0
SATURATED = (1 - POROSITY) * 2650 + POROSITY * 1000
BUOYANT = SATURATED - 1000
CELLS, END = (6, 5) if small else (10, 8)


def settled(density, reduction, *, poisson=0.3, water=None, slope=False, mpm=""):
    """Of the crest, as strength falls: m. `density`: by whose weight strength and stiffness are measured."""
    there = scratch / str(len(list(scratch.iterdir())))
    there.mkdir()
    soil = f"porosity = {POROSITY}\ngrain_density_kg_m3 = 2650.0\npermeability_m_s = {water[1]}" if water else f"density_kg_m3 = {density}"
    outline = "[2.0, 0.0], [2.0, 1.0]" if not slope else "[2.9, 0.0], [1.4, 1.0]"
    law = f"""model = "tresca"
shear_strength_pa = {1.1 * density * 9.81 * HEIGHT / 3.8}""" if not slope else f"""model = "mohr_coulomb"
friction_deg = 25.0
cohesion_pa = {0.035 * density * 9.81 * HEIGHT}"""
    (there / "case.toml").write_text(f"""name = "vertical cut"
[grid]
spacing_m = {HEIGHT / CELLS}
area_m = [[0.0, 0.0], [3.4, 1.4]]
[region.soil]
polygon_m = [[0.0, 0.0], {outline}, [0.0, 1.0]]
[material.soil]
{law}
young_pa = {1e6 * density / SATURATED}
poisson = {poisson}
reduction_factor = {reduction}
reduction_from_s = 0.3
reduction_until_s = 1.0
{soil}
{water[0] if water else ""}
[mpm]
{mpm}
damping = 0.3
end_s = {END}
output_rate_hz = 20.0
initial_equilibrium = true
end_at_rest = false
[boundary.base]
line_m = [[0.0, 0.0], [3.4, 0.0]]
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 1.4]]
type = "roller"
""")
    done = subprocess.run([program, "simulate", there, "--out", there / "out", "--threads", "1", "--quiet"], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL, timeout=1200)
    assert done.returncode == 0, done.stderr
    with h5py.File(there / "out" / "record.h5") as record:
        motion = record["motion/mpm"]
        x0, u, time = motion["x0"][:], motion["u"][:], motion["time"][:]
        if water:
            settled.alternating = alternating(x0, motion["pressure"][-1].astype("f8"))
    crest = (x0[:, 1] > 0.85) & (x0[:, 0] > (1.0 if slope else 1.7))
    down = -u[:, crest, 1].astype("f8").mean(axis=1)
    return down[-1] - down[np.searchsorted(time, 0.29)]


def alternating(x0, pressure):
    """What alternates from cell to cell along both axes over the mean, of cells that were, with those around, inside the material."""
    h = HEIGHT / CELLS
    at = np.floor(x0 / h + 1e-9).astype(int)
    sums, n = np.zeros((2, at[:, 0].max() + 1, at[:, 1].max() + 1))
    np.add.at(sums, (at[:, 0], at[:, 1]), pressure)
    np.add.at(n, (at[:, 0], at[:, 1]), 1)
    p = sums / np.where(n > 0, n, np.nan)
    # (1, -2, 1)/4 along each, which linear and quadratic fields leave at zero.
    along = 0.25 * (p[:-2] - 2 * p[1:-1] + p[2:])
    both = 0.25 * (along[:, :-2] - 2 * along[:, 1:-1] + along[:, 2:])
    there = np.isfinite(both)
    return float(np.abs(both[there]).sum() / np.abs(p[1:-1, 1:-1][there]).sum())


def row(subject, criterion, reached):
    print(f"{subject}: {criterion}: {reached}")
    if into := os.environ.get("PIVNP_VERIFICATION_DIR"):
        with open(pathlib.Path(into) / "water_strength.tsv", "a") as file:
            file.write(f"{subject}\t{criterion}\t{reached}\twater_strength.py\n")


def strength_of(down, dry):
    """The reduction that settles dry soil by that."""
    return float(np.interp(down, [s for _, s in dry], [r for r, _ in dry]))


reduction = 1.1
dry = [(r, settled(BUOYANT, r)) for r in (0.98 * reduction, reduction, 1.02 * reduction)]
under = settled(BUOYANT, reduction, water=("[water]\nlevel_m = 1.3\nbulk_modulus_pa = 5e6", 1e-2))
print("dry, m:", dry, "under water:", under)
assert dry[0][1] < under < dry[2][1], "a cut under water"
if not small:
    row(f"vertical cut under a lake, Tresca, {CELLS} cells high", "factor of safety within 2 % of that of dry soil of the weight under water, same mesh",
        f"{100 * (reduction / strength_of(under, dry) - 1):+.1f} %")
    reduction = 1.15
    loose, stiff = (settled(SATURATED, reduction, poisson=p) for p in (0.3, 0.499))
    falls = settled(SATURATED, reduction, water=("[water]\nlevel_history = [[0.0, 1.3], [0.25, -0.1]]\nbulk_modulus_pa = 1.1e8", 1e-9))
    row(f"vertical cut after a rapid drawdown, Tresca, undrained .4993, {CELLS} cells high", "settles by more than dry soil of the same weight of .499, and less than of .3",
        f"{1000 * falls:.1f} mm; {1000 * stiff:.1f}, {1000 * loose:.1f} mm")
    assert stiff < falls < loose, (stiff, falls, loose)
    around = (0.98 * reduction, reduction, 1.02 * reduction)
    dry = [(r, settled(SATURATED, r, poisson=0.495)) for r in around]
    falls = settled(SATURATED, reduction, poisson=0.495, water=("[water]\nlevel_history = [[0.0, 1.3], [0.25, -0.1]]\nbulk_modulus_pa = 1.1e8", 1e-9))
    print("dry, m:", dry, "after drawdown:", falls, flush=True)
    row(f"vertical cut after a rapid drawdown, Tresca, skeleton .495, undrained .4993, {CELLS} cells high", "factor of safety within 2 % of that of dry soil of the whole weight, same mesh",
        f"{100 * (reduction / strength_of(falls, dry) - 1):+.1f} %")
    assert dry[0][1] < falls < dry[2][1], "a cut after a drawdown"
    row(f"vertical cut after a rapid drawdown, Tresca, skeleton .495, undrained .4993, {CELLS} cells high", "checkerboard below 3 % of the mean pressure",
        f"{100 * settled.alternating:.2g} %")
    assert settled.alternating < 0.03, "checkerboard after a drawdown"
    reduction = 1.2
    dry = [(r, settled(BUOYANT, r, slope=True)) for r in (0.98 * reduction, reduction, 1.02 * reduction)]
    lake = "[water]\nlevel_m = 1.3\nbulk_modulus_pa = 5e5"
    drained = settled(BUOYANT, reduction, slope=True, water=(lake, "1e-1\ndrained = true"))
    print("dry, m:", dry, "under water:", drained, flush=True)
    within = "factor of safety within 2 % of that of dry soil of the weight under water, same mesh"
    row(f"slope of 1 in 1.5 under a lake, drained, phi 25 degrees, {CELLS} cells high", within, f"{100 * (reduction / strength_of(drained, dry) - 1):+.1f} %")
    assert dry[0][1] < drained < dry[2][1], "a slope under water"
    flip = 'transfer = "flip"\n'
    dry = [(r, settled(BUOYANT, r, slope=True, mpm=flip)) for r in (0.98 * reduction, reduction, 1.02 * reduction)]
    for pressure in ("explicit", "projected"):
        flowing = settled(BUOYANT, reduction, slope=True, water=(lake, "1e-1"), mpm=flip + f'pressure = "{pressure}"')
        print("dry by FLIP, m:", dry, pressure, flowing, flush=True)
        row(f"slope of 1 in 1.5 under a lake, water that flows, {pressure}, FLIP, phi 25 degrees, {CELLS} cells high", within,
            f"{100 * (reduction / strength_of(flowing, dry) - 1):+.1f} %")
        assert dry[0][1] < flowing < dry[2][1], "a slope under water that flows"
