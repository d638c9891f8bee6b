"""Holds a record against docs/format.md with h5py, and runs the example there.

usage: check_record.py record.h5 format.md
"""
import re
import subprocess
import sys

import h5py
import numpy as np

record_path, doc_path = sys.argv[1:3]
wrong = []


def check(ok, what):
    if not ok:
        wrong.append(what)


f = h5py.File(record_path)
check(f.attrs["schema"] == "pivnp", "schema")
check(f.attrs["schema_version"] == "1.9", "schema_version")
check(re.fullmatch(r"\d+\.\d+\.\d+", f.attrs["version"]), "version")
check(f.attrs["commit"] and "HDF5" in f.attrs["libraries"], "commit and libraries")
check(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", f.attrs["created"]), "created")
L, T = f.attrs["length_unit"], f.attrs["time_unit"]
case = f["case"][()].decode()
check("window_px = 32" in case, "case")
nx, ny = f["grid"].attrs["nodes"]
for name, shape in {"origin": (2,), "spacing": (2,), "nodes": (2,)}.items():
    check(f["grid"].attrs[name].shape == shape, name)
check(f["camera"].attrs["world_from_pixel"].shape == (3, 3), "world_from_pixel")
check(f["camera"].attrs["world_from_pixel"][1, 1] == -2e-4, "world_from_pixel is row by row")

# Every dataset has a unit.
units = {}


def visit(name, thing):
    if isinstance(thing, h5py.Dataset):
        check("unit" in thing.attrs, f"{name} has no unit")
        units[name] = thing.attrs.get("unit")


f.visititems(visit)

K, frames = f["piv/pair"].shape[0], f["frames/name"].shape[0]
steps, P = f["motion/np/u"].shape[:2]
text = "O"
expected = {
    "frames/name": (text, (frames,), ""), "frames/time": ("f8", (frames,), T), "frames/flag": ("u1", (frames,), ""),
    "piv/pair": ("i4", (K, 2), ""), "piv/anchor": ("u1", (K,), ""), "piv/displacement": ("f4", (K, ny, nx, 2), L),
    "piv/status": ("u1", (K, ny, nx), ""), "piv/cov": ("f4", (K, ny, nx, 3), L + "^2"), "piv/score": ("f4", (K, ny, nx), "1"),
    "piv/correlation_length": ("f4", (K,), L), "piv/path_factor": ("f4", (K, ny, nx), "1"),
    "compare/fields/difference_x/time": ("f8", (2,), T), "compare/fields/difference_x/id": ("i8", (P,), ""),
    "compare/fields/difference_x/value": ("f4", (2, P), "m"),
    "compare/tables/over_space/time": ("f8", (2,), "s"),
    "compare/tables/over_space/displacement_rms": ("f8", (2,), "m"),
}
for term in ("kinetic", "elastic", "plastic", "damping", "contact", "external", "residual", "hourglass"):
    expected["energy/" + term] = ("f8", (steps,), "J/m")
expected["energy/time"] = ("f8", (steps,), T)
expected["reactions/time"] = ("f8", (steps,), T)
for name in ("boundary.base_left", "body.plate"):
    expected[f"reactions/{name}/force"] = ("f8", (steps, 2), "N/m")
    expected[f"reactions/{name}/moment"] = ("f8", (steps,), "N")
expected["reactions/body.plate/displacement"] = ("f8", (steps, 2), L)
expected["reactions/body.plate/turn"] = ("f8", (steps,), "rad")
common = {
    "time": ("f8", (steps,), T), "id": ("i8", (P,), ""), "label": ("i4", (P,), ""), "label_name": (text, (2,), ""),
    "x0": ("f8", (P, 2), L), "area": ("f4", (P,), L + "^2"), "born": ("f8", (P,), T), "end": ("f8", (P,), T),
    "end_reason": ("u1", (P,), ""), "u": ("f4", (steps, P, 2), L), "F": ("f4", (steps, P, 2, 2), "1"),
    "status": ("u1", (steps, P), ""), "fields/strain_dev": ("f4", (steps, P), "1"),
    "fields/velocity_x": ("f4", (steps, P), f"{L}/{T}"),
}
known = {"np": {"cov_u": ("f4", (steps, P, 3), L + "^2")},
         "mpm": {"v": ("f4", (steps, P, 2), f"{L}/{T}"), "stress": ("f4", (steps, P, 4), "Pa"),
                 "plastic_dev": ("f4", (steps, P), "1")}}
for side, more in known.items():
    for name, what in {**common, **more}.items():
        expected[f"motion/{side}/{name}"] = what
for name, (kind, shape, unit) in expected.items():
    check(name in f, f"{name} is missing")
    if name not in f:
        continue
    d = f[name]
    check(d.dtype == np.dtype(kind), f"{name}: type {d.dtype}, expected {kind}")
    check(d.shape == shape, f"{name}: shape {d.shape}, expected {shape}")
    check(d.attrs["unit"] == unit, f"{name}: unit {d.attrs['unit']}, expected {unit}")
extra = [n for n in units if n not in expected and n != "case" and not n.startswith("xdmf/")]
check(not extra, f"not in the contract: {extra}")

# Text, and what viewers see.
check(f["frames/name"].asstr()[1] == "bild grün 1.png", "names are UTF-8")
check(f["motion/np/label_name"].asstr()[1] == "Schicht ü, wet", "label names are UTF-8")
check(h5py.check_string_dtype(f["frames/name"].dtype).encoding == "utf-8", "encoding")
check(list(f["frames/flag"][:]) == [0, 0, 0, 1, 0, 0], "flags")
for side in known:
    m, x = f["motion/" + side], f["xdmf/motion/" + side]
    check(not np.isnan(m["end"][2]) and np.isnan(m["end"][3]), "ends")
    for k in range(steps):
        p = x[f"position/{k:06d}"]
        check(np.allclose(p[:, :2], m["x0"][:] + m["u"][k], atol=1e-6) and not p[:, 2].any(), f"position {side} {k}")
        check(np.array_equal(x[f"displacement/{k:06d}"][:], m["u"][k]), f"displacement {side} {k}")
        check(np.array_equal(x[f"status/{k:06d}"][:], m["status"][k]), f"status {side} {k}")
for k in range(K):
    check(np.array_equal(f[f"xdmf/piv/displacement/{k:06d}"][0], f["piv/displacement"][k], equal_nan=True), f"piv {k}")
metric = f["compare/displacement_rms"].attrs
check(metric["value"] == 0.004 and metric["unit"] == "m" and metric["verdict"] == "not resolved" and metric["lost_in"] == "mesh" and metric["limit"] == "met", "metric")
check(np.isnan(f["compare/bias_x"].attrs["uncertainty"]), "unknown uncertainty is NaN")
check(f["piv/displacement"].compression == "gzip" and f["piv/displacement"].shuffle, "deflated and shuffled")
f.close()

example = re.search(r"## Example.*?```python\n(.*?)```", open(doc_path, encoding="utf-8").read(), re.S).group(1)
ran = subprocess.run([sys.executable, "-c", example, record_path], capture_output=True, text=True)
check(ran.returncode == 0, "the example fails: " + ran.stderr)
check("10 of 11 particles, at t = 0.1 s" in ran.stdout, "the example prints: " + ran.stdout)

for line in wrong:
    print("wrong:", line)
if wrong:
    sys.exit(1)
print("record agrees with the contract:", len(units), "datasets")
