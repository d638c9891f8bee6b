#!/usr/bin/python3
"""What hostile files make the program open, allocate or write: pipes and devices in place of every file that is read,
sealed records and segments that lead to other files, names that are paths or control characters, links in the folder
of the results, and files of some kilobytes that ask for gigabytes. All end with exit code 2 and one line, or do no harm.
"""
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import zlib

import h5py
import numpy

from program import CASE, folder, run, seeded
from seal import seal

program = sys.argv[1]
rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 1
random = seeded()
faults = []
SECRET = "the secret of another file"
MEMORY = 3 << 30  # bytes of data that a child may have; sanitizers need no more than the program for it
here = folder()


def limited():
    resource.setrlimit(resource.RLIMIT_CPU, (60, 70))
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def tried(*arguments, **more):
    try:
        return run(program, *arguments, timeout=60, preexec_fn=limited, **more)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(arguments, "none: it waits for ever", "", "")


def refused(name, result, *words):
    lines = [line for line in result.stderr.splitlines() if line]
    wrong = [] if result.returncode == 2 else [f"exit code {result.returncode}, expected 2"]
    if len(lines) != 1 or not lines[0].startswith("pivnp: error: "):
        wrong.append(f"{len(lines)} lines, expected one: " + result.stderr[:300])
    wrong += [f"'{word}' is not named" for word in words if word not in result.stderr]
    if re.search("unknown (command|option)", result.stderr):
        wrong.append("nothing was tested")
    if SECRET in result.stderr + result.stdout:
        wrong.append("the secret was told")
    if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", result.stderr + result.stdout):
        wrong.append("control characters were printed")
    if wrong:
        faults.append(name + ": " + "; ".join(wrong))
    print("FAIL" if wrong else "ok  ", name, ":", lines[0][:160] if lines else "")


MEASURED = CASE[:CASE.index("[material.soil]")]
SIMULATED = ('name = "s"\n[grid]\nspacing_m = 0.02\narea_m = [[0.0, 0.0], [0.08, 0.16]]\n[region.soil]\n'
             'polygon_m = [[0.0, 0.0], [0.08, 0.0], [0.08, 0.12], [0.0, 0.12]]\n[material.soil]\nmodel = "linear_elastic"\n'
             'density_kg_m3 = 1500.0\nyoung_pa = 1e6\n[mpm]\nend_s = 0.01\noutput_rate_hz = 100.0\n'
             '[boundary.base]\nline_m = [[0.0, 0.0], [0.08, 0.0]]\n')
(here / "synth.toml").write_text(MEASURED + CASE[CASE.index("[synth]"):].replace("frames = 5", "frames = 3"))
made = run(program, "track", here / "synth.toml", "--out", here / "whole", "--quiet", "--threads", "1")
assert made.returncode == 0, made.stderr
record = here / "whole" / "record.h5"
frame = here / "whole" / "frames" / "frame_00000.png"


def case(name, text):
    file = here / f"{name}.toml"
    file.write_text(text)
    return file


# Pipes and devices.
def pipe(at):
    os.mkfifo(at)


def zeros(at):
    at.symlink_to("/dev/zero")


def frames_with(odd, at):
    there = here / f"frames{random.randrange(10**9)}"
    there.mkdir()
    for k in range(3):
        if k == at:
            odd(there / f"f{k}.png")
        else:
            shutil.copy(here / "whole" / "frames" / f"frame_{k:05}.png", there / f"f{k}.png")
    return there


def lone(odd, ending):
    file = here / f"odd{random.randrange(10**9)}{ending}"
    odd(file)
    return file


own = case("measured", MEASURED)
out = ["--out", here / "out", "--quiet"]
measure = ["track", own, "--frames", here / "whole" / "frames" / "frame_*.png", *out]


def with_mask(lines):
    return ["track", case("masked", MEASURED + "[mask.m]\n" + lines), *measure[2:]]


places = {
    "case": lambda odd: ["run", lone(odd, ".toml")],
    "case of check": lambda odd: ["check", lone(odd, ".toml")],
    "first frame": lambda odd: ["track", own, "--frames", frames_with(odd, 0), *out],
    "second frame": lambda odd: ["track", own, "--frames", frames_with(odd, 1), *out],
    "video": lambda odd: ["track", own, "--frames", lone(odd, ".mp4"), *out],
    "mask": lambda odd: with_mask(f'image = "{lone(odd, ".png")}"\n'),
    "masks": lambda odd: with_mask(f'images = "{frames_with(odd, 1)}"\n'),
    "motion of a mask": lambda odd: with_mask(f'circle_px = [40.0, 40.0, 9.0]\nmotion = "{lone(odd, ".csv")}"\n'),
    "vectors": lambda odd: ["track", case("vectors", MEASURED[:MEASURED.index("[frames]")] + MEASURED[MEASURED.index("[camera]"):MEASURED.index("[grid]")]
                                          + MEASURED[MEASURED.index("[region"):MEASURED.index("[piv]")]
                                          + f'[vectors]\npath = "{lone(odd, ".txt")}"\nformat = "openpiv"\nrate_hz = 5.0\n'), *out],
    "stress file": lambda odd: ["run", case("stressed", SIMULATED + f'[mpm.initial_stress]\nstress_file = "{lone(odd, ".csv")}"\n'), *out],
    "motion of a body": lambda odd: ["run", case("body", SIMULATED + '[body.b]\npolygon_m = [[0.02, 0.13], [0.06, 0.13], [0.06, 0.15], [0.02, 0.15]]\n'
                                                 + f'motion = "{lone(odd, ".csv")}"\n'), *out],
    "board": lambda odd: ["calibrate", lone(odd, ".png"), *out],
    "frames of init": lambda odd: ["init", frames_with(odd, 0)],
    "record of report": lambda odd: ["report", lone(odd, ".h5")],
    "record of verify": lambda odd: ["verify", lone(odd, ".h5")],
    "record of export": lambda odd: ["export", lone(odd, ".h5")],
    "compared record": lambda odd: ["compare", record, lone(odd, ".h5")],
    "compared CSV": lambda odd: ["compare", record, f"csv={lone(odd, '.csv')}"],
    "compared VTK": lambda odd: ["compare", record, f"vtk={lone(odd, '_1.vtk')}"],
    "compared VTU": lambda odd: ["compare", record, f"vtu={lone(odd, '_1.vtu')}"],
    "compared HDF5": lambda odd: ["compare", record, f"cbgeo={lone(odd, '_1.h5')}"],
}
for name, arguments in places.items():
    odd = random.choice([pipe, zeros]) if rounds == 1 else pipe
    refused(f"{odd.__name__} as {name}", tried(*arguments(odd)))
    if rounds > 1:
        refused(f"zeros as {name}", tried(*arguments(zeros)))


# Records that lead elsewhere, with a valid checksum.
(here / "secret.txt").write_text(SECRET * 40)
with h5py.File(here / "other.h5", "w") as other:
    other["case"] = SECRET
    other["values"] = numpy.arange(9.0)


def replaced(file, path):
    if path in file:
        del file[path]
    return path


def external_storage(file):
    text = h5py.h5t.C_S1.copy()
    text.set_size(200)
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_external(str(here / "secret.txt").encode(), 0, 200)
    h5py.h5d.create(file.id, replaced(file, "case").encode(), text, h5py.h5s.create(h5py.h5s.SCALAR), properties)


def external_link(file):
    file[replaced(file, "case")] = h5py.ExternalLink(str(here / "other.h5"), "/case")


def deep_link(file):
    file["piv/extra"] = h5py.ExternalLink(str(here / "other.h5"), "/")


def virtual(file):
    layout = h5py.VirtualLayout(shape=(9,), dtype="f8")
    layout[:] = h5py.VirtualSource(str(here / "other.h5"), "values", shape=(9,))
    file.create_virtual_dataset("piv/extra", layout)


def own_tail(file):
    shape = file["piv/pair"].shape
    layout = h5py.VirtualLayout(shape=shape, dtype="i4")
    layout[:] = h5py.VirtualSource(".", "piv/pair", shape=shape)
    replaced(file, "piv/pair")
    file.create_virtual_dataset("piv/pair", layout)


def rare_filter(file):
    file.create_dataset("piv/extra", data=numpy.arange(1000), chunks=(100,), scaleoffset=0)


def rare_type(file):
    name = replaced(file, "frames/flag")
    file[name] = numpy.zeros(3, dtype=numpy.dtype("V7"))


def bomb(file):  # two megabytes that would be sixteen gigabytes as numbers
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_chunk((1 << 28,))
    properties.set_deflate(9)
    n = 1 << 28 if rounds == 1 else 1 << 31
    data = h5py.h5d.create(file.id, replaced(file, "frames/time").encode(), h5py.h5t.STD_U8LE, h5py.h5s.create_simple((n,)), properties)
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(bytes(1 << 20)) for _ in range(256)) + packer.flush()
    for k in range(0, n, 1 << 28):
        data.write_direct_chunk((k,), packed)


def escaped_unit(file):
    file.attrs["length_unit"] = "\x1b]0;mine\x07m"


def escaped_name(file):
    file.move("motion/np", "motion/\x1b[2J")


for hostile in (external_storage, external_link, deep_link, virtual, own_tail, rare_filter, rare_type, bomb, escaped_unit, escaped_name):
    there = here / hostile.__name__
    there.mkdir()
    shutil.copy(record, there)
    with h5py.File(there / "record.h5", "r+") as file:
        hostile(file)
    seal(there / "record.h5")
    for command in (["report", "verify", "export"] if rounds > 1 else [random.choice(["report", "verify"])]):
        refused(f"{hostile.__name__} for {command}", tried(command, there / "record.h5"))
    said = [f for f in there.rglob("*") if f.is_file() and f.name != "record.h5"]
    if said:
        faults.append(f"{hostile.__name__}: left {said}")

# Names.
for name, text, words in [
    ("name", MEASURED.replace('name = "small"', 'name = "a\\u001b[2Jb"'), ["name"]),
    ("region", MEASURED.replace("[region.soil]", '[region."so\\u0007il"]'), ["region"]),
    ("unit", MEASURED.replace("metres_per_pixel = 0.001", 'metres_per_pixel = 0.001\nlength_unit = "m\\u0000m"'), ["length_unit"]),
    ("turned text", MEASURED.replace('name = "small"', 'name = "a\\u202eb"'), ["name"]),
    ("least scale", MEASURED.replace("metres_per_pixel = 0.001", "metres_per_pixel = 1e-30"), ["metres_per_pixel"]),
]:
    refused("control characters in the " + name if name != "least scale" else name, tried("check", case("named", text)), "named.toml", *words)
refused("--title", tried("report", record, "--title", "a\x1b]0;b\x07"), "--title")
refused("a name of 5,000 characters as --frames", tried("track", own, "--frames", "a" * 5000 + "_%05d.png", *out))
refused("a name of 5,000 characters as --out", tried("track", own, *measure[2:4], "--out", here / ("b" * 5000)))

evil = "../" * 12 + str(here / "escaped").lstrip("/")
traverse = case("traverse", SIMULATED.replace('name = "s"', f'name = "{evil}"').replace("soil]", f'"{evil}"]').replace("base]", f'"{evil}"]'))
before = set(here.iterdir())
result = tried("run", traverse, "--out", here / "inside", "--quiet", "--threads", "1")
if result.returncode != 0 or set(here.iterdir()) - before != {here / "inside"}:
    faults.append(f"names that are paths: {result.returncode} {result.stderr} {set(here.iterdir()) - before}")

# Links under the names that the program writes to.
kept = here / "kept.txt"
WRITTEN = (".lock", "record.h5", "record.h5.tmp", "report.html", "metrics.csv", "record.xdmf", "record.xdmf.tmp", "frames/drawn.txt",
           "frames/drawing.txt", "frames/drawn.txt.tmp", "parts/head.h5.tmp", "animation.mp4", "animation.part.mp4")
for place in WRITTEN if rounds > 1 else random.sample(WRITTEN, 3):
    kept.write_text(SECRET)
    there = here / "linked"
    shutil.rmtree(there, ignore_errors=True)
    (there / place).parent.mkdir(parents=True)
    (there / place).symlink_to(kept)
    result = tried("track", here / "synth.toml", "--out", there, "--quiet", "--threads", "1", "--set", 'report.animation=true')
    if kept.read_text() != SECRET or result.returncode not in (0, 1, 2):
        faults.append(f"a link as {place}: written through ({result.returncode} {result.stderr})")
    print("ok  ", "a link as", place, result.returncode, result.stderr.strip()[:100])

# Frames that somebody put where an unfinished run would have drawn its own.
unfinished = here / "unfinished" / "frames"
unfinished.mkdir(parents=True)
note = (here / "whole" / "frames" / "drawn.txt").read_text().splitlines(keepends=True)
(unfinished / "drawn.txt").write_text(note[0] + "".join(note[note.index("case\n"):]))
shutil.copy(frame, unfinished / "frame_00002.png")
refused("a frame beside an unfinished drawn.txt", tried("track", here / "synth.toml", "--out", here / "unfinished"), "frame_00002.png")
assert (unfinished / "frame_00002.png").exists()

# Pictures and videos of some kilobytes that ask for gigabytes.
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth=8, colour=0, rows=b""):
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def tiff(width, height):
    tags = [(256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, 8), (259, 3, 1, 8), (262, 3, 1, 1), (273, 4, 1, 200),
            (277, 3, 1, 1), (278, 4, 1, height), (279, 4, 1, 40)]
    head = b"II*\0" + struct.pack("<IH", 8, len(tags)) + b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<I", 0)
    return head.ljust(200, b"\0") + zlib.compress(bytes(4000), 9).ljust(40, b"\0")


for name, data in [("wide.png", png(1 << 20, 1 << 13)), ("deep.png", png(40000, 40000, 16, 6)), ("wide.tif", tiff(1 << 20, 1 << 13)),
                   ("wide.pgm", b"P5\n900000 900000\n255\n"), ("damaged.png", png(64, 64, rows=b"\x09" * 4160))]:
    there = here / name.replace(".", "_")
    there.mkdir()
    (there / name).write_bytes(data)
    refused(name, tried("track", own, "--frames", there / name, *out), name)
for name, data in [("list.mp4", f"ffconcat version 1.0\nfile {frame.name}\n#\0"), ("list.avi", "#EXTM3U\n#EXTINF:1,\nfile:///etc/hostname\n\0")]:
    (here / name).write_text(data)
    refused(name, tried("track", own, "--frames", here / name, *out), name)

shutil.rmtree(here)
if faults:
    sys.exit("\n".join(faults))
