"""Figures with matplotlib, which is looked for only when one is asked for."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._motion import _needed

if TYPE_CHECKING:
    from . import _core
    from ._motion import Field


def _axes(ax: Any) -> Any:
    pyplot = _needed("matplotlib.pyplot", "python3-matplotlib")
    if ax is None:
        ax = pyplot.figure(layout="constrained").gca()
    ax.set_aspect("equal")
    return ax


def plot_particles(field: Field, frame: int, ax: Any, scatter: dict[str, Any]) -> Any:
    ax = _axes(ax)
    values = np.asarray(field.values[frame], dtype=float)
    if values.ndim == 2:
        values = np.linalg.norm(values, axis=1)
    elif values.ndim > 2:
        raise ValueError(f"field: found {field.name!r}, a tensor, expected numbers or vectors to plot")
    shown = field.mask[frame] & np.isfinite(values)
    style = {"s": 4, "linewidths": 0, **scatter}
    points = ax.scatter(field.position[frame, shown, 0], field.position[frame, shown, 1], c=values[shown], **style)
    unit = f" ({field.unit})" if field.unit not in ("", "1") else ""
    ax.figure.colorbar(points, ax=ax, label=field.name + unit)
    ax.set(xlabel=f"x ({field.length_unit})", ylabel=f"y ({field.length_unit})", title=f"{field.time[frame]:g} {field.time_unit}")
    return ax


def plot_vectors(vectors: _core.Vectors, ax: Any, quiver: dict[str, Any]) -> Any:
    ax = _axes(ax)
    used = (vectors.status == 1) | (vectors.status == 2)
    u, v = (np.where(used, vectors.displacement[..., k], np.nan) for k in (0, 1))
    colours = ax.pcolormesh(vectors.x, vectors.y, np.hypot(u, v), shading="nearest")
    ax.figure.colorbar(colours, ax=ax, label=f"displacement ({vectors.length_unit})")
    ax.quiver(vectors.x, vectors.y, u, v, **{"angles": "xy", "color": "white", **quiver})
    ax.set(xlabel=f"x ({vectors.length_unit})", ylabel=f"y ({vectors.length_unit})")
    return ax
