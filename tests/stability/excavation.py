"""A case with an excavation simulates and reports, and its record says why particles ended."""
import sys

import h5py

from program import folder, run

CASE = """
name = "excavation"
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.08, 0.16]]
[region.below]
polygon_m = [[0.0, 0.0], [0.08, 0.0], [0.08, 0.06], [0.0, 0.06]]
[region.above]
polygon_m = [[0.0, 0.06], [0.08, 0.06], [0.08, 0.12], [0.0, 0.12]]
[material.below]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
poisson = 0.3
[material.above]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
poisson = 0.3
removed_s = 0.01
[mpm]
end_s = 0.02
output_rate_hz = 100.0
[boundary.base]
line_m = [[0.0, 0.0], [0.08, 0.0]]
"""

program = sys.argv[1]
scratch = folder()
(scratch / "case.toml").write_text(CASE)
for arguments in (["simulate", scratch / "case.toml", "--out", scratch / "out"], ["report", scratch / "out"]):
    ran = run(program, *arguments)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (scratch / "out" / "report.html").exists()
with h5py.File(scratch / "out" / "record.h5") as record:
    reason, label = (record["motion/mpm/" + name][:] for name in ("end_reason", "label"))
    names = [n.decode() for n in record["motion/mpm/label_name"][:]]
    assert ((reason == 5) == (label == names.index("above"))).all() and (reason == 5).any(), reason
print("ok")
