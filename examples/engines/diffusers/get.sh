#!/bin/sh
# SPDX-License-Identifier: MIT
# sh get.sh DIR: installs what the client needs into the virtual environment 'python' beside DIR, which clients in Python share.
set -eu
exec sh "$(dirname "$0")/../python_client/install.sh" "$(dirname "${1:?usage: sh get.sh DIR}")/python" \
    torch diffusers numpy safetensors nanobind
