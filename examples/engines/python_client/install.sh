#!/bin/sh
# SPDX-License-Identifier: MIT
# sh install.sh DIR PACKAGE...: a virtual environment in DIR with packages for Python, for clients in Python. Does nothing
# where DIR has them all, or the Python that GENRENDER_PEER_PYTHON names. Needs python3 with venv. PyTorch is about 3 GB with
# what it brings for GPUs, and a tenth of that where pip is told an index that has it for processors alone (PIP_INDEX_URL).
set -eu
dir=${1:?usage: sh install.sh DIR PACKAGE...}
shift
python=${GENRENDER_PEER_PYTHON:-python3}
has_all() {
    interpreter=$1
    shift
    "$interpreter" -c 'import importlib.util as u, sys; sys.exit(any(u.find_spec(p) is None for p in sys.argv[1:]))' \
        "$@" 2>/dev/null
}
if has_all "$python" "$@" || has_all "$dir/bin/python3" "$@"; then
    exit 0
fi
[ -x "$dir/bin/python3" ] || "$python" -m venv "$dir"
"$dir/bin/pip" install -q --disable-pip-version-check "$@"
