"""Numerical particles through vectors."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Optional

import numpy as np

from . import _core
from ._motion import Motion
from ._options import to_toml


class Tracker:
    """Numerical particles (Pinyol & Alvarado 2017) that are carried through measured increments, pair by pair.

    vectors   those of the first pair: their grid is seeded. They are not applied yet: call step() with them
    regions   outlines [n, 2] of material at the first frame by name; left out, the whole grid
    x0        [P, 2]: places of particles of your own, in place of seeding
    time      of the first frame, in `time_unit`
    options   any key of [np]: per_element=4, shape="bilinear", error_correlation=1.0 ...
    """

    def __init__(self, vectors: _core.Vectors, *, regions: Optional[Mapping[str, Any]] = None, x0: Any = None, time: float = 0.0,
                 time_unit: str = "frame", **options: Any):
        outlines = [(name, np.asarray(outline, dtype=float)) for name, outline in (regions or {}).items()]
        toml = to_toml({"np": options, "frames": {"path": "arrays"}})
        self._core = _core.Tracker(toml, vectors, outlines, None if x0 is None else np.asarray(x0, dtype=float), float(time), time_unit)

    def step(self, vectors: _core.Vectors, time: Optional[float] = None) -> None:
        """Moves all particles through one pair, to `time` (default: one more than now)."""
        self._core.step(vectors, self.time + 1.0 if time is None else float(time))

    @property
    def time(self) -> float:
        """The time of the last frame reached."""
        return self._core.time

    def __len__(self) -> int:
        return len(self._core)

    @property
    def frame(self) -> _core.Frame:
        """The present state: frame["u"] [P, 2], frame["F"] [P, 2, 2], frame["status"] [P], frame["cov_u"] [P, 3]."""
        return self._core.frame()

    def motion(self) -> Motion:
        """The motion so far, the first frame included: fields by name, strains among them."""
        return Motion(self._core.motion())
