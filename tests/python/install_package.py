# SPDX-License-Identifier: MIT
"""Installs the Python package as its users do, into a folder of its own: install_package.py REPOSITORY FOLDER.

Exit code 77, and a sentence, where what builds it is missing.
"""

import importlib.util
import pathlib
import subprocess
import sys

repository, folder = map(pathlib.Path, sys.argv[1:3])
missing = [name for name in ("nanobind", "scikit_build_core", "numpy", "pip") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)
subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index",
                "--disable-pip-version-check", "--root-user-action=ignore", "--upgrade", "--target", folder / "site",
                "-C", f"build-dir={folder / 'build'}", "-C", "cmake.define.GENRENDER_PYTHON_WARNINGS=ON",
                *sys.argv[3:], repository / "python"], check=True)
subprocess.run([sys.executable, "-c", "import genrender; print('genrender', genrender.__version__, genrender.reads_exr)"],
               check=True, cwd=folder / "site")
