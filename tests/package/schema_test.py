"""The JSON schema of cases: itself valid, every case of datasets/ passes, what `pivnp init` and a record write passes, and what the
program refuses for its key, type, range or choice does not.

usage: schema_test.py PIVNP SOURCE_FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed: skipped")
    sys.exit(77)

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
schema = json.loads((source / "docs/case.schema.json").read_text())
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)


def faults(text):
    return [error.message for error in validator.iter_errors(tomllib.loads(text))]


cases = sorted((source / "datasets").glob("*/*.toml"))
assert len(cases) > 10, cases
for case in cases:
    assert not faults(case.read_text()), (case, faults(case.read_text()))

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    for k in range(2):
        (folder / f"f{k}.pgm").write_bytes(b"P5 64 48 255\n" + bytes(64 * 48))
    subprocess.run([program, "init", str(folder / "f*.pgm"), "--out", folder / "lab", "--quiet"], check=True, capture_output=True)
    text = (folder / "lab/case.toml").read_text()
    assert not faults(text), faults(text)
    named = text.splitlines()[0].removeprefix("#:schema ")
    assert json.loads(pathlib.Path(named).read_text()) == schema, named

for wrong in ("[piv]\nwindow_px = 7", "[piv]\nwindw_px = 32", "[pv]\n", "[piv]\nwindow_px = 32.5", "[piv]\nmethod = 'nope'", "[np]\nseeding = 'evem'",
              "[camera]\norigin_px = [1]", "[region.a]\npolygon_m = [[0, 0], [1]]", "[material.a]\nyoung_pa = -1", "[piv]\nreplace = 1", "name = 3"):
    assert faults(wrong), wrong
print(f"{len(cases)} cases follow the schema")
