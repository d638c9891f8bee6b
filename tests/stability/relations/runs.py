"""What a simulation left, and how far two of them are apart."""
import h5py
import numpy as np

FOLLOWED = 1


class Run:
    """A record. u, F, stress, pressure: [T][P]...; pressure is None without water."""

    def __init__(self, record):
        with h5py.File(record) as file:
            motion = file["motion/mpm"]
            self.time, self.x0, self.area = motion["time"][:], motion["x0"][:], motion["area"][:].astype("f8")
            self.status = motion["status"][:]
            self.u, self.F, self.stress = (motion[name][:].astype("f8") for name in ("u", "F", "stress"))
            self.pressure = motion["pressure"][:].astype("f8") if "pressure" in motion else None
            names = [name.decode() if isinstance(name, bytes) else name for name in motion["label_name"][:]]
            self.region = np.array(names)[motion["label"][:]]

    def of_points(self, chosen):
        other = object.__new__(Run)
        other.__dict__ = {**self.__dict__, "x0": self.x0[chosen], "area": self.area[chosen], "region": self.region[chosen]}
        for name in ("status", "u", "F", "stress", "pressure"):
            values = getattr(self, name)
            setattr(other, name, None if values is None else values[:, chosen])
        return other

    def at_times(self, chosen):
        other = object.__new__(Run)
        other.__dict__ = {**self.__dict__, "time": self.time[chosen]}
        for name in ("status", "u", "F", "stress", "pressure"):
            values = getattr(self, name)
            setattr(other, name, None if values is None else values[chosen])
        return other


def paired(run, other, h):
    """The other's points in this one's order; those that this one does not have are left out. None: one has no partner."""
    order = np.empty(len(run.x0), int)
    for first in range(0, len(order), 500):
        part = run.x0[first:first + 500]
        distance = np.abs(part[:, None] - other.x0[None]).max(axis=2)
        order[first:first + 500] = distance.argmin(axis=1)
        if distance.min(axis=1).max() > 1e-3 * h:
            return None
    return other.of_points(order) if len(set(order)) == len(order) else None


def point_by_point(run, other, h):
    """Greatest difference of a displacement, gradient, stress or pressure of any point at any time, over the greatest of its kind."""
    other = paired(run, other, h)
    if other is None or run.u.shape != other.u.shape or (run.status != other.status).any():
        return 1.0
    followed = run.status == FOLLOWED
    found = 0.0
    for name, least in (("u", 1e-6 * h), ("F", 1.0), ("stress", 0.0), ("pressure", 0.0)):
        values, others = getattr(run, name), getattr(other, name)
        if values is None or others is None:
            continue
        values, others = values[followed], others[followed]
        scale = max(np.abs(values).max(initial=0), least)
        if scale > 0:
            found = max(found, np.abs(values - others).max(initial=0) / scale)
    return found


def blocks(run, h, side=2.0):
    """Displacements [T][blocks][2] at the centres of blocks of `side` cells at the start (of the plane through their points), the
    blocks' areas, and which they are: where points lie in a block does not matter in a field that changes little over it."""
    keys, index = np.unique(np.floor(run.x0 / (side * h) + 0.013).astype(int), axis=0, return_inverse=True)
    index = index.ravel()
    area = np.bincount(index, run.area)
    values = np.empty((len(run.u), len(keys), 2))
    for n, key in enumerate(keys):
        of = np.flatnonzero(index == n)
        plane = np.column_stack([np.ones(len(of)), run.x0[of] / (side * h) - (key + 0.487)])
        values[:, n] = (np.linalg.pinv(plane, rcond=1e-3)[0] @ run.u[:, of]) if len(of) else 0
    return {tuple(key): n for n, key in enumerate(keys)}, area, values


def block_by_block(run, other, h):
    """Root mean square difference of the blocks' displacements over all times, over that of the displacements."""
    (keys, area, u), (keys2, area2, u2) = blocks(run, h), blocks(other, h)
    full = (2 * h)**2
    both = [key for key in keys if key in keys2 and area[keys[key]] > 0.4 * full and area2[keys2[key]] > 0.4 * full]
    if not both or len(u) != len(u2):
        return 1.0
    one, two = [keys[key] for key in both], [keys2[key] for key in both]
    weight = area[one][None, :, None]
    scale = (weight * u[:, one]**2).sum()
    return float(np.sqrt((weight * (u[:, one] - u2[:, two])**2).sum() / max(scale, 1e-300)))
