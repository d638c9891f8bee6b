#!/usr/bin/python3
"""Damage on the disk: segments are computed again, records are refused, `pivnp verify RECORD` tells."""
import os
import random
import shutil
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
(there / "case.toml").write_text(CASE.replace("frames = 5", "frames = 150").replace("[1.5, 0.5]", "[0.2, 0.05]"))
assert run(program, "synth", there, "--out", there / "drawn").returncode == 0
arguments = ["track", str(there), "--frames", str(there / "drawn" / "frames" / "*.png"), "--threads", "1", "--quiet"]
whole = there / "whole"
assert run(program, *arguments, "--out", whole).returncode == 0


def errors(result):
    return [line for line in result.stderr.splitlines() if line.startswith("pivnp: error:")]


def damage(file):
    data = bytearray(file.read_bytes())
    at = random.randrange(len(data))
    if random.random() < 0.5:
        data[at] ^= 1 << random.randrange(8)
    else:
        block = slice(at, min(at + 512, len(data)))
        if not any(data[block]):
            return damage(file)
        data[block] = bytes(len(data[block]))
    file.write_bytes(data)


def datasets(file):
    found = {}
    with h5py.File(file) as record:
        record.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def same(a, b):
    first, second = datasets(a), datasets(b)
    assert first.keys() == second.keys()
    for name, x in first.items():
        y = second[name]
        assert (numpy.array_equal(x, y, equal_nan=x.dtype.kind == "f") if isinstance(x, numpy.ndarray) else x == y), name


# A run stopped once it has closed segments; a file of them is damaged, in many ways.
parts = there / "killed"
process = subprocess.Popen([program, *arguments, "--out", str(parts)], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
while not (parts / "parts" / "piv.00000064.h5").exists() and process.poll() is None:
    time.sleep(0.002)
process.kill()
process.wait()
files = sorted(f.name for f in (parts / "parts").glob("*.h5") if f.name != "head.h5")
assert files, "the run was over too soon"
for trial in range(int(sys.argv[2]) if len(sys.argv) > 2 else 6):
    out = there / "again"
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(parts, out)
    name = random.choice(files)
    damage(out / "parts" / name)
    result = run(program, *arguments, "--out", out, "--resume")
    assert result.returncode == 0, (name, result.stderr)
    same(whole / "record.h5", out / "record.h5")
    print("ok", name)

# A record.
record = there / "damaged" / "record.h5"
record.parent.mkdir()
for place in (whole, whole / "record.h5"):
    result = run(program, "verify", place)
    assert result.returncode == 0 and "150 frames" in result.stdout, (result.stdout, result.stderr)
for trial in range(20):
    shutil.copy(whole / "record.h5", record)
    damage(record)
    if trial < 4:  # of the checksum itself
        shutil.copy(whole / "record.h5", record)
        data = bytearray(record.read_bytes())
        data[-1 - 5 * trial] ^= 4
        record.write_bytes(data)
    for command in ("verify", "report"):
        result = run(program, command, record)
        lines = errors(result)
        assert result.returncode == 2 and len(lines) == 1 and "record.h5" in lines[0], (result.returncode, result.stderr)
    assert not (record.parent / "report.html").exists()
print("ok", lines[0] if lines else "")

# Every one of several is told.
shutil.copy(record, there / "first.h5")
shutil.copy(record, there / "third.h5")
result = run(program, "verify", there / "first.h5", whole, there / "third.h5", there / "fourth.h5")
lines = errors(result)
assert result.returncode == 2 and len(lines) == 3 and "150 frames" in result.stdout, (result.stdout, result.stderr)
assert all(name in line for name, line in zip(("first", "third", "fourth"), lines)), lines

# What h5py changed is read, but is not as it was written.
shutil.copy(whole / "record.h5", record)
with h5py.File(record, "r+") as changed:
    changed.attrs["remark"] = "mine"
result = run(program, "verify", record)
assert result.returncode == 2 and len(errors(result)) == 1 and "1.9" in result.stderr, (result.stdout, result.stderr)
result = run(program, "report", record)
assert result.returncode == 0, result.stderr
with h5py.File(record, "r+") as changed:  # as a program older than checksums would have left it
    changed.attrs["schema_version"] = "1.2"
result = run(program, "verify", record)
assert result.returncode == 0 and "no checksum" in result.stdout, (result.stdout, result.stderr)
