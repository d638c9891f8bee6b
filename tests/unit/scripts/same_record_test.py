"""scripts/same-record on tiny records: what it calls the same, what it calls different, and its exit codes.

usage: same_record_test.py SAME_RECORD
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np


def write(path, change=None):
    """A record in small: series with a NaN, texts, an empty dataset, a virtual one. `change` edits it at the end."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with h5py.File(path, "w") as file:
        file.attrs["created"] = "2026-01-31T12:00:00Z"
        file["case"] = "name = 'tiny'"
        motion = file.create_group("motion/mpm")
        u = np.linspace(0, 1, 24, dtype="f4").reshape(3, 4, 2)
        u[1, 2, 0] = np.nan
        motion["u"] = u
        motion["u"].attrs["unit"] = "m"
        motion["status"] = np.ones((3, 4), "u1")
        motion["label_name"] = ["sand", "clay"]
        motion["nothing"] = np.zeros((0, 2))
        layout = h5py.VirtualLayout(shape=(4, 2), dtype="f4")
        layout[:] = h5py.VirtualSource(".", "motion/mpm/u", shape=(3, 4, 2))[1]
        file.create_virtual_dataset("xdmf/u/000001", layout)
        if change:
            change(file)


class SameRecord(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        write(self.path / "a.h5")

    def compare(self, *arguments):
        done = subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True)
        return done.returncode, done.stdout.splitlines()[:-1]  # the last line is a sum

    def differing(self, change, *options):
        """Exit code, and the paths named, where the second record was changed."""
        write(self.path / "b.h5", change)
        code, lines = self.compare(*options, self.path / "a.h5", self.path / "b.h5")
        return code, sorted(line.split()[1] for line in lines)

    def test_equal_records_with_nan_are_the_same(self):
        self.assertEqual(self.differing(None, "--attributes"), (0, []))

    def test_a_nan_of_other_bits_is_the_same(self):
        def change(file):
            u = file["motion/mpm/u"][:]
            u.view("u4")[1, 2, 0] ^= 1
            file["motion/mpm/u"][:] = u
        self.assertEqual(self.differing(change), (0, []))

    def test_one_bit_differs(self):
        def change(file):
            u = file["motion/mpm/u"][:]
            u.view("u4")[2, 3, 1] ^= 1
            file["motion/mpm/u"][:] = u
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/u"]))

    def test_the_sign_of_zero_differs(self):
        def change(file):
            file["motion/mpm/u"][0, 0, 0] = -0.0
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/u"]))

    def test_a_number_against_nan_differs(self):
        def change(file):
            file["motion/mpm/u"][1, 2, 0] = 0.5
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/u", "/xdmf/u/000001"]))

    def test_texts_differ(self):
        def change(file):
            file["motion/mpm/label_name"][1] = "silt"
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/label_name"]))

    def test_missing_and_added_datasets_are_named(self):
        def change(file):
            del file["motion/mpm/status"]
            file["motion/mpm/stress"] = np.zeros(3)
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/status", "/motion/mpm/stress"]))

    def test_shape_and_type_differ(self):
        def change(file):
            for name, data in (("u", np.zeros((3, 4))), ("status", np.ones((3, 4), "i4"))):
                del file["motion/mpm/" + name]
                file["motion/mpm/" + name] = data
            del file["xdmf/u/000001"]
        self.assertEqual(self.differing(change), (1, ["/motion/mpm/status", "/motion/mpm/u", "/xdmf/u/000001"]))

    def test_a_view_of_other_values_differs(self):
        def change(file):
            del file["xdmf/u/000001"]
            layout = h5py.VirtualLayout(shape=(4, 2), dtype="f4")
            layout[:] = h5py.VirtualSource(".", "motion/mpm/u", shape=(3, 4, 2))[2]
            file.create_virtual_dataset("xdmf/u/000001", layout)
        self.assertEqual(self.differing(change), (1, ["/xdmf/u/000001"]))

    def test_attributes_count_where_asked_for(self):
        def change(file):
            file.attrs["created"] = "2026-01-31T12:00:05Z"
            file["motion/mpm/u"].attrs["unit"] = "px"
        self.assertEqual(self.differing(change), (0, []))
        self.assertEqual(self.differing(change, "--attributes"), (1, ["/@created", "/motion/mpm/u@unit"]))
        self.assertEqual(self.differing(change, "--attributes", "--ignore", "/@*"), (1, ["/motion/mpm/u@unit"]))

    def test_what_is_ignored_is_left_out(self):
        def change(file):
            file["case"][...] = "name = 'other'"
        self.assertEqual(self.differing(change), (1, ["/case"]))
        self.assertEqual(self.differing(change, "--ignore", "/case"), (0, []))

    def test_folders_are_compared_record_by_record(self):
        first, second = self.path / "first", self.path / "second"
        write(first / "one" / "record.h5")
        write(first / "two" / "record.h5")
        write(second / "one" / "record.h5")
        code, lines = self.compare(first, second)
        self.assertEqual((code, [line.split()[0] for line in lines]), (1, ["two/record.h5"]))
        write(second / "two" / "record.h5")
        self.assertEqual(self.compare(first, second), (0, []))

    def test_what_cannot_be_read_is_an_error_of_its_own(self):
        (self.path / "text.h5").write_text("no record")
        self.assertEqual(self.compare(self.path / "a.h5", self.path / "text.h5")[0], 2)
        self.assertEqual(self.compare(self.path / "a.h5", self.path / "none.h5")[0], 2)
        self.assertEqual(self.compare(self.path / "a.h5")[0], 2)


tool = sys.argv.pop(1)
unittest.main()
