"""The material point method: a simulation from a dictionary that mirrors a case."""
from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from typing import Any, Optional, Union

from . import _core
from ._motion import Motion
from ._options import settings as _settings
from ._options import to_toml


class Solver:
    """Plane strain, explicit, as `pivnp simulate` runs it, with the same bits for any number of threads.

    case      a dictionary with the sections of a case (docs/case.md), {"grid": {"spacing_m": 0.01, ...}, "region": {"sand":
              {...}}, "material": {...}, "mpm": {...}, "boundary": {...}}; or the path of a case that only simulates
    threads   0: all cores
    options   keys that win over the case's: mpm={"end_s": 0.2}

    ValueError for what the case would be refused for.
    """

    def __init__(self, case: Union[Mapping[str, Any], str, os.PathLike[str]], threads: int = 0, **options: Any):
        given = _settings(options)
        if isinstance(case, Mapping):
            self._core = _core.Solver(to_toml(case), "", given, threads)
        else:
            self._core = _core.Solver("", os.fspath(case), given, threads)

    def advance_to(self, time: float) -> None:
        """Steps to `time` (s) exactly. The first call finds the initial equilibrium, where the case asks for it."""
        self._core.advance_to(time)

    @property
    def frame(self) -> _core.Frame:
        """The present state: frame["u"] [P, 2], frame["F"] [P, 2, 2], frame["v"] [P, 2], frame["stress"] [P, 4] ..."""
        return self._core.frame()

    def run(self, times: Optional[Iterable[float]] = None) -> Motion:
        """Steps through `times` (s; default: mpm.output_rate_hz up to mpm.end_s, from 0) and gives the motion at them."""
        if times is None:
            if self._core.end_s is None or self._core.rate_hz is None:
                raise ValueError("times: left out, expected them or mpm.end_s and mpm.output_rate_hz in the case")
            rate = self._core.rate_hz
            times = [k / rate for k in range(math.floor(self._core.end_s * rate + 1e-9) + 1)]
        return Motion(self._core.run([float(t) for t in times]))

    @property
    def time(self) -> float:
        """The present time, s."""
        return self._core.time

    @property
    def steps(self) -> int:
        """The number of steps made so far."""
        return self._core.steps

    @property
    def stable_step(self) -> float:
        """The time step in use, s."""
        return self._core.stable_step

    @property
    def at_rest(self) -> bool:
        """Whether motion has ended."""
        return self._core.at_rest

    @property
    def energy(self) -> dict[str, float]:
        """The balance now, J per metre of thickness: kinetic, elastic, plastic, damping, contact, external, residual."""
        return self._core.energy

    @property
    def case(self) -> str:
        """The case as TOML with every default filled in."""
        return self._core.case

    def save(self) -> bytes:
        """The whole state, for load() of a solver of the same case: it goes on with the same bits."""
        return self._core.save()

    def load(self, state: bytes) -> None:
        self._core.load(state)

    def __len__(self) -> int:
        return len(self._core)
