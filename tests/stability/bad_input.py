#!/usr/bin/python3
"""Bad input ends with exit code 2 (a full disk: 1), one clear line that names place, found and expected, and nothing
lost of what was there before."""
import resource
import shutil
import sys

from program import CASE, folder, run

program = sys.argv[1]
faults = []


def expect(name, result, code, *words):
    lines = [line for line in result.stderr.splitlines() if line.startswith("pivnp: error:")]
    wrong = []
    if result.returncode != code:
        wrong.append(f"exit code {result.returncode}, expected {code}")
    if len(lines) != 1:
        wrong.append(f"{len(lines)} error lines, expected 1")
    for word in words:
        if not any(word in line for line in lines):
            wrong.append(f"'{word}' is not named")
    print(("FAIL " if wrong else "ok   ") + name + ": " + (lines[0] if lines else result.stderr.strip()[:300]))
    if wrong:
        faults.append(name + ": " + "; ".join(wrong))


def case(text):
    there = folder()
    (there / "case.toml").write_text(text)
    return there


def changed(old, new):
    assert old in CASE, old
    return case(CASE.replace(old, new))


good = case(CASE)
drawn = run(program, "synth", good, "--out", good / "drawn")
assert drawn.returncode == 0, drawn.stderr
frames = good / "drawn" / "frames"

# The case file.
for name, text, words in [
    ("unknown key", CASE.replace("window_px", "windw_px"), ["case.toml:12", "windw_px", "window_px"]),
    ("wrong type", CASE.replace("window_px = 32", 'window_px = "32"'), ["case.toml:12", "window_px", "string"]),
    ("unknown table", CASE.replace("[piv]", "[pivv]"), ["pivv", "piv"]),
    ("syntax", CASE.replace("[piv]", "[piv"), ["case.toml"]),
    ("negative constant", CASE.replace("young_pa = 1e6", "young_pa = -1e6"), ["young_pa", "-1"]),
    ("crossing polygon", CASE.replace("[0.13, 0.03], [0.13, 0.09]", "[0.13, 0.09], [0.13, 0.03]"), ["region.soil", "cross"]),
    ("no material", CASE.replace("[material.soil]", "[material.sail]"), ["soil", "sail"]),
    ("no file", None, ["no_such"]),
]:
    path = case(text) if text else good / "no_such"
    expect(name, run(program, "run", path, "--out", good / "o1"), 2, *words)

# The case against its frames.
for name, there, words in [
    ("grid larger than the image", changed("spacing_px = 16", "spacing_px = 16\narea_m = [[0.0, 0.0], [0.5, 0.1]]"), ["grid", "outside"]),
    ("spacing larger than the image", changed("spacing_px = 16", "spacing_px = 1600"), ["grid"]),
    ("region without an element", changed("[[0.03, 0.03], [0.13, 0.03], [0.13, 0.09], [0.03, 0.09]]",
                                          "[[1.0, 1.0], [1.1, 1.0], [1.1, 1.1]]"), ["region.soil"]),
    ("end before the first output", changed("[mpm]", "[mpm]\nend_s = 0.05\noutput_rate_hz = 10.0"), ["mpm.end_s: found 0.05 s", "0.1 s"]),
    ("not a square of particles", changed("[mpm]", "[np]\nper_element = 5\n[mpm]"), ["per_element", "5"]),
]:
    expect(name, run(program, "run", there, "--out", there / "out"), 2, *words)

expect("empty glob", run(program, "run", good, "--frames", str(good / "nothing_*.png"), "--out", good / "o2"), 2, "nothing_")

broken = folder()
for file in sorted(frames.iterdir()):
    shutil.copy(file, broken)
third = sorted(broken.glob("*.png"))[2]
third.write_bytes(third.read_bytes()[:2000])
expect("truncated frame", run(program, "run", good, "--frames", str(broken / "*.png"), "--out", good / "o3"), 2, third.name)

wide = changed("width_px = 160", "width_px = 176")
assert run(program, "synth", wide, "--out", wide / "drawn").returncode == 0
shutil.copy(wide / "drawn" / "frames" / "frame_00002.png", third)
expect("frames of two sizes", run(program, "run", good, "--frames", str(broken / "*.png"), "--out", good / "o4"), 2,
       third.name, "176", "160")

third.unlink()
expect("missing frame", run(program, "run", good, "--frames", str(broken / "frame_%05d.png"), "--out", good / "o5"), 2, "frame_00002.png")

# The command line.
expect("unknown command", run(program, "rnu", good), 2, "run")
expect("unknown flag", run(program, "run", good, "--thread", "2"), 2, "--thread")

# A full disk, as a limit on the size of files.
done = good / "done"
assert run(program, "run", good, "--out", done).returncode == 0
before = (done / "record.h5").read_bytes()


def small_files():
    import signal
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (30000, 30000))


full = run(program, "run", good, "--frames", str(frames / "*.png"), "--out", done, "--force", preexec_fn=small_files)
expect("full disk", full, 1, "done")
if (done / "record.h5").read_bytes() != before:
    faults.append("full disk: the former record was touched")

if faults:
    sys.exit("\n".join(faults))
