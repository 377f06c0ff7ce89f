#!/bin/sh
# SPDX-License-Identifier: MIT
# sh get.sh DIR: installs LibTorch into a virtual environment in DIR, the package torch without what its libraries for the
# processor do not need, which is most of it. Needs python3 with venv; does nothing where DIR has it, or the Python that
# GENRENDER_PEER_PYTHON names.
set -eu
dir=${1:?usage: sh get.sh DIR}
python=${GENRENDER_PEER_PYTHON:-python3}
has_torch() {
    "$1" -c 'import importlib.metadata as m; m.version("torch")
if any(line.startswith("cuda-toolkit") for line in m.requires("torch")): m.version("nvidia-cuda-cupti")' 2>/dev/null
}
if has_torch "$python" || has_torch "$dir/bin/python3"; then
    exit 0
fi
"$python" -m venv "$dir"
"$dir/bin/pip" install -q --disable-pip-version-check --no-deps torch
# What torch names for its CUDA libraries is a package of packages. Without dependencies pip does not mind what is left out.
toolkit=$("$dir/bin/python3" -c 'import importlib.metadata as m
for line in m.requires("torch"):
    if line.startswith("cuda-toolkit"): print("cuda-toolkit==" + line.split("==")[1].split(";")[0].strip())')
if [ -n "$toolkit" ]; then
    "$dir/bin/pip" install -q --disable-pip-version-check --no-deps "$toolkit"
    # shellcheck disable=SC2046 # a list of words
    "$dir/bin/pip" install -q --disable-pip-version-check --no-deps $("$dir/bin/python3" -c 'import importlib.metadata as m
for line in m.requires("cuda-toolkit"):
    if line.rsplit(" ", 1)[-1][1:-1] in ("cudart", "cupti"):
        print(line.split(";")[0].strip())')
fi
