"""Motions of particles, and their fields as arrays with unit, coordinates and status."""
from __future__ import annotations

import dataclasses
from typing import Any, Optional, Union

import numpy as np

from . import _core

_COMPONENTS = {"u": ("x", "y"), "v": ("x", "y"), "cov_u": ("uu", "vv", "uv"), "stress": ("xx", "yy", "zz", "xy")}


def _needed(module: str, package: str) -> Any:
    import importlib
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"this needs {module}, which is not installed (apt install {package}, or pip install {module})") from error


@dataclasses.dataclass(frozen=True)
class Field:
    """One quantity of particles at some times.

    values      [T, P, ...]; a computed field is NaN where a particle is not there
    time        [T], in `time_unit`
    position    [T, P, 2], in `length_unit`: where the particles are
    status      [T, P]: 0 unborn, 1 active, 2 flagged, 3 ended
    """
    name: str
    unit: str
    definition: str
    values: np.ndarray
    time: np.ndarray
    time_unit: str
    position: np.ndarray
    length_unit: str
    status: np.ndarray
    id: np.ndarray

    @property
    def mask(self) -> np.ndarray:
        """[T, P]: True where the particle is followed (active or flagged)."""
        return (self.status == 1) | (self.status == 2)

    @property
    def shape(self) -> tuple[int, ...]:
        return self.values.shape

    def __array__(self, dtype: Any = None) -> np.ndarray:
        return np.asarray(self.values, dtype=dtype)

    def __len__(self) -> int:
        return len(self.values)

    def to_xarray(self) -> Any:
        """An xarray.DataArray over time and particle, with x, y and status as coordinates."""
        xarray = _needed("xarray", "python3-xarray")
        more = [f"{self.name}_{k}" for k in range(self.values.ndim - 2)]
        coordinates = {"time": self.time, "particle": self.id, "x": (("time", "particle"), self.position[..., 0]),
                       "y": (("time", "particle"), self.position[..., 1]), "status": (("time", "particle"), self.status)}
        array = xarray.DataArray(self.values, dims=["time", "particle", *more], coords=coordinates, name=self.name,
                                 attrs={"units": self.unit, "long_name": self.definition})
        array["x"].attrs["units"] = array["y"].attrs["units"] = self.length_unit
        array["time"].attrs["units"] = self.time_unit
        return array

    def to_pandas(self) -> Any:
        """A pandas.DataFrame, one row a time and particle, indexed by both."""
        pandas = _needed("pandas", "python3-pandas")
        index = pandas.MultiIndex.from_product([self.time, self.id], names=["time", "particle"])
        count = len(self.time) * len(self.id)
        columns = {"x": self.position[..., 0].reshape(count), "y": self.position[..., 1].reshape(count), "status": self.status.reshape(count)}
        flat = self.values.reshape(count, -1)
        names = _COMPONENTS.get(self.name) or (("xx", "xy", "yx", "yy") if self.name == "F" else tuple(str(k) for k in range(flat.shape[1])))
        for k in range(flat.shape[1]):
            columns[self.name if flat.shape[1] == 1 else f"{self.name}_{names[k]}"] = flat[:, k]
        frame = pandas.DataFrame(columns, index=index)
        frame.attrs["unit"] = self.unit
        return frame

    def plot(self, frame: int = -1, ax: Any = None, **scatter: Any) -> Any:
        """Particles at one time, coloured by the field (of a vector, its length). Gives the matplotlib axes."""
        from ._plot import plot_particles
        return plot_particles(self, frame, ax, scatter)


class Motion:
    """The motion of P particles at T times: measured ("np"), simulated ("mpm"), or of another program.

    motion["u"]            a Field over all times: recorded (`recorded`) or computed (`computed`: strain_dev, velocity_x ...)
    motion.field("u", -1)  the same at one time, or at those of a list or slice
    x0 [P, 2], area [P]    material positions and represented areas; id, label [P]; born, end [P] times
    """

    def __init__(self, core: _core.Motion):
        self._core = core
        self.name: str = core.name
        self.length_unit: str = core.length_unit
        self.time_unit: str = core.time_unit
        self.time: np.ndarray = core.time
        self.id: np.ndarray = core.id
        self.label: np.ndarray = core.label
        self.label_names: list[str] = core.label_names
        self.x0: np.ndarray = core.x0
        self.area: np.ndarray = core.area
        self.born: np.ndarray = core.born
        self.end: np.ndarray = core.end
        self.end_reason: np.ndarray = core.end_reason

    @property
    def recorded(self) -> list[str]:
        """Fields that are held: u, F, status ..."""
        return self._core.recorded()

    @property
    def computed(self) -> list[str]:
        """Fields that follow from those held: displacement_magnitude, strain_dev, velocity_x ..."""
        return self._core.computed(self.recorded)

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        return f"<pivnp.Motion {self.name!r}: {len(self.id)} particles at {len(self.time)} times>"

    def _frames(self, frames: Union[None, int, slice, list[int], np.ndarray]) -> list[int]:
        count = len(self.time)
        if frames is None:
            return list(range(count))
        if isinstance(frames, slice):
            return list(range(count))[frames]
        return [int(k) + (count if k < 0 else 0) for k in np.atleast_1d(frames)]

    def field(self, name: str, frames: Union[None, int, slice, list[int], np.ndarray] = None) -> Field:
        """A field by name at all times, at one, or at those of a slice or list; the first axis is that of the times."""
        chosen = self._frames(frames)
        position = self.x0[None, :, :] + self._core.values("u", chosen)
        return Field(name, self._core.unit(name), self._core.definition(name), self._core.values(name, chosen), self.time[chosen],
                     self.time_unit, position, self.length_unit, self._core.values("status", chosen), self.id)

    def __getitem__(self, name: str) -> Field:
        return self.field(name)

    def values(self, name: str, frame: Optional[int] = None) -> np.ndarray:
        """The numbers alone: [T, P, ...], or [P, ...] at one time."""
        found = self._core.values(name, self._frames(frame))
        return found if frame is None else found[0]

    def at(self, points: Any) -> "Motion":
        """At material points of the first frame: a Motion with one particle a point. Fields sigma_... are standard uncertainties."""
        return Motion(self._core.at([tuple(map(float, p)) for p in points]))

    def mean(self, corner: Any, opposite: Any) -> "Motion":
        """The mean over the particles that start in a rectangle, as a Motion of one particle."""
        return Motion(self._core.mean(tuple(map(float, corner)), tuple(map(float, opposite))))

    def with_gauge(self, diameter: float) -> "Motion":
        """The same motion with strains over circles of another diameter."""
        return Motion(self._core.with_gauge(float(diameter)))

    def extensometer(self, start: Any, end: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times, strain of the line between two material points of the first frame, and its standard uncertainty."""
        return self._core.extensometer(tuple(map(float, start)), tuple(map(float, end)))

    def section(self, name: str, start: Any, end: Any, frame: int = -1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance, value and standard uncertainty of a field along a line in space, of the nearest particles."""
        return self._core.section(name, tuple(map(float, start)), tuple(map(float, end)), self._frames(frame)[0])

    def plot(self, name: str = "displacement_magnitude", frame: int = -1, ax: Any = None, **scatter: Any) -> Any:
        """Particles at one time, coloured by a field. Gives the matplotlib axes."""
        return self.field(name, frame).plot(0, ax, **scatter)

    def to_xarray(self, names: Optional[list[str]] = None) -> Any:
        """An xarray.Dataset of fields (default: all that are recorded)."""
        xarray = _needed("xarray", "python3-xarray")
        chosen = names or [n for n in self.recorded if n != "status"]
        return xarray.merge([self[n].to_xarray() for n in chosen], compat="override", combine_attrs="drop")

    def to_pandas(self, names: Optional[list[str]] = None) -> Any:
        """A pandas.DataFrame of fields (default: all that are recorded), one row a time and particle."""
        chosen = names or [n for n in self.recorded if n != "status"]
        frame = self[chosen[0]].to_pandas()
        for name in chosen[1:]:
            more = self[name].to_pandas()
            for column in more.columns.difference(["x", "y", "status"], sort=False):
                frame[column] = more[column]
        return frame


def open_motion(source: str, step: float = 1.0, length_unit: str = "m") -> "Motion":
    """One motion as the command line names it: "RECORD.h5:np", or another program's results, "cbgeo=run/particles*.h5".

    step: time from one file's number to the next where files only count them; length_unit: of another program's lengths.
    """
    return Motion(_core.open_motion(str(source), step, length_unit))
