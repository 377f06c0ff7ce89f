#!/bin/sh
# SPDX-License-Identifier: MIT
# sh get.sh DIR: installs OpenVINO into a virtual environment in DIR; its package for Python carries the headers, the library
# and a CMake package for C++. Needs python3 with venv; does nothing where DIR has it.
set -eu
dir=${1:?usage: sh get.sh DIR}
python=${GENRENDER_PEER_PYTHON:-python3}
[ -x "$dir/bin/python3" ] || "$python" -m venv "$dir"
"$dir/bin/python3" -c 'import openvino' 2>/dev/null ||
    "$dir/bin/pip" install -q --disable-pip-version-check 'openvino>=2026.0'
