#!/usr/bin/python3
"""Frames belong to the run that measures them: leftovers of another run, frames that changed before --resume, and a
second run into the same folder are noticed."""
import fcntl
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy

from program import CASE, folder, run

program = sys.argv[1]
MEASURED = CASE[:CASE.index("[material.soil]")] + CASE[CASE.index("[synth]"):]  # without a simulation


def refused(result, *words):
    lines = [line for line in result.stderr.splitlines() if line.startswith("pivnp: error:")]
    assert result.returncode == 2 and len(lines) == 1, (result.returncode, result.stderr)
    for word in words:
        assert word in lines[0], (word, lines[0])
    print("ok", lines[0])


def done(result):
    assert result.returncode == 0, (result.returncode, result.stderr)


def measured(out):
    with h5py.File(out / "record.h5") as record:
        return len(record["frames/name"]), record["piv/displacement"][()]


# Twelve frames, then five of another motion into the same folder: the five are measured.
here = folder()
(here / "many.toml").write_text(MEASURED.replace("frames = 5", "frames = 12"))
(here / "few.toml").write_text(MEASURED.replace("[1.5, 0.5]", "[-0.5, 2.0]"))
done(run(program, "run", here / "few.toml", "--out", here / "alone", "--quiet"))
done(run(program, "run", here / "many.toml", "--out", here / "out", "--quiet"))
assert measured(here / "out")[0] == 12
done(run(program, "run", here / "few.toml", "--out", here / "out", "--quiet", "--force"))
count, vectors = measured(here / "out")
assert count == 5, count
assert numpy.array_equal(vectors, measured(here / "alone")[1], equal_nan=True)
assert len(list((here / "out" / "frames").glob("*.png"))) == 5
refused(run(program, "run", here / "many.toml", "--out", here / "out", "--resume"), "frames")
assert measured(here / "out")[0] == 5

# Frames that nobody drew here are nobody's to draw over, or to measure.
others = here / "others"
(others / "frames").mkdir(parents=True)
shutil.copy(here / "alone" / "frames" / "frame_00000.png", others / "frames" / "frame_00007.png")
refused(run(program, "run", here / "few.toml", "--out", others), "frame_00007.png")
refused(run(program, "synth", here / "few.toml", "--out", others), "frame_00007.png")
assert [f.name for f in (others / "frames").glob("*.png")] == ["frame_00007.png"]

# Nor is a frame that somebody put beside those drawn here.
beside = here / "out" / "frames" / "frame_lab_01.png"
shutil.copy(here / "out" / "frames" / "frame_00000.png", beside)
refused(run(program, "run", here / "few.toml", "--out", here / "out", "--force"), "frame_lab_01.png")
assert beside.exists() and (here / "out" / "frames" / "frame_00004.png").exists()
beside.unlink()

# The lock covers the frames: while another run holds the folder none is drawn.
before = {f: f.read_bytes() for f in (here / "out" / "frames").iterdir()}
with open(here / "out" / ".lock", "w") as lock:
    fcntl.flock(lock, fcntl.LOCK_EX)
    for command in ("run", "synth"):
        refused(run(program, command, here / "many.toml", "--out", here / "out", *(["--force"] if command == "run" else [])), "another run")
assert before == {f: f.read_bytes() for f in (here / "out" / "frames").iterdir()}

# A run stopped while it measures; then its frames change.
long = here / "long"
(here / "long.toml").write_text(MEASURED.replace("frames = 5", "frames = 80").replace("[1.5, 0.5]", "[0.3, 0.1]"))
done(run(program, "synth", here / "long.toml", "--out", here / "drawn"))
frames = here / "drawn" / "frames"
arguments = [program, "run", str(here / "long.toml"), "--frames", str(frames / "*.png"), "--threads", "1", "--quiet"]


def stopped():
    shutil.rmtree(long, ignore_errors=True)
    process = subprocess.Popen([*arguments, "--out", str(long)], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not list((long / "parts").glob("piv.*.h5*")) and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert (long / "parts" / "head.h5").exists()


def resumed():
    return subprocess.run([*arguments, "--out", str(long), "--resume"], capture_output=True, text=True, timeout=300,
                          stdin=subprocess.DEVNULL)


stopped()
frame = frames / "frame_00003.png"
kept = frame.read_bytes()
shutil.copy(frames / "frame_00009.png", frame)
refused(resumed(), "frame_00003.png")
frame.unlink()
refused(resumed(), "frame_00003.png")
frame.write_bytes(kept)
shutil.copy(frame, frames / "frame_00080.png")
refused(resumed(), "frame_00080.png")
(frames / "frame_00080.png").unlink()
done(resumed())
frame.write_bytes(kept + b"\0")
refused(resumed(), "frame_00003.png")  # finished, but of other frames
