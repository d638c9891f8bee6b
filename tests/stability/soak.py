#!/usr/bin/python3
"""Many frames: memory and open descriptors do not grow with their number, and none is left behind by a stage.

usage: soak.py PROGRAM [FRAMES]"""
import os
import shutil
import subprocess
import sys
import time

from program import CASE, folder, run

program = sys.argv[1]
frames = int(sys.argv[2]) if len(sys.argv) > 2 else 60
there = folder()
text = CASE[:CASE.index("[material.soil]")] + CASE[CASE.index("[synth]"):]
(there / "case.toml").write_text(text.replace("frames = 5", f"frames = {frames}").replace("[1.5, 0.5]", f"[{10 / frames}, {5 / frames}]")
                                 .replace("width_px = 160", "width_px = 176"))
drawn = run(program, "synth", there, "--out", there / "drawn", "--quiet", timeout=7200)
assert drawn.returncode == 0, drawn.stderr
process = subprocess.Popen([program, "track", str(there), "--frames", str(there / "drawn" / "frames" / "*.png"), "--out", str(there / "out"), "--threads", "1",
                            "--quiet", "--no-report"], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                           env=dict(os.environ, QT_QPA_PLATFORM="offscreen", GOMP_SPINCOUNT="1000"))
seen = []  # (closed pieces of the vectors, kB, descriptors)
while process.poll() is None:
    try:
        status = open(f"/proc/{process.pid}/status").read()
        memory = int(status.split("VmRSS:")[1].split()[0])
        seen.append((len(list((there / "out" / "parts").glob("piv.*.h5"))), memory, len(os.listdir(f"/proc/{process.pid}/fd"))))
    except (OSError, IndexError):
        pass
    time.sleep(0.01)
said = process.stderr.read()
assert process.returncode == 0, said
assert len(seen) > 3, "the run was over too soon"
begun = [s for s in seen if s[0] >= 1] or seen
most = max(m for _, m, _ in begun)
early = max(m for _, m, _ in begun[:max(1, len(begun) // 4)])
descriptors = max(d for _, _, d in seen)
print(f"{frames} frames: {early / 1024:.0f} MB in the first quarter, {most / 1024:.0f} MB at most; {descriptors} descriptors at most; {len(seen)} looks")
shutil.rmtree(there)
if descriptors > 64:
    sys.exit("descriptors are left open")
# (Particles keep their states until they are packed: some kilobytes a frame here.)
if most > early + 40 * 1024 + 50 * frames:
    sys.exit("memory grows with the number of frames")
