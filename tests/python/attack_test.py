"""The Python module under attack: arrays of any kind, NaN, memory that is not contiguous, threads that share an object, fork,
Ctrl-C at random moments. An array is taken, or refused by one of Python's own errors with one line; nothing crashes or hangs.

usage: PYTHONPATH=build/release/python attack_test.py [ROUNDS]
"""
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
import pivnp

rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 40
seed = int(os.environ.get("PIVNP_TEST_SEED", random.randrange(10**6)))
print("seed", seed, flush=True)
dice = np.random.default_rng(seed)
faults = []
SHAPE = (72, 88)
texture = dice.integers(0, 255, (SHAPE[0] + 8, SHAPE[1] + 8)).astype(np.uint8)
FIRST, SECOND = np.ascontiguousarray(texture[4:-4, 4:-4]), np.ascontiguousarray(texture[3:-5, 2:-6])
SIMULATED = {
    "grid": {"spacing_m": 0.02, "area_m": [[0, 0], [0.12, 0.16]]},
    "region": {"soil": {"polygon_m": [[0, 0], [0.08, 0], [0.08, 0.08], [0, 0.08]]}},
    "material": {"soil": {"model": "linear_elastic", "density_kg_m3": 1500.0, "young_pa": 1e6}},
    "mpm": {"end_s": 1000.0, "output_rate_hz": 1.0, "initial_equilibrium": False, "end_at_rest": False},
    "boundary": {"base": {"line_m": [[0, 0], [0.12, 0]]}},
}


def fault(text):
    faults.append(text)
    print("FAIL", text, flush=True)


def correlated(first=FIRST, second=SECOND, **more):
    return pivnp.correlate(first, second, window=24, spacing=12, threads=1, **more)


EXPECTED = correlated().displacement.tobytes()

# Arrays that hold the same values in another way, and arrays that hold anything.
for name, same in [("a view", np.pad(FIRST, 9)[9:-9, 9:-9]), ("a transposed copy", FIRST.T.copy().T), ("turned over twice", FIRST[::-1, ::-1].copy()[::-1, ::-1]),
                   ("every second column", np.repeat(FIRST, 2, axis=1)[:, ::2]), ("read-only", np.frombuffer(FIRST.tobytes(), np.uint8).reshape(SHAPE))]:
    try:
        if correlated(same).displacement.tobytes() != EXPECTED:
            fault(f"{name}: other vectors")
    except (ValueError, TypeError) as error:
        if "\n" in str(error) and "incompatible function arguments" not in str(error):
            fault(f"{name}: {error}")
TYPES = ["?", "i1", "u1", ">u2", "u2", "i2", "i4", "u8", "f2", "f4", ">f4", "f8", "c8", "O", "S3", "U2", "M8[s]", "V4"]
for k in range(rounds):
    dtype, kind = np.dtype(TYPES[dice.integers(len(TYPES))]), dice.integers(6)
    shape = [SHAPE, SHAPE[::-1], SHAPE + (3,), (0, 0), SHAPE[:1], (1, 1)][kind if dice.random() < 0.5 else 0]
    try:
        values = dice.integers(0, 120, shape)
        array = values.astype(dtype) if dtype.kind != "V" else np.zeros(shape, dtype)
        if dtype.kind == "f" and array.size:
            array.flat[dice.integers(array.size)] = [np.nan, np.inf, -np.inf, -1e30, 3e38][dice.integers(5)] if dtype.itemsize > 2 else np.nan
        if dice.random() < 0.3 and array.ndim == 2:
            array = np.broadcast_to(array[:1], array.shape)
        found = correlated(array, SECOND if dice.random() < 0.5 else array)
        status = np.asarray(found.status)
        if not np.isfinite(np.asarray(found.displacement)[status == 1]).all():
            fault(f"{dtype}, {shape}: a valid vector that is not finite")
    except (ValueError, TypeError) as error:
        if len(str(error).splitlines()) != 1 and "incompatible function arguments" not in str(error):
            fault(f"{dtype}, {shape}: {error}")
    except Exception as error:
        fault(f"{dtype}, {shape}: {type(error).__name__}: {error}")

# Threads that share one object.
correlator = pivnp.Correlator(SHAPE, window=24, spacing=12, threads=2)
alike = []


def work():
    for _ in range(max(2, rounds // 20)):
        alike.append(correlator(FIRST, SECOND).displacement.tobytes() == EXPECTED)


threads = [threading.Thread(target=work) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
if not alike or not all(alike):
    fault(f"four threads with one Correlator: {alike.count(False)} of {len(alike)} with other bits")

solver = pivnp.mpm.Solver(SIMULATED, threads=1)
refusals = []


def step():
    try:
        solver.advance_to(solver.stable_step * 400)
    except RuntimeError as error:
        refusals.append(str(error))


threads = [threading.Thread(target=step) for _ in range(4)]
for thread in threads:
    thread.start()
while any(thread.is_alive() for thread in threads):
    try:
        assert solver.time >= 0 and len(solver) > 0 and np.isfinite(list(solver.energy.values())).all()
    except RuntimeError as error:
        refusals.append(str(error))
    time.sleep(0.002)
if not all("another thread" in line for line in refusals):
    fault(f"four threads with one Solver: {set(refusals)}")

# A child by fork, as multiprocessing makes it, after threads were at work in the parent.
correlator(FIRST, SECOND)
child = os.fork()
if child == 0:
    signal.alarm(60)
    good = pivnp.correlate(FIRST, SECOND, window=24, spacing=12, threads=2).displacement.tobytes() == EXPECTED
    os._exit(0 if good else 3)
status = os.waitpid(child, 0)[1]
if status != 0:
    fault(f"a child by fork: {'it hangs' if os.WIFSIGNALED(status) else 'exit ' + str(os.WEXITSTATUS(status))}")

# Ctrl-C at a random moment of a simulation.
with tempfile.TemporaryDirectory() as scratch:
    for k in range(max(2, rounds // 20)):
        program = f"import pivnp\nprint('at work', flush=True)\npivnp.mpm.Solver({SIMULATED!r}).run()\n"
        process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=scratch)
        process.stdout.readline()
        time.sleep(dice.random() * 0.5)
        process.send_signal(signal.SIGINT)
        try:
            _, said = process.communicate(timeout=60)
            if "KeyboardInterrupt" not in said or process.returncode in (0, -11, -6):
                fault(f"Ctrl-C: exit {process.returncode}: {said[-300:]}")
        except subprocess.TimeoutExpired:
            process.kill()
            fault("Ctrl-C: not heard")

if faults:
    sys.exit("\n".join(faults))
