# SPDX-License-Identifier: MIT
"""Runs every block of Python of docs/python.md, one after the other, on small files of the names that the page has:
docs_test.py PAGE MAPS_PROGRAM FOLDER. Finds the package by PYTHONPATH; exit code 77 where something is missing.
"""

import contextlib
import importlib.util
import pathlib
import re
import shutil
import subprocess
import sys
import warnings

missing = [name for name in ("genrender", "torch", "diffusers", "transformers") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

warnings.filterwarnings("ignore")
import torch
from stub_model import StubModel
from two_resolution_pipeline import write_pipeline

torch.set_num_threads(1)
page, maps_program, folder = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
blocks = re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
if len(blocks) < 5:
    sys.exit(f"{page}: {len(blocks)} blocks of Python, expected at least 5")
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
write_pipeline(folder / "stable-diffusion-v1-5")
shutil.move(folder / "stable-diffusion-v1-5" / "controlnet", folder / "control_v11f1p_sd15_depth")
subprocess.run([maps_program, "walking_figure", folder / "maps", "3", "64"], check=True, stdout=subprocess.DEVNULL)
names = {"model": StubModel()}
with contextlib.chdir(folder):
    for number, block in enumerate(blocks):
        exec(compile(block, f"{page.name}, block {number + 1}", "exec"), names)
pictures = sorted(path.name for path in folder.glob("*.png"))
if pictures != ["0000.png", "0001.png", "0002.png"]:
    sys.exit(f"{page}: made the pictures {pictures}, expected those of 3 frames")
print(len(blocks), "blocks ran")
