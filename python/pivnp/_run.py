"""The program itself, from Python."""
from __future__ import annotations

import os
import pathlib
import shutil
import signal
import subprocess
import sys
from typing import Any, Optional, Union

from ._options import settings as _settings
from ._record import Record, open_record


def program() -> str:
    """The program `pivnp`: that of PIVNP_PROGRAM, of this package, of the build this package lies in, or of PATH."""
    here = pathlib.Path(__file__).resolve().parent
    for found in (os.environ.get("PIVNP_PROGRAM"), here / "bin" / "pivnp", here.parents[1] / "bin" / "pivnp"):
        if found and os.access(found, os.X_OK):
            return str(found)
    found = shutil.which("pivnp")
    if not found:
        raise RuntimeError("the program pivnp was not found; expected it in PATH, or its path in PIVNP_PROGRAM")
    return found


def run(case: Union[None, str, os.PathLike[str]] = None, *, command: str = "run", out: Union[None, str, os.PathLike[str]] = None,
        frames: Union[None, str, os.PathLike[str]] = None, resume: bool = False, force: bool = False, threads: int = 0, progress: bool = False,
        **settings: Any) -> Record:
    """Runs a case and gives its record.

    case      a case's file, or a folder with a case.toml (left out: the built-in slope behind a gate)
    command   "run" for the whole chain, or a stage: "piv", "track", "simulate"
    out       folder for the results (left out: out/<name of the case's folder>)
    frames    frames in place of the case's
    resume    continue the interrupted run in `out`
    force     replace a finished record in `out`
    progress  show the program's progress and notes on standard error
    settings  keys that win over the case's: piv={"window_px": 24}, or **{"piv.window_px": 24}

    ValueError for bad input and RuntimeError for a run that failed, with the program's line. Ctrl-C lets the program close what
    it writes (resume=True continues from there). A limit that is exceeded is no error: see Record.limits_exceeded.
    """
    words = [program(), command] + ([os.fspath(case)] if case is not None else [])
    for key in _settings(settings):
        words += ["--set", key]
    if out is not None:
        words += ["--out", os.fspath(out)]
    if frames is not None:
        words += ["--frames", os.fspath(frames)]
    if resume:
        words.append("--resume")
    if force:
        words.append("--force")
    if threads > 0:
        words += ["--threads", str(threads)]
    # In a group of its own: the terminal's Ctrl-C comes to Python, which passes it on once (twice would end the program at once).
    child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=None if progress else subprocess.PIPE, text=True, start_new_session=True)
    interrupted = False
    while True:
        try:
            said, complained = child.communicate()
            break
        except KeyboardInterrupt:
            interrupted = True
            child.send_signal(signal.SIGINT)
    if interrupted or child.returncode == 130:
        raise KeyboardInterrupt
    if child.returncode not in (0, 3):
        mark = "pivnp: error: "
        lines = [line[len(mark):] for line in (complained or "").splitlines() if line.startswith(mark)]
        line = lines[-1] if lines else f"pivnp ended with exit code {child.returncode}"
        raise (ValueError if child.returncode == 2 else RuntimeError)(line)
    record = open_record(next(line for line in said.splitlines() if line.endswith("record.h5")))
    record.limits_exceeded = child.returncode == 3
    return record


def main() -> None:
    """The command `pivnp` of a wheel: the program that lies in it."""
    os.execv(program(), ["pivnp", *sys.argv[1:]])
