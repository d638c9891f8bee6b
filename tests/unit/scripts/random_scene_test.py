"""scripts/random-scene: the same case from the same seed, other cases from others, and the program reads them all.

usage: random_scene_test.py RANDOM_SCENE PIVNP
"""
import pathlib
import subprocess
import sys
import tempfile

generator, program = sys.argv[1:]


def scene(seed):
    return subprocess.run([generator, str(seed)], capture_output=True, text=True, check=True).stdout


seeds = range(1, 21)
texts = {seed: scene(seed) for seed in seeds}
assert scene(7) == texts[7]
assert len(set(texts.values())) == len(texts)
with tempfile.TemporaryDirectory() as folder:
    for seed, text in texts.items():
        case = pathlib.Path(folder) / f"{seed}.toml"
        case.write_text(text)
        done = subprocess.run([program, "check", case, "--out", f"{folder}/{seed}"], capture_output=True, text=True)
        assert done.returncode == 0, f"seed {seed}: {done.stderr}"
