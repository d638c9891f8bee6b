"""Random scenes of random kind as cases (cases.py): a few hundred points, some hundreds of steps. Laws, schemes and water are drawn by
scripts/random-scene; here shapes, layers, walls anywhere, loads, bodies and scales are."""
import importlib.machinery
import importlib.util
import math
import pathlib

from cases import HEIGHTS, Map, sections

_path = pathlib.Path(__file__).parents[3] / "scripts" / "random-scene"
_loader = importlib.machinery.SourceFileLoader("random_scene", str(_path))
_loader_spec = importlib.util.spec_from_loader("random_scene", _loader)
random_scene = importlib.util.module_from_spec(_loader_spec)
_loader.exec_module(random_scene)
Dice, LAWS, SOILS, CELL = random_scene.Dice, random_scene.LAWS, random_scene.SOILS, random_scene.CELL

KINDS = ("column", "slope", "heap", "box", "incline", "flight", "cantilever")
ELASTIC = ("linear_elastic", "neo_hookean")


class Scene:
    """A case, and what was drawn of it: `h` the side of a cell, `height` that of the material, `kind`, `traits` (a set of words)."""

    def __init__(self, seed):
        self.seed, self.dice = seed, Dice(seed)
        dice = self.dice
        self.kind = dice.one_of(KINDS)
        self.traits = set()
        self.case = {"": {"name": f"scene {seed}: {self.kind}"}}
        self.width, self.rows = round(dice.between(8, 14)), round(dice.between(5, 10))
        self.h, self.height = CELL, self.rows * CELL
        self.margin = 3 + round(dice.between(0, 3))  # cells around the material
        wet = self.kind in ("column", "slope", "box") and dice.chance(0.3)
        self.water = random_scene.Water(seed, self.height) if wet else None
        if wet:
            self.traits.add("wet")
        self._regions()
        self._materials()
        self._numerics()
        self._walls()
        self._loads()
        self._put_on_the_grid()
        self._enlarge()

    # Lengths in cells from the lower left corner of the material, until the case is put on the grid.
    def _regions(self):
        dice, width, rows = self.dice, self.width, self.rows
        crest = {"slope": width * dice.between(0.3, 0.7), "heap": width * dice.between(0.2, 0.6)}.get(self.kind, width)
        start = (width - crest) / 2 if self.kind == "heap" else 0.0

        def side(y):  # x of the left and of the right face at a height
            return start * y / rows, width + ((start + crest) - width) * y / rows

        layers = dice.one_of([1, 1, 2, 2, 3]) if self.kind != "cantilever" else 1
        if self.kind == "cantilever":
            rows = self.rows = max(3, rows // 2)
            self.height = rows * CELL
        dip = dice.between(-1.2, 1.2) if layers > 1 and dice.chance(0.4) and self.kind == "box" else 0.0
        aligned = dice.chance(0.5)
        borders = [0.0] + [rows * n / layers for n in range(1, layers)] + [float(rows)]
        inner = [round(y) if aligned else round(y) + dice.between(0.55, 0.7) for y in borders[1:-1]]  # (on no row of points)
        borders[1:-1] = inner
        self.outlines = []
        for n, (low, high) in enumerate(zip(borders, borders[1:])):
            below, above = dip * (n > 0), dip * (n < layers - 1)
            self.outlines.append([[side(low)[0], low - below], [side(low)[1], low + below],
                                  [side(high)[1], high + above], [side(high)[0], high - above]])
        self.borders = borders
        if layers > 1:
            self.traits.add("layers")
        if dip:
            self.traits.add("dip")
        if self.kind == "flight" and dice.chance(0.5):  # two blocks that meet
            self.outlines, self.traits = self.outlines[:1], self.traits - {"layers"}
            gap = dice.between(0.2, 1.0)
            self.outlines.append([[x + width + gap, y] for x, y in self.outlines[0]])
        self.names = [f"part{n}" for n in range(len(self.outlines))]
        if self.kind == "flight" and len(self.names) > 1:
            self.traits.add("meeting")
        self.top = [side(rows)[0], side(rows)[1]]

    def _materials(self):
        dice = self.dice
        laws = {"cantilever": ELASTIC, "flight": ("linear_elastic", "neo_hookean", "von_mises")}.get(self.kind)
        laws = laws or (SOILS if self.water else LAWS)
        if dice.chance(0.35):
            laws = ELASTIC if not self.water else ("linear_elastic",)
        for name, outline in zip(self.names, self.outlines):
            self.case[f"region.{name}"] = {"polygon_m": outline}
        for name in self.names:
            entries = random_scene.material(dice, dice.one_of(laws))
            entries = self.water.of_material(entries) if self.water else entries
            self.case[f"material.{name}"] = {key: value for key, value in entries.items() if value is not None}
        self.laws = [self.case[f"material.{name}"]["model"] for name in self.names]
        if not set(self.laws) <= set(ELASTIC):
            self.traits.add("yields")
        if self.water:
            self.case["water"] = {key: value for key, value in self.water.entries().items() if value is not None}
            if self.water.level is not None:
                self.traits.add("level")

    def _numerics(self):
        dice = self.dice
        scheme = {key: value for key, value in random_scene.numerics(dice).items() if value is not None}
        if dice.chance(0.4):
            scheme = {}
        self.scheme = scheme
        settles = (not set(self.laws) & {"neo_hookean", "water"} and dice.chance(0.3) and self.kind in ("slope", "heap", "box"))
        if self.water and not settles:
            settles = self.water.level is not None
        if settles:
            self.traits.add("equilibrium")
        period = math.sqrt(self.height / 9.81)
        self.case["mpm"] = {**scheme, "per_element": dice.one_of([4, 4, 4, 9]), "gravity_m_s2": [0.0, -9.81],
                            "initial_equilibrium": settles, "end_s": 0.6 * period, "output_rate_hz": 10 / (0.6 * period),
                            "energy_limit": 10.0, "end_at_rest": False}
        if self.kind == "flight":
            self.case["mpm"]["gravity_m_s2"] = [dice.between(-3, 3), dice.between(-3, 3)]
            for n, name in enumerate(self.names):
                speed = dice.between(0.1, 0.6) * (1 - 2 * n)
                self.case[f"initial.{name}"] = {"velocity_m_s": [speed, dice.between(-0.2, 0.2)], "spin_rad_s": dice.between(-4, 4)}
        elif dice.chance(0.2) and not settles:
            self.case["mpm"]["gravity_m_s2"] = [dice.between(-3, 3), -9.81]
        elif dice.chance(0.15) and not self.water:
            self.case["mpm"] |= {"gravity_from_m_s2": [0.0, -4.9], "gravity_ramp_s": 0.4 * period}
        if len(self.names) > 1 and dice.chance(0.3):
            self.case["contact.joint"] = {"regions": [self.names[-1]], "friction": dice.one_of([0.0, dice.between(0.1, 0.7)])}
            self.traits.add("contact")

    def _wall(self, name, line, kind, **more):
        entries = {"line_m": line, "type": kind, **more}
        if kind == "frictional":
            entries["friction"] = self.dice.between(0.1, 0.6)
        if self.water:
            entries |= self.water.at_wall(self.height)
        self.case[f"boundary.{name}"] = entries

    def _walls(self):
        dice, width, rows, far = self.dice, self.width, self.rows, self.margin
        walls = ("fixed", "roller", "frictional")
        if self.kind in ("column", "slope", "heap", "box"):
            self._wall("base", [[-far if self.kind == "heap" else 0.0, 0.0],
                                [width + (0 if self.kind == "box" else far), 0.0]], dice.one_of(walls))
        if self.kind in ("column", "slope", "box"):
            self._wall("left", [[0.0, 0.0], [0.0, rows + far]], dice.one_of(("roller", "frictional")))
        if self.kind == "box":
            self._wall("right", [[width, 0.0], [width, rows + far]], dice.one_of(("roller", "frictional")))
        if self.kind == "cantilever":
            self._wall("left", [[0.0, -far], [0.0, rows + far]], "fixed")
        if self.kind == "incline":  # the whole scene is turned about its lower left corner, gravity is not
            self._wall("base", [[-far, 0.0], [width + far, 0.0]], dice.one_of(("fixed", "frictional")))
            if dice.chance(0.6):
                self.angle = math.radians(dice.between(-35, 35))
                self.traits.add("inclined")
        if self.kind == "column" and dice.chance(0.4):
            self.case["boundary.gate"] = {"line_m": [[width, 0.0], [width, rows + far]], "type": "roller", "until_s": 0.02}

    def _loads(self):
        dice = self.dice
        (left, right), rows = self.top, self.rows
        middle = (left + right) / 2
        if self.kind in ("box", "heap", "slope") and "contact" not in self.traits and dice.chance(0.4):
            self.case["boundary.load"] = {"line_m": [[left, rows], [right, rows]], "type": "traction",
                                          "traction_pa": [0.0, -dice.between(100, 400)], "rise_s": dice.one_of([0.0, 0.03]),
                                          "drained": True if self.water and dice.chance(0.5) else None}
            self.traits.add("load")
        elif self.kind in ("box", "heap", "slope", "column") and "projected" not in self.case["mpm"] and dice.chance(0.35):
            free = self.scheme.get("stress_update") != "usf" and dice.chance(0.5)
            radius = dice.between(2.2, 3.2)
            more = {"velocity_m_s": [0.0, dice.between(-0.6, -0.2)], "friction": dice.one_of([None, 0.0, 0.3]),
                    "mass_kg_m": dice.between(1.0, 3.0) * 1600 * math.pi * (radius * CELL)**2 if free else None}
            if dice.chance(0.5) or right - left < 4:
                self.case["body.tool"] = {"circle_m": [middle, rows + radius + 0.6, radius], **more}
            else:
                half = dice.between(0.2, 0.4) * (right - left)
                self.case["body.tool"] = {"polygon_m": [[middle - half, rows + 0.5], [middle + half, rows + 0.5],
                                                        [middle + half, rows + 3], [middle - half, rows + 3]], **more}
            self.traits.add("body")

    def _put_on_the_grid(self):
        """Lengths become metres; the corner lies on a node, or anywhere."""
        dice, far = self.dice, self.margin
        turn = getattr(self, "angle", 0.0)
        corner = [0.0, 0.0]
        if dice.chance(0.5):
            corner = [dice.between(0.05, 0.95) if dice.chance(0.7) else 0.0, dice.between(0.05, 0.95)]
            if self.kind != "flight":
                self.traits.add("between lines")
            for title in sections(self.case, "boundary"):
                self.case[title].pop("flux_m_s", None)  # (expects a line of nodes)

        def placed(point):
            x, y = point
            return [CELL * (corner[0] + x * math.cos(turn) - y * math.sin(turn)),
                    CELL * (corner[1] + x * math.sin(turn) + y * math.cos(turn))]

        for title, entries in self.case.items():
            entries = self.case[title] = {key: value for key, value in entries.items() if value is not None}
            for key in ("line_m", "polygon_m"):
                if key in entries:
                    entries[key] = [placed(point) for point in entries[key]]
            for key in HEIGHTS:
                if key in entries:
                    entries[key] += CELL * corner[1]
            if "level_history" in entries:
                entries["level_history"] = [[t, y + CELL * corner[1]] for t, y in entries["level_history"]]
            if "circle_m" in entries:
                entries["circle_m"] = [*placed(entries["circle_m"][:2]), CELL * entries["circle_m"][2]]
        points = [p for entries in self.case.values() for p in entries.get("polygon_m", [])]
        circles = [c for entries in self.case.values() for c in [entries.get("circle_m")] if c]
        points += [[x + r, y + r] for x, y, r in circles] + [[x - r, y - r] for x, y, r in circles]
        low = [math.floor(min(p[k] for p in points) / CELL) - far for k in (0, 1)]
        high = [math.ceil(max(p[k] for p in points) / CELL) + far for k in (0, 1)]
        self.case["grid"] = {"spacing_m": CELL, "area_m": [[CELL * v for v in low], [CELL * v for v in high]]}
        self.corner = [CELL * c for c in corner]

    def _enlarge(self):
        """Bench or field: the same dimensionless scene at another size."""
        if self.dice.chance(0.5):
            size = 10**self.dice.between(-0.5, 1.5)
            self.case = Map(scale=size).of_case(self.case)
            self.h, self.height = self.h * size, self.height * size
            self.corner = [c * size for c in self.corner]

    @property
    def walls(self):
        return [title for title in sections(self.case, "boundary") if self.case[title]["type"] != "traction"]
