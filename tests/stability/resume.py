#!/usr/bin/python3
"""Ctrl-C ends with 130. kill -9 at random moments, then --resume: the record equals an uninterrupted one."""
import os
import random
import signal
import subprocess
import sys
import time

import h5py
import numpy

from program import CASE, folder, run

program = sys.argv[1]
seed = int(os.environ.get("PIVNP_TEST_SEED", random.randrange(10**6)))
print("seed", seed)
random.seed(seed)

there = folder()
(there / "case.toml").write_text(CASE.replace("frames = 5", "frames = 70").replace("[1.5, 0.5]", "[0.3, 0.1]"))
arguments = ["run", str(there), "--frames", str(there / "drawn" / "frames" / "*.png"), "--threads", "1", "--quiet"]
assert run(program, "synth", there, "--out", there / "drawn").returncode == 0

start = time.monotonic()
whole = run(program, *arguments, "--out", there / "whole")
assert whole.returncode == 0, whole.stderr
lasts = time.monotonic() - start


def begin(out, resume):
    return subprocess.Popen([program, *arguments, "--out", str(out)] + (["--resume"] if resume else []),
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)


def datasets(file):
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


def same(a, b):
    with h5py.File(a) as one, h5py.File(b) as two:
        first, second = datasets(one), datasets(two)
        assert first.keys() == second.keys(), first.keys() ^ second.keys()
        for name in first:
            x, y = first[name][()], second[name][()]
            equal = numpy.array_equal(x, y, equal_nan=x.dtype.kind == "f") if isinstance(x, numpy.ndarray) else x == y
            assert equal, name + " differs"
        print(len(first), "datasets are equal")


killed = 0
for trial in range(3):
    out = there / f"killed{trial}"
    resume = False
    while True:
        process = begin(out, resume)
        try:
            process.communicate(timeout=random.uniform(0.15, 0.8) * lasts)
            assert process.returncode == 0, process.returncode
            break
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.communicate()
            killed += 1
            resume = True
        if killed > 30:  # the machine is slow today: let it end
            last = run(program, *arguments, "--out", out, "--resume")
            assert last.returncode == 0, last.stderr
            break
    same(there / "whole" / "record.h5", out / "record.h5")
print("killed", killed, "times")
assert killed > 0

for stop in (signal.SIGHUP, signal.SIGINT):  # the terminal is closed; Ctrl-C
    out = there / f"interrupted{stop}"
    process = begin(out, False)
    while not (out / "parts").exists() and process.poll() is None:  # at work, and far from the end
        time.sleep(0.002)
    process.send_signal(stop)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130 and "interrupted" in errors, (process.returncode, errors)
last = run(program, *arguments, "--out", out, "--resume")
assert last.returncode == 0, last.stderr
same(there / "whole" / "record.h5", out / "record.h5")
