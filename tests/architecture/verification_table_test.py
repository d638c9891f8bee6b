#!/usr/bin/python3
"""scripts/verification-table: one row a case and source, ranges over cases of one test, a figure that misses in a row of its own."""
import pathlib
import subprocess
import sys
import tempfile

rows = [("cube, coarse, nu 0.1", "within .02", "0.98, 3 %", "Sides/Cube.Bears/a"),
        ("cube, fine, nu 0.1", "within .02", "1.01, 1 %", "Sides/Cube.Bears/b"),
        ("cube, fine, nu 0.4", "within .02", "1.05, 2 %, missed", "Sides/Cube.Bears/c"),
        *((f"dome, {k} m high, E {e} kPa", "stands", "1", f"Dome.Stands/{k}{e}") for k in (3, 20, 100) for e in (5, 9)),
        ("rod", "speed", "5", "Rod.Runs"), ("rod", "mass", "6", "Rod.Runs"),
        ("well, b = 4 a", "discharge", "2", "MpmWetAxis.SteadyFlowToAWell"), ("arch", "thrust", "1 .. 2, -1 .. 3 kN", "Arch.Holds"),
        *((f"set, {k}", f"rms px 0.0{k}, valid 9{k} %", f"rms px .00{k}, valid 100 %", "Table.Row") for k in range(1, 7))]
with tempfile.TemporaryDirectory() as folder:
    pathlib.Path(folder, "a.tsv").write_text("".join("\t".join(row) + "\n" for row in rows))
    page = subprocess.run([sys.argv[1], folder], capture_output=True, text=True, check=True).stdout
    empty = pathlib.Path(folder, "empty")
    empty.mkdir()
    refused = subprocess.run([sys.argv[1], empty], capture_output=True, text=True)
for line in ("| cube, coarse/fine, nu 0.1 | within 0.02 |  | 0.98–1.01, 1–3 % |",
             "| cube, fine, nu 0.4 | within 0.02 |  | 1.05, 2 %, missed |",
             "| rod | mass; speed |  | 6; 5 |",
             "| well, b = 4 a | discharge | Thiem 1906 | 2 |", "| dome, 3–100 m high, E 5/9 kPa | stands |  | 1 |", "| arch | thrust |  | 1–2, -1 to 3 kN |",
             "| set, 6 cases | rms px, valid %, each within its limit |  | 0.001–0.006, 100 (limits 0.01–0.06, 91–96) |"):
    if line not in page.splitlines():
        sys.exit(f"not in the table: {line}\n{page}")
if refused.returncode == 0:
    sys.exit("no rows are no error")
