#!/usr/bin/python3
"""Real laboratory images through `pivnp run`, held against what is known of them.

tbar             far-field increments (0.02, 1.97) px a frame, downward; the step IMG_1074 -> IMG_1075 flagged, and no
                 other; median difference of increments outside 1.5 D at most 10 % of the far field
sand_wedge       median difference from the PIVlab vectors beside the frames at most 0.15 px a component
fracture_16bit   16-bit frames with spaces in their names: read, moved by several px (v about -5)
column_collapse  video: 111 frames at 240 a second, whatever its container says
"""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

program, source, name = sys.argv[1:4]
data = os.environ.get("PIVNP_TEST_DATA")
if not data or not (pathlib.Path(data) / name).exists():
    print("skipped: PIVNP_TEST_DATA does not name a folder with " + name)
    sys.exit(77)
frames = pathlib.Path(data) / name
if name == "column_collapse":
    frames = next(frames.glob("*.MP4"))
out = pathlib.Path(tempfile.mkdtemp(prefix="pivnp-test-"))


def row(criterion, reached):
    print(f"[ figure   ] {name}: {criterion}: {reached}")
    folder = os.environ.get("PIVNP_VERIFICATION_DIR")
    if folder:
        with open(pathlib.Path(folder) / f"real_images.{name}.tsv", "a") as file:
            file.write(f"datasets/{name} (real images)\t{criterion}\t{reached}\treal_images.{name}\n")


subprocess.run([program, "run", str(pathlib.Path(source) / "datasets" / name), "--frames", str(frames), "--out", str(out),
                "--quiet"], check=True, stdin=subprocess.DEVNULL)
record = h5py.File(out / "record.h5")
displacement, status = record["piv/displacement"][:], record["piv/status"][:]
names = [n.decode() if isinstance(n, bytes) else n for n in record["frames/name"][:]]
valid = (status == 1).sum() / max(1, (status != 0).sum())

if name == "tbar":
    px = 790.0
    origin, spacing = record["grid"].attrs["origin"], record["grid"].attrs["spacing"]
    ny, nx = status.shape[1:]
    x, y = np.meshgrid(origin[0] + spacing[0] * np.arange(nx), origin[1] + spacing[1] * np.arange(ny))
    flagged = [names[k] for k in np.flatnonzero(record["frames/flag"][:])]
    usual = [k for k in range(status.shape[0]) if names[k + 1] not in flagged]
    far = np.hypot(x, y) > 1.7
    median = np.median(np.concatenate([displacement[k][far & (status[k] == 1)] for k in usual]), axis=0) * px
    row("far-field increment within 0.05 px of (0.02, 1.97)", f"({median[0]:.3f}, {-median[1]:.3f})")
    assert abs(median[0] - 0.02) < 0.05 and abs(-median[1] - 1.97) < 0.05, median
    row("only the step to IMG_1075 flagged", "ends at " + ", ".join(flagged))
    assert flagged == ["IMG_1075.jpg"], flagged
    share = record["compare/increment_median_relative"].attrs["value"]
    row("median difference outside 1.5 D at most 10 %",
        f"{100 * share:.1f} % ({record['compare/increment_median'].attrs['value'] * px:.3f} px)")
    assert share <= 0.10, share
elif name == "sand_wedge":
    differences = []
    for k in range(displacement.shape[0]):
        theirs = np.genfromtxt(frames / f"github_test_{k + 1:04d}.txt", delimiter=",", skip_header=3)
        column = np.rint((theirs[:, 0] - 9) / 8).astype(int)
        line = np.rint((139 - theirs[:, 1]) / 8).astype(int)
        ours, good = displacement[k][line, column], status[k][line, column] == 1
        differences.append(np.abs(ours - theirs[:, 2:4] * [1, -1])[good])
    median = np.nanmedian(np.concatenate(differences), axis=0)
    row("median difference from PIVlab at most 0.15 px a component", f"{median[0]:.3f}, {median[1]:.3f} px")
    assert (median <= 0.15).all(), median
elif name == "fracture_16bit":
    assert names == ["img_0000 .png", "img_0060 .png"], names
    median = np.median(displacement[status == 1], axis=0)
    row("read, 16 bit, names with a space; at least 80 % valid", f"{100 * valid:.0f} % valid, median ({median[0]:.2f}, {median[1]:.2f}) px")
    assert valid > 0.8 and 1 < abs(median[1]) < 20, (valid, median)
else:
    times = record["frames/time"][:]
    row("111 frames at 240 per second", f"{len(times)} frames, {1 / np.diff(times).mean():.1f} per second; {100 * valid:.0f} % valid")
    assert len(times) == 111 and np.allclose(np.diff(times), 1 / 240)
    # Mapped onto the plate: where the outermost vectors on the near side point outward faster than 0.15 m/s.
    origin, spacing = record["grid"].attrs["origin"], record["grid"].attrs["spacing"]
    ny, nx = status.shape[1:]
    x, y = np.meshgrid(origin[0] + spacing[0] * np.arange(nx), origin[1] + spacing[1] * np.arange(ny))
    r = np.hypot(x, y)

    def front(k):
        outward = (displacement[k][..., 0] * x + displacement[k][..., 1] * y) / r * 240
        return np.percentile(r[(status[k] == 1) & (y < 0) & (outward > 0.15)], 98)

    speed = (front(54) - front(30)) / 0.1
    row("front within 15 % of 0.74 m/s", f"{speed:.2f} m/s")
    assert abs(speed - 0.74) < 0.15 * 0.74, speed
