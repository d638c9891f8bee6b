"""A finished record: what `pivnp run` and its single stages write."""
from __future__ import annotations

import dataclasses
import os
import pathlib
from typing import Any, Optional, Union

import numpy as np

from . import _core
from ._compare import Comparison
from ._motion import Motion


@dataclasses.dataclass(frozen=True)
class Pairs:
    """The vectors of all K pairs of frames on the grid of ny x nx nodes.

    displacement [K, ny, nx, 2] and x [nx], y [ny] in `length_unit`; status [K, ny, nx] (1 valid, 2 replaced); cov
    [K, ny, nx, 3] in length^2; score [K, ny, nx]; pair [K, 2] frames. Iterating gives the pairs one by one, as Vectors.
    """
    displacement: np.ndarray
    status: np.ndarray
    cov: np.ndarray
    score: np.ndarray
    pair: np.ndarray
    x: np.ndarray
    y: np.ndarray
    length_unit: str

    @property
    def mask(self) -> np.ndarray:
        """[K, ny, nx]: True where a vector may be used (valid or replaced)."""
        return (self.status == 1) | (self.status == 2)

    def to_xarray(self) -> Any:
        """An xarray.Dataset over pair, y and x."""
        from ._motion import _needed
        xarray = _needed("xarray", "python3-xarray")
        grid = ("pair", "y", "x")
        data = {"u": (grid, self.displacement[..., 0], {"units": self.length_unit}), "v": (grid, self.displacement[..., 1], {"units": self.length_unit}),
                "status": (grid, self.status), "score": (grid, self.score)}
        for k, name in enumerate(("cov_uu", "cov_vv", "cov_uv")):
            data[name] = (grid, self.cov[..., k], {"units": self.length_unit + "^2"})
        return xarray.Dataset(data, coords={"x": self.x, "y": self.y, "first": ("pair", self.pair[:, 0]), "second": ("pair", self.pair[:, 1])})


@dataclasses.dataclass(frozen=True)
class Remark:
    """text: one sentence or two; weight: note, doubt or unusable; id: of the kind of remark, empty where a stage of the run said it."""
    text: str
    weight: str
    id: str


class Record:
    """A record that is read when it is asked: record["np"], record["mpm"] are motions, record["piv"] the vectors.

    length_unit, time_unit; command and case (TOML with every default filled in) of the run; frames (names [F], times [F],
    flags [F]); energy of the simulation (columns by name); comparison, where one was made.
    """

    def __init__(self, file: pathlib.Path):
        self._core = _core.Record(str(file))
        self.file = file
        self.command: str = self._core.command
        self.case: str = self._core.case
        self.length_unit: str = self._core.length_unit
        self.time_unit: str = self._core.time_unit
        self.schema_version: str = self._core.schema_version
        #: Of a record that `pivnp.run` made: whether a limit of [compare.limits] was exceeded.
        self.limits_exceeded: Optional[bool] = None

    def __repr__(self) -> str:
        return f"<pivnp.Record {str(self.file)!r}: {', '.join(self.names)}>"

    @property
    def names(self) -> list[str]:
        """What the record holds: "piv", and its motions."""
        return (["piv"] if self._core.pair_count else []) + self._core.motion_names

    @property
    def frames(self) -> tuple[list[str], np.ndarray, np.ndarray]:
        names, times, flags = self._core.frames()
        return names, np.array(times), np.array(flags, dtype=np.uint8)

    @property
    def energy(self) -> dict[str, np.ndarray]:
        """Columns against `time`, J per metre of thickness; empty without a simulation."""
        return self._core.energy

    @property
    def remarks(self) -> list[Remark]:
        """What the run said of itself, and what its data say: lost steps, flagged particles, results that are not usable."""
        return [Remark(text, ("note", "doubt", "unusable")[weight], name) for text, weight, name in self._core.remarks()]

    @property
    def comparison(self) -> Optional[Comparison]:
        found = self._core.comparison
        return None if found is None else Comparison(found)

    def motion(self, name: str) -> Motion:
        return Motion(self._core.motion(name))

    def vectors(self, pair: int) -> _core.Vectors:
        """The vectors of one pair of frames."""
        count = self._core.pair_count
        return self._core.pair(pair + count if pair < 0 else pair)

    @property
    def pairs(self) -> Pairs:
        """All vectors, in memory."""
        found = [self._core.pair(k) for k in range(self._core.pair_count)]
        if not found:
            raise ValueError(f"{self.file}: holds no vectors")
        first = found[0]
        return Pairs(np.stack([v.displacement for v in found]), np.stack([v.status for v in found]), np.stack([v.cov for v in found]),
                     np.stack([v.score for v in found]), np.array([v.pair for v in found]), first.x, first.y, first.length_unit)

    def __getitem__(self, name: str) -> Union[Motion, Pairs]:
        return self.pairs if name == "piv" else self.motion(name)


def open_record(record: Union[str, os.PathLike[str]]) -> Record:
    """Opens a record.h5, or the folder that holds it. ValueError where it is missing, damaged, or no record."""
    file = pathlib.Path(record)
    return Record(file / "record.h5" if file.is_dir() else file)
