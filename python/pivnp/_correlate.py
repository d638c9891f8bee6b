"""Image correlation on arrays."""
from __future__ import annotations

from typing import Any, Optional

from . import _core
from ._options import to_toml


class Correlator:
    """Correlates pairs of images of one size; keeps plans and buffers, so that many pairs cost less than single calls. For the
    frames of one sequence, `sequence` is more accurate.

    shape             (rows, columns) of the images
    window            side of the last interrogation window, px (8 to 256)
    spacing           distance of the nodes, px (left out: a quarter of the window)
    method            "default", "gn", "fast", "fft", "ncc" ... (docs/piv.md)
    metres_per_pixel  scale; left out, lengths are in px
    mask              [rows, columns] of bool or uint8: pixels that may be used
    threads           0: all cores; never changes a result
    camera, grid      more keys of those sections of a case, as dictionaries
    options           any key of [piv]: anchor="forward", min_score=0.2 ...

    ValueError, as the command says it, for a key or a value that the case would refuse.
    """

    def __init__(self, shape: tuple[int, int], *, window: int = 32, spacing: Optional[float] = None, method: str = "default",
                 metres_per_pixel: Optional[float] = None, mask: Any = None, threads: int = 0, camera: Optional[dict[str, Any]] = None,
                 grid: Optional[dict[str, Any]] = None, **options: Any):
        given = {"camera": {"metres_per_pixel": metres_per_pixel, **(camera or {})}, "grid": {"spacing_px": spacing, **(grid or {})},
                 "piv": {"window_px": window, "method": method, **options}, "frames": {"path": "arrays"}}
        rows, columns = shape
        self._core = _core.Correlator(to_toml(given), int(columns), int(rows), mask, threads)
        self._pairs = 0

    def __call__(self, first: Any, second: Any, *, white: float = 0.0) -> _core.Vectors:
        """Vectors from the first image to the second: [rows, columns] of uint8, uint16 or float32, which are not copied.

        white: grey value of full scale (0: that of the type, 1 for float32).
        """
        found = self._core.correlate(first, second, white, (self._pairs, self._pairs + 1))
        self._pairs += 1
        return found

    def sequence(self, frames: Any, *, white: float = 0.0) -> list[_core.Vectors]:
        """Vectors of all pairs of consecutive frames, as `pivnp run` measures them: the dense methods smooth pairs together with
        their neighbours in time (docs/theory/piv.md), which single calls cannot.

        frames: images as the call takes them, all in memory; not copied. ValueError for an image of another size.
        """
        return self._core.sequence(list(frames), white)


def correlate(first: Any, second: Any, *, window: int = 32, spacing: Optional[float] = None, method: str = "default",
              metres_per_pixel: Optional[float] = None, mask: Any = None, white: float = 0.0, threads: int = 0,
              camera: Optional[dict[str, Any]] = None, grid: Optional[dict[str, Any]] = None, **options: Any) -> _core.Vectors:
    """Displacement increments from one image to another at the nodes of a regular grid.

    first, second: [rows, columns] of uint8, uint16 or float32, which are not copied. The other arguments are those of
    Correlator and of its call. Gives Vectors: displacement [ny, nx, 2] (x to the right, y up), status [ny, nx] (1 valid), cov
    [ny, nx, 3] of the random error, score [ny, nx], x [nx] and y [ny].
    """
    shape = memoryview(first).shape
    if len(shape) != 2:
        raise ValueError(f"first: found an array of {' x '.join(map(str, shape))}, expected rows x columns of grey values")
    correlator = Correlator((shape[0], shape[1]), window=window, spacing=spacing, method=method, metres_per_pixel=metres_per_pixel, mask=mask,
                            threads=threads, camera=camera, grid=grid, **options)
    return correlator(first, second, white=white)


def _to_pandas(self: _core.Vectors) -> Any:
    """A pandas.DataFrame, one row per node."""
    import numpy as np

    from ._motion import _needed
    pandas = _needed("pandas", "python3-pandas")
    x, y = np.meshgrid(self.x, self.y)
    columns = {"x": x.ravel(), "y": y.ravel(), "u": self.displacement[..., 0].ravel(), "v": self.displacement[..., 1].ravel(),
               "status": self.status.ravel(), "score": self.score.ravel()}
    if self.cov is not None:
        columns.update({name: self.cov[..., k].ravel() for k, name in enumerate(("cov_uu", "cov_vv", "cov_uv"))})
    frame = pandas.DataFrame(columns)
    frame.attrs["unit"] = self.length_unit
    return frame


def _to_xarray(self: _core.Vectors) -> Any:
    """An xarray.Dataset over y and x."""
    from ._motion import _needed
    xarray = _needed("xarray", "python3-xarray")
    data = {"u": (("y", "x"), self.displacement[..., 0], {"units": self.length_unit}),
            "v": (("y", "x"), self.displacement[..., 1], {"units": self.length_unit}), "status": (("y", "x"), self.status),
            "score": (("y", "x"), self.score)}
    if self.cov is not None:
        data.update({name: (("y", "x"), self.cov[..., k], {"units": self.length_unit + "^2"})
                     for k, name in enumerate(("cov_uu", "cov_vv", "cov_uv"))})
    return xarray.Dataset(data, coords={"x": self.x, "y": self.y})


def _plot(self: _core.Vectors, ax: Any = None, **quiver: Any) -> Any:
    """Arrows at the nodes whose vectors may be used, on their lengths. Gives the matplotlib axes."""
    from ._plot import plot_vectors
    return plot_vectors(self, ax, quiver)


_core.Vectors.mask = property(lambda self: (self.status == 1) | (self.status == 2), doc="[ny, nx]: True where a vector may be used (valid or replaced).")
_core.Vectors.to_pandas = _to_pandas
_core.Vectors.to_xarray = _to_xarray
_core.Vectors.plot = _plot
_core.Vectors.__repr__ = lambda self: f"<pivnp.Vectors {self.status.shape[0]} x {self.status.shape[1]}, {int((self.status == 1).sum())} valid, in {self.length_unit}>"
