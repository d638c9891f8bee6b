"""From lab video to a verdict on a simulation: PIV, numerical particles, the material point method, and their comparison.

    record = pivnp.open("out/lab")                  what `pivnp run` wrote
    vectors = pivnp.correlate(a, b, window=32)      displacement of one image against another
    tracker = pivnp.Tracker(vectors)                numerical particles through such vectors
    solver = pivnp.mpm.Solver({...})                a simulation from a dictionary that mirrors a case
    pivnp.compare(first, second)                    how far two motions are apart
    pivnp.run("case.toml", piv={"window_px": 24})   the whole program

The world has x to the right and y up; tension is positive; every result states its unit. Engines work on numpy arrays without
copying images or results and without the interpreter's lock. Bad input is a ValueError with the line that the command
prints, a run that fails a RuntimeError, Ctrl-C a KeyboardInterrupt.
"""

try:
    import numpy as _numpy  # noqa: F401
except ImportError as _error:
    raise ImportError("pivnp needs numpy, which is not installed (apt install python3-numpy, or pip install numpy)") from _error

from . import mpm
from ._core import Frame, Vectors, __version__, read_image
from ._compare import Comparison, Metric, Table, compare
from ._correlate import Correlator, correlate
from ._motion import Field, Motion, open_motion
from ._record import Record, Remark, open_record as open
from ._run import run
from ._track import Tracker

__all__ = ["Comparison", "Correlator", "Field", "Frame", "Metric", "Motion", "Record", "Remark", "Table", "Tracker", "Vectors", "__version__",
           "compare", "correlate", "mpm", "open", "open_motion", "read_image", "run"]
