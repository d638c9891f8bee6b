#!/usr/bin/python3
"""Damaged videos: bits turned over, blocks of zeros, blocks that are missing, doubled or exchanged, ends cut off. Each is
measured, or refused with one line; none crashes, hangs or prints what a decoder thinks.

usage: videos.py PROGRAM [ROUNDS]"""
import os
import pathlib
import re
import shutil
import sys

from program import CASE, CpuLimit, fault_of, folder, run, seeded

program = sys.argv[1]
rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 4
dice = seeded()
there = folder()
(there / "case.toml").write_text(CASE[:CASE.index("[material.soil]")] + CASE[CASE.index("[synth]"):].replace("frames = 5", "frames = 8"))
made = run(program, "track", there / "case.toml", "--out", there / "made", "--quiet", "--threads", "1", "--set", 'report.animation=true')
assert made.returncode == 0, made.stderr
videos = list((there / "made").glob("*.mp4"))
data = pathlib.Path(os.environ.get("PIVNP_TEST_DATA", "/nowhere"))
for ending in ("avi", "mp4", "mkv", "mov", "mpg", "ts"):
    videos += [file for file in sorted(data.rglob(f"*.{ending}")) if file.stat().st_size < 30_000_000][:2]
assert videos, "there is no video"
(there / "plain.toml").write_text('name = "v"\n[frames]\nrate_hz = 10.0\nlast = 1\n[grid]\nspacing_px = 64\n[piv]\nwindow_px = 32\nmethod = "fft"\n')


def damaged(data):
    data = bytearray(data)
    for _ in range(dice.choice((1, 1, 3, 20))):
        at, size = dice.randrange(len(data)), dice.choice((1, 4, 64, 4096))
        if dice.random() < 0.3:
            at = dice.randrange(min(len(data), 400)) if dice.random() < 0.5 else max(0, len(data) - dice.randrange(2000))
        kind = dice.randrange(6)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << dice.randrange(8)
        elif kind == 1:
            data[at:at + size] = bytes(len(data[at:at + size]))
        elif kind == 2:
            del data[at:at + size]
        elif kind == 3:
            data[at:at] = data[at:at + size]
        elif kind == 4:
            data[at:at + size] = dice.randbytes(len(data[at:at + size]))
        elif len(data) > 2000:
            del data[dice.randrange(1000, len(data)):]
    return bytes(data)


faults, measured = [], 0
for k in range(rounds):
    video = videos[k % len(videos)]
    file = there / f"damaged{k}{video.suffix}"
    file.write_bytes(damaged(video.read_bytes()))
    result = run(program, "piv", there / "plain.toml", "--frames", file, "--out", there / "out", "--quiet", "--threads", "1", "--no-report",
                 preexec_fn=CpuLimit(120))
    wrong = fault_of(result, (0, 1, 2))
    rest = [line for line in result.stderr.splitlines() if not line.startswith("pivnp: ")]
    if not wrong and rest:
        wrong = f"printed: {rest[:3]}"
    if not wrong and re.search(r"[\x00-\x08\x0b-\x1f\x7f]", result.stderr):
        wrong = "control characters were printed"
    measured += result.returncode == 0
    if wrong:
        kept = folder() / file.name
        shutil.copy(file, kept)
        faults.append(f"{kept}: {wrong}")
    file.unlink()
print(f"{rounds} damaged copies of {len(videos)} videos: {measured} measured, {len(faults)} faults")
shutil.rmtree(there)
if faults:
    sys.exit("\n".join(faults))
