"""Builds the wheel: `pip install .` (PEP 517). CMake compiles; nothing is fetched.

The wheel holds the Python module and, beside it, the program. An existing build is used where PIVNP_WHEEL_BUILD names its folder;
else one is made in build/wheel, for the interpreter that pip runs in. Debian's packages of scripts/packages.txt are needed.
"""
import base64
import hashlib
import os
import pathlib
import re
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
VERSION = re.search(r"project\(pivnp VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
METADATA = f"""Metadata-Version: 2.1
Name: pivnp
Version: {VERSION}
Summary: From lab video to verdict: PIV, numerical particles, MPM, comparison
License: GPL-3.0-or-later
Requires-Python: >=3.9
Requires-Dist: numpy
Provides-Extra: all
Requires-Dist: matplotlib; extra == "all"
Requires-Dist: pandas; extra == "all"
Requires-Dist: xarray; extra == "all"
"""


def _run(*words):
    if subprocess.run([str(word) for word in words], cwd=ROOT).returncode != 0:
        raise SystemExit(f"error: {' '.join(map(str, words))} failed")


def _build():
    given = os.environ.get("PIVNP_WHEEL_BUILD")
    if given:
        return pathlib.Path(given)
    build = ROOT / "build" / "wheel"
    _run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF", "-DPIVNP_UNITY=ON",
         "-DPIVNP_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}")
    _run("cmake", "--build", build, "--target", "pivnp", "pivnp_core_module", "pivnp_share")
    return build


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = _build()
    version = sysconfig.get_config_var("py_version_nodot")
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    tag = f"cp{version}-cp{version}-{platform}"
    info = f"pivnp-{VERSION}.dist-info"
    name = f"pivnp-{VERSION}-{tag}.whl"
    with tempfile.TemporaryDirectory() as scratch:
        stage = pathlib.Path(scratch)
        for component in ("python", "program"):
            _run("cmake", "--install", build, "--component", component, "--prefix", stage, "--strip")
        files = {}
        for file in sorted((next(stage.glob("lib/python3*/*-packages/pivnp"))).rglob("*")):
            if file.is_file():
                files[f"pivnp/{file.relative_to(next(stage.glob('lib/python3*/*-packages/pivnp')))}"] = file.read_bytes()
        files["pivnp/bin/pivnp"] = (stage / "bin/pivnp").read_bytes()
        files["pivnp/share/pivnp/case.schema.json"] = (stage / "share/pivnp/case.schema.json").read_bytes()
    if not any(file.startswith("pivnp/_core.") and file.endswith(".so") for file in files):
        raise SystemExit(f"error: {build} has no Python module: are python3-dev and pybind11-dev installed?")
    files[f"{info}/METADATA"] = METADATA.encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: pivnp\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    files[f"{info}/entry_points.txt"] = b"[console_scripts]\npivnp = pivnp._run:main\n"
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    lines = []
    for file, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{file},sha256={digest},{len(data)}")
    files[f"{info}/RECORD"] = ("\n".join([*lines, f"{info}/RECORD,,"]) + "\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as wheel:
        for file, data in files.items():
            entry = zipfile.ZipInfo(file, (2026, 1, 1, 0, 0, 0))
            mode = 0o755 if file == "pivnp/bin/pivnp" else 0o644
            entry.external_attr = (stat.S_IFREG | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
    return name
