#!/usr/bin/env python3
"""A tarball of the program with the libraries that it needs, for distributions with glibc 2.36 or newer.

usage: tarball.py BUILD FOLDER      (writes FOLDER/pivnp-VERSION-linux-x86_64.tar.gz; needs patchelf)

It may be unpacked anywhere: bin/pivnp starts libexec/pivnp with the libraries of lib/, Qt's plugins and a font beside it.
"""
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile

# glibc and its loader come from the system, which knows its names, locales and kernels.
SYSTEM = ("ld-linux", "libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "libresolv.so", "libutil.so", "libnsl.so", "libanl.so")
PLUGINS = ("platforms/libqoffscreen.so", "imageformats/libqsvg.so")
START = """#!/bin/sh
# Starts the program with what lies beside it.
here=$(dirname "$(dirname "$(readlink -f "$0")")")
if [ ! -f /etc/fonts/fonts.conf ] && [ -z "$FONTCONFIG_FILE" ]; then
  FONTCONFIG_FILE=$here/etc/fonts.conf
  export FONTCONFIG_FILE
fi
QT_QPA_FONTDIR=${QT_QPA_FONTDIR:-$here/share/fonts}
export QT_QPA_FONTDIR
exec "$here/libexec/pivnp" "$@"
"""
FONTS = """<?xml version="1.0"?>
<fontconfig>
  <dir prefix="relative">../share/fonts</dir>
  <cachedir prefix="xdg">fontconfig</cachedir>
</fontconfig>
"""


def run(*words):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout


def needed(binary):
    """Libraries that the loader finds for a binary, by name."""
    found = {}
    for line in run("ldd", binary).splitlines():
        parts = line.split()
        if "=>" in parts and len(parts) > 2 and parts[2].startswith("/"):
            found[parts[0]] = pathlib.Path(parts[2])
        elif "not found" in line:
            sys.exit(f"error: {binary} needs {parts[0]}, which is not there")
    return {name: path for name, path in found.items() if not name.startswith(SYSTEM)}


def main():
    build, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    for tool in ("patchelf", "ldd", "cmake"):
        if not shutil.which(tool):
            sys.exit(f"error: {tool} is not installed")
    qt = pathlib.Path(run("qtpaths6", "--plugin-dir").strip()) if shutil.which("qtpaths6") else None
    qt = qt or next(pathlib.Path("/usr/lib").glob("*/qt6/plugins"))
    with tempfile.TemporaryDirectory() as scratch:
        stage = pathlib.Path(scratch)
        run("cmake", "--install", build, "--component", "program", "--prefix", stage / "usr")
        version = run(stage / "usr/bin/pivnp", "--version").split()[1]
        name = f"pivnp-{version}-linux-x86_64"
        top = stage / name
        for part in ("bin", "lib", "libexec", "plugins", "etc", "share/fonts"):
            (top / part).mkdir(parents=True)
        shutil.copytree(stage / "usr/share", top / "share", dirs_exist_ok=True)
        shutil.move(stage / "usr/bin/pivnp", top / "libexec/pivnp")
        run("strip", top / "libexec/pivnp")
        libraries = needed(top / "libexec/pivnp")
        for plugin in PLUGINS:
            if (qt / plugin).exists():
                (top / "plugins" / plugin).parent.mkdir(exist_ok=True)
                shutil.copy(qt / plugin, top / "plugins" / plugin)
                libraries |= needed(qt / plugin)
        for soname, path in libraries.items():
            shutil.copy(path, top / "lib" / soname)
            (top / "lib" / soname).chmod(0o755)
        run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/../lib", top / "libexec/pivnp")
        run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", *sorted((top / "lib").iterdir()))
        for plugin in (top / "plugins").rglob("*.so"):
            run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/../../lib", plugin)
        (top / "libexec/qt.conf").write_text("[Paths]\nPrefix = ..\nPlugins = plugins\n")
        (top / "bin/pivnp").write_text(START)
        (top / "bin/pivnp").chmod(0o755)
        (top / "etc/fonts.conf").write_text(FONTS)
        for font in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf"):
            shutil.copy(pathlib.Path("/usr/share/fonts/truetype/dejavu") / font, top / "share/fonts" / font)
        source = pathlib.Path(__file__).parent.parent
        shutil.copy(source / "LICENSE", top / "LICENSE")
        folder.mkdir(parents=True, exist_ok=True)
        archive = folder / f"{name}.tar.gz"
        with tarfile.open(archive, "w:gz", compresslevel=1) as tar:
            tar.add(top, arcname=name, filter=lambda entry: entry.replace(uid=0, gid=0, uname="root", gname="root", deep=False))
        print(archive, f"({archive.stat().st_size >> 20} MiB, {len(libraries)} libraries)")


main()
