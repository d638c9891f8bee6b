#!/usr/bin/python3
"""Dropped frames and uneven times through `pivnp run`.

Eleven drawn frames of a simple shear, of 1 % a frame, 0.04 s apart; frames 4 and 7 and 8 come out as noise, as a
camera's bad frames do. The longer pairs bridge them, so the particles' times are uneven: 0 1 2 3 5 6 9 10.
  - the motion has no time for a bad frame, and says which frames were dropped
  - the final displacements are met as without loss (0.1 px, verify's own limit for this case), F's shear to 1e-3
  - velocities, by differences over the uneven times, are the steady ones of the shear within 2 %
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import zlib

import h5py
import numpy as np

program, source = sys.argv[1:3]
out = pathlib.Path(tempfile.mkdtemp(prefix="pivnp-test-"))
case = pathlib.Path(source) / "datasets" / "affine_shear" / "case.toml"
width, height, rate, bad = 560, 448, 25.0, (4, 7, 8)


def row(criterion, reached):
    print(f"[ figure   ] dropped frames: {criterion}: {reached}")
    folder = os.environ.get("PIVNP_VERIFICATION_DIR")
    if folder:
        with open(pathlib.Path(folder) / "dropped_frames.tsv", "a") as file:
            file.write(f"datasets/affine_shear, frames lost\t{criterion}\t{reached}\tdropped_frames\n")


def run(*arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def write_png(path, pixels):
    def chunk(kind, body):
        return len(body).to_bytes(4, "big") + kind + body + zlib.crc32(kind + body).to_bytes(4, "big")
    header = pixels.shape[1].to_bytes(4, "big") + pixels.shape[0].to_bytes(4, "big") + bytes([8, 0, 0, 0, 0])
    lines = b"".join(b"\0" + line.tobytes() for line in pixels)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) +
                     chunk(b"IEND", b""))


run("synth", case, "--out", out / "drawn", "--quiet")
frames = out / "drawn" / "frames"
random = np.random.default_rng(5)
for k in bad:
    write_png(frames / f"frame_{k:05d}.png", random.integers(0, 256, (height, width), dtype=np.uint8))
text = case.read_text().replace("[camera]", f"[frames]\npath = \"{frames}/*.png\"\nrate_hz = {rate}\n\n[camera]")
text += "\n[output]\nfields = [\"velocity_x\"]\n"
(out / "case.toml").write_text(text)
said = run("run", out / "case.toml", "--out", out / "run")
record = h5py.File(out / "run" / "record.h5")
motion = record["motion/np"]
times = motion["time"][:]
wanted = np.array([k for k in range(11) if k not in bad]) / rate
assert np.allclose(times, wanted), times
assert "dropped" in said.stdout + said.stderr, said.stdout + said.stderr
row("no times of bad frames", "none")

x0, u, F, status = motion["x0"][:], motion["u"][:], motion["F"][:], motion["status"][:]
alive = status[-1] != 0
pixel = 0.0078125
truth = h5py.File(out / "drawn" / "truth" / "record.h5")["motion/truth"]
assert np.allclose(truth["x0"][:], x0)
miss = np.sqrt(((u[-1] - truth["u"][-1]) ** 2).sum(axis=1).mean()) / pixel
row("final displacement within 0.1 px rms", f"{miss:.4f} px")
assert miss <= 0.1, miss
shear = F[-1][:, 0, 1].mean()
row("shear 0.1 within 0.001", f"{shear:.5f}")
assert abs(shear - 0.1) < 1e-3, shear
# A simple shear moves every particle by the same in every frame.
steady = truth["u"][-1][:, 0] / times[-1]
fast = np.abs(steady) > 0.5 * np.abs(steady).max()
velocity = motion["fields/velocity_x"][:]
worst = np.abs(velocity[:, fast] / steady[fast] - 1).max()
row("velocities over uneven times, within 2 %", f"{100 * worst:.2f} %")
assert worst < 0.02, worst
