#!/usr/bin/python3
"""scripts/check-links finds what is missing: links, headings, files, keys; and nothing where all is there."""
import pathlib
import subprocess
import sys
import tempfile

script = sys.argv[1]
with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder)
    (root / "docs").mkdir()
    (root / "mpm").mkdir()
    (root / "mpm/step.hpp").write_text('// docs/a.md, "Energy balance"\n')
    (root / "docs/case.md").write_text("## [piv]\n- `window_px` (number): side\n## [synth.piv]\nKeys: those of [piv].\n")
    page = root / "docs/a.md"
    page.write_text("# Energy balance\n[a](case.md) [b](#energy-balance) `mpm/step.hpp` `step.hpp` `piv.window_px = 32` `synth.piv.window_px`\n")

    def faults():
        done = subprocess.run([sys.executable, script, folder], capture_output=True, text=True)
        return done.returncode, len(done.stdout.splitlines())

    assert faults() == (0, 1), faults()  # one line: how many files were looked through
    page.write_text(page.read_text() + "[c](none.md)\n[d](#none)\n`mpm/none.hpp`\n`none.hpp`\n`piv.none`\n")
    (root / "mpm/none.txt").write_text('docs/none.md\ndocs/a.md, "None"\n')
    assert faults() == (1, 7), faults()
