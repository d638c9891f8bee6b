#!/usr/bin/python3
"""Options that scripts and tests give to the program exist: a script that is refused for an option which was removed must
not pass for one that tested something.

usage: flags.py PROGRAM SOURCE"""
import pathlib
import re
import sys

from program import run

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
WRONG_ON_PURPOSE = {"--thread", "--no-such-option"}
OTHERS = {  # of the programs that scripts call beside pivnp
    "--build", "--preset", "--target", "--test-dir", "--output-on-failure", "--show-toplevel", "--abbrev-ref", "--version", "--prefix", "--install", "--attributes", "--ignore"}

commands = re.findall(r"^  ([a-z]+) ", run(program, "--help").stdout, re.MULTILINE)
known = set(re.findall(r"--[a-z][a-z0-9-]*", run(program, "--help").stdout))
of = {}
for command in commands:
    text = run(program, command, "--help")
    if text.returncode == 0:
        of[command] = set(re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]*(?:,--[a-z0-9-]+)*)", text.stdout, re.MULTILINE))
        known |= {flag for flags in of[command] for flag in flags.split(",")}
assert len(of) > 10 and {"--out", "--resume", "--quiet"} <= known, (of.keys(), known)

faults = []
seen = 0
for file in sorted([*source.glob("tests/**/*.py"), *source.glob("scripts/*"), *source.glob("datasets/**/*.sh")]):
    if not file.is_file():
        continue
    text = file.read_text(errors="replace")
    # What a script itself takes: compared with its own arguments, or declared.
    own = set(re.findall(r"[\"'](--[a-z-]+)[\"'] in |add_argument\(.*[\"'](--[a-z-]+)|^\s*(--[a-z-]+)\)|== [\"']?(--[a-z-]+)", text, re.MULTILINE))
    own = {flag for flags in own for flag in flags if flag}
    for number, line in enumerate(text.splitlines(), 1):
        given = re.findall(r"[\"'](--[a-z][a-z0-9-]*)[\"']", line)
        for words in re.findall(r"pivnp\"? (?:%s) ([^#|;&`]*)" % "|".join(of), line) if file.parent.name == "scripts" else []:
            given += re.findall(r"(?<![\w-])(--[a-z][a-z0-9-]*)", words)
        seen += len(given)
        faults += [f"{file.relative_to(source)}:{number}: {flag}" for flag in given if flag not in known | own | WRONG_ON_PURPOSE | OTHERS]
assert seen > 100, seen
result = run(program, "check", "nowhere", "--no-such-option")
if result.returncode != 2 or "--no-such-option" not in result.stderr:
    faults.append(f"an unknown option: exit {result.returncode}")
print(seen, "options of", len(of), "commands")
if faults:
    sys.exit("options that do not exist:\n" + "\n".join(faults))
