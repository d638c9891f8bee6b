#!/usr/bin/python3
"""Runs short of memory, descriptors, room in files, processes or of a sound clock: done, or one line and no record that is
damaged; and what a run that was short left behind is gone on from, with the same bits.

usage: limits.py PROGRAM [ROUNDS]"""
import os
import resource
import shutil
import signal
import sys

import h5py
import numpy

from program import CASE, fault_of, folder, run, seeded

program = sys.argv[1]
rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 6
dice = seeded()
faults = []
there = folder()
(there / "case.toml").write_text(CASE)
arguments = ["run", there, "--threads", "1", "--quiet"]
sanitized = b"__asan_" in open(program, "rb").read()  # its shadow is terabytes of addresses


def datasets(file):
    found = {}
    with h5py.File(file) as record:
        record.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return {name: value for name, value in found.items() if name != "case" and not name.startswith("cost")}  # a case names the folder


def same(a, b):
    one, two = datasets(a), datasets(b)
    return one.keys() == two.keys() and all(
        numpy.array_equal(x, two[n], equal_nan=x.dtype.kind == "f") if isinstance(x, numpy.ndarray) else x == two[n] for n, x in one.items())


def least(limit, values):
    """A limit that lets the program start, and one below: so that it hits the work, not the loader."""
    def set_limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(limit, (values, values))
    return set_limit


def test(name, short_of_memory=False, **more):
    out = there / "out"
    shutil.rmtree(out, ignore_errors=True)
    result = run(program, *arguments, "--out", out, **more)
    # (HDF5 1.10 itself crashes where it has no memory to close a file: docs/limits.md.)
    wrong = "" if short_of_memory and result.returncode == -signal.SIGSEGV else fault_of(result, (0, 1))
    if not wrong and result.returncode != 0:
        record = out / "record.h5"
        if record.exists() and run(program, "verify", record).returncode != 0:
            wrong = "a damaged record"
        again = run(program, *arguments, "--out", out, "--resume")
        if again.returncode != 0:
            wrong = f"cannot be gone on from: {again.stderr.strip()[-200:]}"
        elif not same(out / "record.h5", there / "whole" / "record.h5"):
            wrong = "other bits when gone on from"
    print("FAIL" if wrong else "ok  ", name, result.returncode, wrong or result.stderr.strip()[-150:], flush=True)
    if wrong:
        faults.append(f"{name}: {wrong}")


whole = run(program, *arguments, "--out", there / "whole")
assert whole.returncode == 0, whole.stderr
starts = run(program, "--version")
assert starts.returncode == 0
for k in range(rounds):
    kind = k % 4
    if kind == 0:
        size = dice.randint(4, 400) * 1000
        test(f"files of {size} bytes", preexec_fn=least(resource.RLIMIT_FSIZE, size))
    elif kind == 1:
        count = dice.randint(5, 24)
        test(f"{count} descriptors", preexec_fn=least(resource.RLIMIT_NOFILE, count))
    elif kind == 2 and not sanitized:
        size = dice.randint(60, 240) << 20
        test(f"{size >> 20} MiB of data", short_of_memory=True, preexec_fn=least(resource.RLIMIT_DATA, size))
    elif kind == 3 and not sanitized:
        size = dice.randint(700, 3000) << 20
        test(f"{size >> 20} MiB of addresses", short_of_memory=True, preexec_fn=least(resource.RLIMIT_AS, size))

# A clock that was set back, or forward: what was written before is dated tomorrow, or at the beginning of time.
for date in (0, 4102444800):
    out = there / "dated"
    shutil.rmtree(out, ignore_errors=True)
    stopped = run(program, *arguments, "--out", out, preexec_fn=least(resource.RLIMIT_FSIZE, 40000))
    for file in out.rglob("*"):
        os.utime(file, (date, date))
    again = run(program, *arguments, "--out", out, "--resume")
    if stopped.returncode != 1 or again.returncode != 0 or not same(out / "record.h5", there / "whole" / "record.h5"):
        faults.append(f"files of the date {date}: {stopped.returncode}, {again.returncode} {again.stderr.strip()[-200:]}")

# A cgroup's limit ends the program from outside: what it left is gone on from.
groups = "/sys/fs/cgroup"
if os.access(groups, os.W_OK) and "memory" in open(f"{groups}/cgroup.controllers").read().split() if os.path.exists(f"{groups}/cgroup.controllers") else False:
    group = f"{groups}/pivnp-test-{os.getpid()}"
    try:
        os.mkdir(group)
        with open(f"{group}/memory.max", "w") as limit:
            limit.write(str(dice.randint(40, 150) << 20))
        with open(f"{group}/memory.swap.max", "w") as limit:
            limit.write("0")

        def join():
            with open(f"{group}/cgroup.procs", "w") as procs:
                procs.write(str(os.getpid()))

        out = there / "grouped"
        killed = run(program, *arguments, "--out", out, preexec_fn=join)
        again = run(program, *arguments, "--out", out, "--resume")
        print("cgroup: ended with", killed.returncode)
        if killed.returncode not in (0, 1, -signal.SIGKILL) or again.returncode != 0 or not same(out / "record.h5", there / "whole" / "record.h5"):
            faults.append(f"a cgroup's limit: {killed.returncode}, {again.returncode} {again.stderr.strip()[-200:]}")
        os.rmdir(group)
    except OSError as error:
        print("no cgroup can be made here:", error)
else:
    print("no cgroup can be made here")

shutil.rmtree(there)
if faults:
    sys.exit("\n".join(faults))
