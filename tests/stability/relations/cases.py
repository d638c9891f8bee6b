"""A case as a dictionary {section: {key: value}}, written as TOML, and moved, turned, mirrored and enlarged as a whole."""
import copy

import numpy as np

# Powers of a, by the unit at the end of a key: lengths x a, times x sqrt(a), stresses x a. Gravity and densities stay.
POWERS = {"m": 1, "s": 0.5, "m_s": 0.5, "m_s2": 0, "hz": -0.5, "per_s": -0.5, "rad_s": -0.5, "pa": 1, "pa_s": 1.5, "pa_m": 0,
          "kg_m3": 0, "kg_m": 2, "deg": 0}
POINTS = ("line_m", "polygon_m", "area_m")
VECTORS = ("velocity_m_s", "gravity_m_s2", "gravity_from_m_s2", "traction_pa", "withdraw_m_s", "normal")
HEIGHTS = ("level_m", "water_level_m")
# Scales that a law has if a case does not state them.
SCALES = {"mohr_coulomb_smooth": {"apex_pa": 10.0}}


def toml(case):
    """Every digit of every number, so that a partner differs by what was changed alone."""
    def text(value):
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, str):
            return f'"{value}"'
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(map(text, value)) + "]"
        return repr(value) if isinstance(value, int) else repr(float(value))
    lines = []
    for title, entries in case.items():
        lines += [f"\n[{title}]"] if title else []
        lines += [f"{key} = {text(value)}" for key, value in entries.items() if value is not None]
    return "\n".join(lines) + "\n"


def power(key):
    words = key.split("_")
    return next((POWERS["_".join(words[n:])] for n in range(1, len(words)) if "_".join(words[n:]) in POWERS), 0)


def sections(case, kind):
    return [title for title in case if title.split(".")[0] == kind]


def changed(case, changes):
    """A copy with entries replaced: {section: {key: value}}; None removes a key, and a section."""
    other = copy.deepcopy(case)
    for title, entries in changes.items():
        if entries is None:
            del other[title]
        else:
            other[title] = {key: value for key, value in {**other.get(title, {}), **entries}.items() if value is not None}
    return other


class Map:
    """x' = a (R x) + shift, with R a mirror image in x, then quarter turns."""

    def __init__(self, scale=1.0, quarter_turns=0, mirror=False, shift=(0.0, 0.0)):
        turn = np.array([[0, -1], [1, 0]])
        self.R = np.linalg.matrix_power(turn, quarter_turns) @ np.diag([-1 if mirror else 1, 1])
        self.scale, self.shift = scale, np.array(shift)

    def points(self, x):
        return self.scale * (np.asarray(x, float) @ self.R.T) + self.shift

    def of_case(self, case):
        other = copy.deepcopy(case)
        for title in sections(case, "material"):
            other[title] = {**SCALES.get(other[title].get("model"), {}), **other[title]}
        for title, entries in other.items():
            for key, value in entries.items():
                entries[key] = self._of_entry(key, value)
        return other

    def _of_entry(self, key, value):
        a = self.scale
        if key in POINTS:
            return self.points(value).tolist()
        if key in VECTORS:
            return (a**power(key) * (self.R @ np.array(value, float))).tolist()
        if key == "circle_m":
            return [*self.points(value[:2]).tolist(), a * value[2]]
        if key == "spin_rad_s":
            return round(np.linalg.det(self.R)) * a**power(key) * value
        if key in HEIGHTS:
            return a * value + self.shift[1]
        if key == "level_history":
            return [[a**0.5 * t, a * y + self.shift[1]] for t, y in value]
        exponent = power(key)
        return a**exponent * value if exponent else value

    def back(self, run):
        """A run of the mapped case, as one of the case itself."""
        R, a = self.R, self.scale
        stress = np.zeros(run.stress.shape[:-1] + (2, 2))
        stress[..., 0, 0], stress[..., 1, 1] = run.stress[..., 0], run.stress[..., 1]
        stress[..., 0, 1] = stress[..., 1, 0] = run.stress[..., 3]
        stress = R.T @ stress @ R / a
        other = copy.copy(run)
        other.x0 = (run.x0 - self.shift) @ R / a
        other.u, other.F, other.time = run.u @ R / a, R.T @ run.F @ R, run.time / a**0.5
        other.stress = np.stack([stress[..., 0, 0], stress[..., 1, 1], run.stress[..., 2] / a, stress[..., 0, 1]], axis=-1)
        other.pressure, other.area = None if run.pressure is None else run.pressure / a, run.area / a**2
        return other
