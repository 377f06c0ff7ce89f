#!/bin/sh
# SPDX-License-Identifier: MIT
# sh get.sh DIR: builds and installs ggml into DIR, for processors alone, from the source package ggml-python, which carries
# ggml's sources; pip fetches it. Needs python3 with pip, CMake, a compiler; does nothing where DIR has it.
set -eu
dir=${1:?usage: sh get.sh DIR}
[ ! -e "$dir/lib/cmake/ggml/ggml-config.cmake" ] || exit 0
mkdir -p "$dir/source"
dir=$(cd "$dir" && pwd)
python=${GENRENDER_PEER_PYTHON:-python3}
"$python" -m venv "$dir/fetch"
"$dir/fetch/bin/pip" install -q --disable-pip-version-check scikit-build-core
"$dir/fetch/bin/pip" download -q --disable-pip-version-check --no-deps --no-binary :all: --no-build-isolation \
    -d "$dir/source" ggml-python==0.0.45
tar -xzf "$dir"/source/ggml_python-*.tar.gz -C "$dir/source"
cmake -S "$dir"/source/ggml_python-*/vendor/ggml -B "$dir/build" -D CMAKE_BUILD_TYPE=Release -D BUILD_SHARED_LIBS=OFF \
    -D GGML_OPENMP=OFF -D GGML_CCACHE=OFF -D GGML_BUILD_TESTS=OFF -D GGML_BUILD_EXAMPLES=OFF \
    -D CMAKE_INSTALL_LIBDIR=lib -D CMAKE_INSTALL_PREFIX="$dir"
cmake --build "$dir/build" --parallel "${GENRENDER_JOBS:-2}" --target install
rm -rf "$dir/build" "$dir/source" "$dir/fetch"
