"""The version stands once, in the top CMakeLists.txt; what repeats it must agree.

usage: version_test.py SOURCE_FOLDER
"""
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
version = re.search(r"project\(pivnp VERSION ([\d.]+)", (source / "CMakeLists.txt").read_text()).group(1)
cited = re.search(r"^version: (.*)$", (source / "CITATION.cff").read_text(), re.M).group(1)
assert cited == version, f"CITATION.cff says {cited}, CMakeLists.txt {version}"
