"""How far two motions are apart."""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _core
from ._motion import Motion, _needed, open_motion
from ._options import to_toml


class Metric(NamedTuple):
    """One number of a comparison.

    verdict: "" (no difference, or its uncertainty is not known), "agrees" (within within_95), "differs" (by more than all
    that is uncertain), "larger than the measurement's error" (the mesh's or the inputs' is not known), "not resolved"
    (by lost_in), "no verdict" (too little was compared).
    """
    name: str
    value: float
    unit: str
    uncertainty: float  # standard uncertainty; NaN where it is not known
    definition: str
    verdict: str
    within_95: float  # of a difference: the least tolerance within which it is shown to lie with 95 %; else NaN
    seen_95: float  # of a difference: a real one of this size would have been found in 95 of 100 cases; else NaN
    limit: str = ""  # "met" or "exceeded", of a limit that was stated
    lost_in: str = ""  # of a difference that is not resolved: "measurement", "mesh" or "inputs"
    u_num: float = float("nan")  # what the mesh adds to the uncertainty; NaN: not known
    u_input: float = float("nan")  # what the model's inputs add


class Limit(NamedTuple):
    key: str
    limit: float
    reached: float
    met: bool


@dataclasses.dataclass(frozen=True)
class ComparedField:
    """A field on those particles of the first motion that found a partner: values [T, N], NaN where there is none any more."""
    name: str
    unit: str
    definition: str
    time: np.ndarray
    id: np.ndarray
    values: np.ndarray


@dataclasses.dataclass(frozen=True)
class Table:
    """Columns of one length, with their units."""
    name: str
    definition: str
    columns: dict[str, np.ndarray]
    units: dict[str, str]

    def to_pandas(self) -> Any:
        frame = _needed("pandas", "python3-pandas").DataFrame(self.columns)
        frame.attrs["units"] = self.units
        return frame


class Comparison:
    """metrics, fields and tables by name; limits that were given; remarks, one sentence each."""

    def __init__(self, found: dict[str, Any]):
        self.metrics: dict[str, Metric] = {row[0]: Metric(*row) for row in found["metrics"]}
        self.fields: dict[str, ComparedField] = {row[0]: ComparedField(*row) for row in found["fields"]}
        self.tables: dict[str, Table] = {name: Table(name, text, {c[0]: c[2] for c in columns}, {c[0]: c[1] for c in columns})
                                         for name, text, columns in found["tables"]}
        self.limits: list[Limit] = [Limit(*row) for row in found["limits"]]
        self.remarks: list[str] = found["remarks"]

    def __getitem__(self, name: str) -> Metric:
        return self.metrics[name]

    def to_pandas(self) -> Any:
        """The metrics as a pandas.DataFrame, indexed by name."""
        rows = list(self.metrics.values())
        return _needed("pandas", "python3-pandas").DataFrame(rows, columns=Metric._fields).set_index("name")

    def __repr__(self) -> str:
        return f"<pivnp.Comparison of {len(self.metrics)} metrics>"


def _core_motion(source: Any, step: float, length_unit: str) -> _core.Motion:
    if isinstance(source, Motion):
        return source._core
    return open_motion(os.fspath(source), step, length_unit)._core


def compare(first: Union[Motion, str, os.PathLike[str]], second: Union[Motion, str, os.PathLike[str]], *,
            coarser: Iterable[Union[Motion, str]] = (), refinement: float = 2.0, limits: Optional[Mapping[str, float]] = None,
            step: float = 1.0, length_unit: str = "m", **options: Any) -> Comparison:
    """Second minus first, at the first's particles and times, beside the standard uncertainty of each.

    first, second  motions, or what names them: "RECORD.h5:np", "cbgeo=run/particles*.h5" (see open_motion for step and length_unit)
    coarser        the second on coarser grids, the finer one first; refinement: ratio of their spacings
    limits         any key of [compare.limits]: {"displacement_rms_m": 1e-3}
    options        any key of [compare]: slope_base_m=0.0, time_alignment="onset" ...

    ValueError where nothing can be compared, as `pivnp compare` says it.
    """
    toml = to_toml({"compare": {**options, "limits": dict(limits or {})}})
    return Comparison(_core.compare(_core_motion(first, step, length_unit), _core_motion(second, step, length_unit), toml,
                                    [_core_motion(c, step, length_unit) for c in coarser], refinement))
