"""The Python module: the same bits as the program, nothing copied, the interpreter free, Ctrl-C, and the program's messages.

usage: PYTHONPATH=build/release/python module_test.py [unittest's arguments]
"""
import ast
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import pivnp
from pivnp import _core

CASE = """
name = "small"
[frames]
rate_hz = 10.0
[camera]
metres_per_pixel = 0.001
[grid]
spacing_px = 16
[region.soil]
polygon_m = [[0.03, 0.03], [0.13, 0.03], [0.13, 0.09], [0.03, 0.09]]
[piv]
window_px = 32
closure = 0
[material.soil]
model = "linear_elastic"
density_kg_m3 = 2000.0
young_pa = 1e6
poisson = 0.3
[mpm]
[boundary.base]
line_m = [[0.0, 0.032], [0.16, 0.032]]
[synth]
motion = "affine"
width_px = 160
height_px = 128
frames = 4
gradient_per_frame = [0.01, 0.02, 0.0, -0.01]
shift_px_per_frame = [1.5, 0.5]
"""
BLOCK = {
    "grid": {"spacing_m": 0.02, "area_m": [[0, 0], [0.12, 0.16]]},
    "region": {"soil": {"polygon_m": np.array([[0, 0], [0.08, 0], [0.08, 0.08], [0, 0.08]])}},
    "material": {"soil": {"model": "mohr_coulomb", "density_kg_m3": 1500.0, "young_pa": 1e6, "friction_deg": np.float64(35), "tension_pa": 100.0,
                          "cohesion_pa": 1000.0}},
    "mpm": {"end_s": 0.02, "output_rate_hz": 100.0},
    "boundary": {"base": {"line_m": [[0, 0], [0.12, 0]]}},
}
# A column that falls for long.
LONG = {**BLOCK, "grid": {"spacing_m": 0.002, "area_m": [[0, 0], [0.16, 0.1]]},
        "mpm": {"end_s": 1000.0, "output_rate_hz": 1.0, "initial_equilibrium": False, "end_at_rest": False},
        "boundary": {"base": {"line_m": [[0, 0], [0.16, 0]]}, "left": {"line_m": [[0, 0], [0, 0.1]], "type": "roller"}}}


class Module(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        (cls.folder / "case.toml").write_text(CASE)
        cls.record = pivnp.run(cls.folder / "case.toml", out=cls.folder / "out", threads=2)
        frames = cls.folder / "out" / "frames"
        cls.images = [pivnp.read_image(file) for file in sorted(str(f) for f in frames.iterdir() if f.suffix in (".png", ".tif"))]

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def same(self, one, two):
        one, two = np.asarray(one), np.asarray(two)
        self.assertEqual(one.dtype, two.dtype)
        self.assertEqual(one.tobytes(), two.tobytes())

    def measured(self):
        correlate = pivnp.Correlator(self.images[0].shape, window=32, spacing=16, metres_per_pixel=0.001, closure=0, threads=1)
        return correlate.sequence(self.images)

    def test_vectors_have_the_program_s_bits(self):
        self.assertEqual(len(self.images), 4)
        for k, vectors in enumerate(self.measured()):
            expected = self.record.vectors(k)
            for name in ("displacement", "cov", "score", "x", "y"):
                self.same(getattr(vectors, name), getattr(expected, name))
            material = expected.status != 5  # outside: known once particles were followed
            self.same(vectors.status[material], expected.status[material])
            self.assertTrue(10 < material.sum() < material.size, material.sum())
            self.assertEqual(vectors.pair, expected.pair)
        self.assertTrue((vectors.status == 1).sum() > 20)
        # One pair by itself is that of a sequence of two frames.
        alone = pivnp.run(self.folder / "case.toml", out=self.folder / "two", threads=1, synth={"frames": 2}).vectors(0)
        two = [pivnp.read_image(str(f)) for f in sorted((self.folder / "two" / "frames").glob("*.png"))]
        self.same(pivnp.correlate(*two, window=32, spacing=16, metres_per_pixel=0.001).displacement, alone.displacement)
        correlator = pivnp.Correlator(self.images[0].shape, window=32, spacing=16)
        with self.assertRaisesRegex(ValueError, "^frame: found "):
            correlator.sequence([self.images[0], self.images[0][:64]])

    def test_particles_have_the_program_s_bits(self):
        vectors = self.measured()
        soil = {"soil": [[0.03, 0.03], [0.13, 0.03], [0.13, 0.09], [0.03, 0.09]]}
        tracker = pivnp.Tracker(vectors[0], regions=soil, time_unit="s")
        for k, pair in enumerate(vectors):
            tracker.step(pair, self.record.frames[1][k + 1])
        ours, theirs = tracker.motion(), self.record["np"]
        self.assertGreater(len(tracker), 40)
        for name in ("id", "x0", "time", "end_reason"):
            self.same(getattr(ours, name), getattr(theirs, name))
        self.same(ours.area.astype("f4"), theirs.area.astype("f4"))  # as records hold it
        for name in ("u", "F", "status", "cov_u", "strain_dev", "velocity_x", "strain_dev_path"):
            self.same(ours[name].values, theirs[name].values)
        self.assertEqual(ours["velocity_x"].unit, "m/s")
        self.assertGreater(ours["strain_xx"].mask.mean(), 0.8)
        self.assertAlmostEqual(float(np.nanmedian(ours.values("strain_xx", -1))), 0.03, delta=0.006)

    def test_simulations_have_the_program_s_bits(self):
        lines = pivnp.mpm.Solver(BLOCK).case
        (self.folder / "block.toml").write_text(lines)
        record = pivnp.run(self.folder / "block.toml", command="simulate", out=self.folder / "block", mpm={"courant": 0.3})
        solver = pivnp.mpm.Solver(BLOCK, threads=1, mpm={"courant": 0.3})
        motion, expected = solver.run(), record["mpm"]
        self.assertEqual(len(motion), 3)
        for name in ("u", "F", "v", "stress", "status"):
            self.same(motion[name].values, expected[name].values)
        self.same(solver.frame["stress"], expected.values("stress", -1))
        self.assertEqual(solver.energy["elastic"], record.energy["elastic"][-1])
        again = pivnp.mpm.Solver(self.folder / "block.toml", mpm={"courant": 0.3})
        again.load(solver.save())
        again.advance_to(0.03)
        solver.advance_to(0.03)
        self.same(again.frame["u"], solver.frame["u"])

    def test_remarks_are_those_of_the_program(self):
        done = subprocess.run([os.environ.get("PIVNP_PROGRAM", "pivnp"), "report", str(self.record.file), "--out", str(self.folder / "again")],
                              capture_output=True, text=True, env=dict(os.environ, QT_QPA_PLATFORM="offscreen"))
        remarks = self.record.remarks
        self.assertTrue(remarks)
        for remark in remarks:
            self.assertIn({"note": "note: ", "doubt": "warning: ", "unusable": "warning: "}[remark.weight] + remark.text + "\n", done.stdout)

    def test_comparisons_have_the_program_s_bits(self):
        expected = self.record.comparison
        for first, second in ((self.record["np"], self.record["mpm"]), (f"{self.record.file}:np", f"{self.record.file}:mpm")):
            found = pivnp.compare(first, second)
            self.assertEqual(found.metrics.keys(), expected.metrics.keys())
            for name, metric in expected.metrics.items():
                self.same(found[name].value, metric.value)
                self.same(found[name].uncertainty, metric.uncertainty)
                self.same(found[name].within_95, metric.within_95)
                self.same(found[name].seen_95, metric.seen_95)
        rms = found["displacement_rms"]
        if rms.uncertainty > 0:
            self.assertAlmostEqual(rms.within_95, abs(rms.value) + 1.645 * rms.uncertainty)
            self.assertAlmostEqual(rms.seen_95, (2 + 1.645) * rms.uncertainty)
        self.assertTrue(np.isnan(found["coverage_first"].seen_95))
        self.assertGreater(found["displacement_rms"].value, 0)
        limited = pivnp.compare(self.record["np"], self.record["mpm"], limits={"displacement_rms_m": 1e-9})
        self.assertEqual([limit.met for limit in limited.limits], [False])

    def test_limits_are_no_error(self):
        self.assertFalse(self.record.limits_exceeded)
        exceeded = pivnp.run(self.folder / "case.toml", out=self.folder / "limited", **{"compare.limits.displacement_rms_m": 1e-9})
        self.assertTrue(exceeded.limits_exceeded)
        self.assertIn("displacement_rms_m = 1e-09", exceeded.case)

    def test_results_are_not_copied(self):
        vectors = self.measured()[0]
        for array, again in ((vectors.displacement, vectors.displacement), (vectors.cov, vectors.cov)):
            self.assertTrue(np.shares_memory(array, again))
            self.assertFalse(array.flags.writeable)
        self.same(pivnp.Correlator((160, 128)[::-1], spacing=16, metres_per_pixel=0.001).sequence(self.images)[0].displacement, vectors.displacement)
        kept = vectors.displacement
        before = kept.copy()
        del vectors
        self.same(kept, before)  # the array keeps its memory

    def test_images_are_not_copied(self):
        side = 2048
        image = np.random.default_rng(1).integers(0, 255, (side, 2 * side), dtype=np.uint8)[:, :side]  # rows with a gap between them
        with self.assertRaisesRegex(ValueError, "first: found pixels 2 bytes apart"):
            pivnp.correlate(image[:, ::2], image[:, ::2])
        mask = np.zeros((side, side), dtype=bool)
        mask[:64, :64] = True
        found = pivnp.correlate(image, image, mask=mask, method="fft")
        self.assertEqual(set(np.unique(found.status[-2:, :2])) & {1}, {1})
        self.assertTrue((found.status[:-8] == 0).all())
        borrowed = memoryview(np.ascontiguousarray(image[:200, :300]))
        self.assertEqual(pivnp.correlate(borrowed, borrowed).status.shape[1], pivnp.correlate(image[:200, :300], image[:200, :300]).status.shape[1])

    def test_the_interpreter_is_free_meanwhile(self):
        solver = pivnp.mpm.Solver(LONG)
        counted = []

        def work():
            solver.advance_to(solver.stable_step * 300)

        thread = threading.Thread(target=work)
        thread.start()
        while thread.is_alive():
            counted.append(time.monotonic())
            time.sleep(0.001)
        self.assertGreater(len(counted), 20)
        self.assertLess(max(np.diff(counted)), 0.5 * (counted[-1] - counted[0]))

    def interrupted_by(self, seconds, work):
        timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
        begun = time.monotonic()
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            work()
        timer.join()
        return time.monotonic() - begun

    def test_ctrl_c_stops_a_simulation(self):
        solver = pivnp.mpm.Solver(LONG)
        self.assertLess(self.interrupted_by(0.3, lambda: solver.advance_to(1000.0)), 20)
        self.assertLess(solver.time, 1000.0)

    def test_ctrl_c_stops_the_program(self):
        from pivnp._options import to_toml
        (self.folder / "long.toml").write_text(to_toml(LONG))
        self.interrupted_by(0.5, lambda: pivnp.run(self.folder / "long.toml", command="simulate", out=self.folder / "long"))

    def test_errors_are_the_program_s_lines(self):
        file = self.folder / "wrong.toml"
        file.write_text("[piv]\nwindow_px = 7\n")
        said = subprocess.run([pivnp._run.program(), "track", file], capture_output=True, text=True).stderr
        with self.assertRaises(ValueError) as caught:
            pivnp.run(file, command="track")
        self.assertEqual(said, f"pivnp: error: {caught.exception}\n")
        line = str(caught.exception)
        with self.assertRaises(ValueError) as caught:
            pivnp.correlate(*self.images[:2], window=7)
        self.assertTrue(line.endswith(str(caught.exception)), (line, str(caught.exception)))
        for wrong in (lambda: pivnp.open(self.folder / "none"), lambda: pivnp.correlate(*self.images[:2], windw_px=3),
                      lambda: pivnp.mpm.Solver({**BLOCK, "mpm": {"end": 3}}), lambda: pivnp.mpm.Solver({"frames": {"path": "x"}}),
                      lambda: pivnp.correlate(self.images[0], self.images[1].astype(float)), lambda: self.record["nothing"],
                      lambda: self.record["np"]["nothing"], lambda: pivnp.Vectors(np.zeros((3, 4))),
                      lambda: pivnp.correlate(self.images[0], self.images[1][:-1])):
            with self.assertRaises(ValueError) as caught:
                wrong()
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaises(RuntimeError):
            pivnp.run(self.folder / "case.toml", out="/proc/nowhere")

    def test_without_numpy_one_line_says_so(self):
        code = "import sys; sys.modules['numpy'] = None\nimport pivnp"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("python3-numpy", done.stderr.splitlines()[-1])

    def test_stubs_name_what_there_is(self):
        tree = ast.parse((pathlib.Path(_core.__file__).parent / "_core.pyi").read_text())
        classes = {node.name: {f.name for f in node.body if isinstance(f, ast.FunctionDef)} for node in tree.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        values = {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)} | {"__version__"}
        own = {name for name in vars(_core) if not name.startswith("__")} | {"__version__"}
        self.assertEqual(own, set(classes) | functions | values)
        plain = {"__getitem__", "__len__"}
        for name, members in classes.items():
            there = {m for m in vars(getattr(_core, name)) if not m.startswith("_") or m in plain}
            self.assertEqual(there, members - {"__init__"}, name)

    def test_public_names_tell_what_they_are(self):
        for name in pivnp.__all__:
            thing = getattr(pivnp, name)
            self.assertTrue(name == "__version__" or (thing.__doc__ or "").strip(), name)

    def test_vectors_of_one_s_own(self):
        displacement = np.zeros((5, 6, 2), dtype=np.float32)
        displacement[..., 0] = 0.25
        displacement[2, 3] = np.nan
        vectors = pivnp.Vectors(displacement, origin=(1, 2), spacing=(0.5, 0.5), length_unit="mm", anchor="forward")
        self.assertEqual((vectors.x[-1], vectors.y[-1], int(vectors.status[2, 3])), (3.5, 4.0, 4))
        tracker = pivnp.Tracker(vectors, x0=[[2.0, 2.5]])
        tracker.step(vectors)
        self.assertEqual(tracker.frame["u"].tolist(), [[0.25, 0.0]])

    def test_values_at_places_of_a_record(self):
        motion = self.record["np"]
        particle = int(np.flatnonzero(np.isnan(motion.end))[0])
        at = motion.at([motion.x0[particle], [9, 9]])
        for name in ("u", "strain_dev", "sigma_displacement_x", "sigma_strain_dev"):
            np.testing.assert_allclose(at.values(name, -1)[0], motion.values(name, -1)[particle], rtol=2e-5, atol=1e-9)
        self.assertEqual(list(at["status"].values[:, 1]), [0] * len(motion))
        self.assertAlmostEqual(float(at.values("sigma_displacement_x", -1)[0]), float(np.sqrt(motion.values("cov_u", -1)[particle, 0])), places=9)
        lower, upper = (0.05, 0.04), (0.11, 0.08)
        inside = ((motion.x0 >= lower) & (motion.x0 <= upper)).all(axis=1) & (motion.values("status", -1) < 3)
        mean = motion.mean(upper, lower)
        np.testing.assert_allclose(mean.values("u", -1)[0], np.average(motion.values("u", -1)[inside], axis=0, weights=motion.area[inside]), rtol=1e-5)
        sigma = motion.values("sigma_displacement_x", -1)[inside]
        self.assertTrue(sigma.mean() / np.sqrt(inside.sum()) < mean.values("sigma_displacement_x", -1)[0] <= np.sqrt((sigma**2).mean()))
        time, strain, error = motion.extensometer((0.05, 0.06), (0.11, 0.06))
        self.same(time, motion.time)
        self.assertAlmostEqual(strain[-1], 0.03, delta=0.006)
        self.assertTrue(0 < error[-1] < 0.01)
        distance, value, error = motion.section("displacement_x", (0.05, 0.06), (0.11, 0.06))
        self.assertAlmostEqual(distance[-1], 0.06)
        self.assertTrue(np.isfinite(value).all() and (error > 0).all())
        self.assertAlmostEqual((value[-1] - value[0]) / 0.06, 0.03, delta=0.01)
        self.assertGreater(np.nanstd(motion.values("strain_xx", -1)), 0)
        self.assertTrue(np.isfinite(motion.with_gauge(0.03).values("strain_xx", -1)).any())
        with self.assertRaisesRegex(ValueError, "^diameter: found 0, "):
            motion.with_gauge(0)

    def test_to_xarray_and_pandas(self):
        try:
            import pandas  # noqa: F401
            import xarray  # noqa: F401
        except ImportError:
            self.skipTest("python3-pandas and python3-xarray are not installed")
        motion = self.record["np"]
        array = motion["strain_dev"].to_xarray()
        self.assertEqual((array.dims, array.attrs["units"]), (("time", "particle"), "1"))
        self.assertEqual(set(motion.to_xarray()), set(motion.recorded) - {"status"})
        table = motion.to_pandas()
        self.assertEqual(len(table), motion["u"].values.shape[0] * len(motion.id))
        self.assertIn("F_xy", table.columns)
        self.same(table["u_x"].to_numpy(), motion["u"].values[..., 0].ravel())
        self.assertEqual(self.record.vectors(0).to_xarray().u.shape, self.record["piv"].to_xarray().u.shape[1:])
        self.assertEqual(len(self.record.vectors(0).to_pandas()), self.record.vectors(0).status.size)
        self.assertIn("displacement_rms", self.record.comparison.to_pandas().index)

    def test_plots(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("python3-matplotlib is not installed")
        matplotlib.use("Agg")
        for draw in (self.record["np"].plot, self.record.vectors(0).plot, self.record["np"]["u"].plot):
            axes = draw()
            axes.figure.savefig(self.folder / "figure.png")
            self.assertIn("(m)", axes.get_xlabel())


if __name__ == "__main__":
    unittest.main()
