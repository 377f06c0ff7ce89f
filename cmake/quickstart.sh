#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone on a fresh Debian 12 or Ubuntu 24.04 to a result, in one command and without a question.
set -eu

usage() {
    cat <<'TEXT'
sh cmake/quickstart.sh WHAT

  demo      render an animation with the built-in network, and the same frame by frame   (build/demo_output)
  evaluate  the paper's tables on the built-in network: every method, baseline and ablation, in 40 minutes on two
            cores (build/evaluation); with --quick a look in six, with --full three seeds and every option in hours,
            with --development variants on scenes that settings may be chosen by, with --long 240 frames. What is done
            is kept: after a stop, or with more asked for, the rest is made. Other options: evaluate --help
  tables    write the tables that evaluate and bench have left in build/ into the pages of docs/ that show them
  test      every test but those that are slow by nature: with g++, with clang++ and AddressSanitizer, and those that
            start threads with ThreadSanitizer
  slow_checks
            what continuous integration checks besides: the installed package and each of its headers, what must not
            compile, what the program must refuse, that the rules of the house catch who breaks them, benchmarks for a
            moment, clang-format and clang-tidy; that every public name has a comment
  fuzz      what reads files, each for a minute with inputs that libFuzzer makes; GENRENDER_FUZZ_SECONDS says for how long
            (slow_checks does it for ten seconds)
  bench     every benchmark beside its floor and its target, as one table (build/bench/benchmarks.md and .json); PyTorch,
            NumPy and ONNX Runtime too where python3, or the Python that GENRENDER_PEER_PYTHON names, has them;
            with --filter REGEX only rows whose names match, with --compare OTHER.json beside the benchmarks.json of an
            earlier run, with --no-peers without the programs of others (benchmarks/README.md)
  engines   programs of other engines with this library in them, each of examples/engines/ that is to be had: fetches the
            engines into build/engines, compares their frames and prints one table, and what was skipped and why; those in
            Python and LibTorch are of the Python that GENRENDER_PEER_PYTHON names, where it has their packages, else of
            virtual environments in build/engines (PyTorch is about 3 GB there)
  gpu       on a machine with an NVIDIA GPU, in five minutes: the fused kernel of eq. 6 against the host's, its speed
            against a copy's, and a whole run of LibTorch on the GPU, with that kernel, against the processor's and against
            the same run in plain PyTorch on the GPU
  docs      the reference of every public name, from the comments above them (build/docs/html/index.html)
  packages  install the Debian packages that all of these need, and do no more

Packages that are missing are installed with apt-get; nothing is downloaded when all are there.
TEXT
}

# What the library and its examples are built from.
demo_packages="g++ cmake ninja-build pkg-config libeigen3-dev libxtensor-dev libglm-dev libnanoflann-dev
    libassimp-dev libtinygltf-dev libbullet-dev libopenexr-dev libpng-dev libwebp-dev libcli11-dev nlohmann-json3-dev
    libutf8proc-dev"
evaluate_packages="$demo_packages gnuplot-nox"
bench_packages="g++ cmake ninja-build pkg-config libeigen3-dev libxtensor-dev libglm-dev libnanoflann-dev
    libbenchmark-dev libcli11-dev nlohmann-json3-dev libutf8proc-dev"
# What its tests need besides.
test_packages="$demo_packages clang libclang-rt-dev doctest-dev libbenchmark-dev assimp-testmodels valgrind"
engine_packages="g++ cmake ninja-build pkg-config libeigen3-dev libxtensor-dev libglm-dev libnanoflann-dev
    nlohmann-json3-dev libutf8proc-dev doctest-dev python3-venv python3-dev"
# What reads the sources without compiling them. Another clang-format would break other lines.
docs_packages="cmake doxygen"
slow_check_packages="$test_packages $docs_packages clang-format-14 clang-tidy"

say() {
    printf '\n== %s\n' "$*"
}

stop() {
    printf '%s\n' "$*" >&2
    exit 1
}

# Prints those of the packages given that are not installed.
missing_packages() {
    for package in "$@"; do
        case $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) in
            installed) ;;
            *) printf ' %s' "$package" ;;
        esac
    done
}

# Runs a command as root, without asking for a password.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        sudo -n "$@"
    fi
}

install_packages() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        stop "This script installs packages on Debian 12, Ubuntu 24.04 and newer. On this system, install by hand
  a C++20 compiler (g++ 12 or clang++ 14, or newer), CMake 3.25, Ninja, pkg-config,
  Eigen 3.4, xtensor 0.24, GLM 0.9.9, utf8proc 2; for the examples assimp 5, tinygltf 2.7, Bullet 3, OpenEXR 3, libpng,
  libwebp, CLI11 2, nlohmann_json 3; for the tests doctest 2.4, Google Benchmark 1.7, valgrind, clang-format 14, clang-tidy and Doxygen 1.9
and then run: cmake --workflow --preset demo (or test, or bench)"
    fi
    missing=$(missing_packages "$@")
    if [ -n "$missing" ]; then
        if [ "$(id -u)" -ne 0 ] && ! sudo -n true 2>/dev/null; then
            stop "Packages are missing and this user may not install them. Run
  sudo apt-get update && sudo apt-get install --no-install-recommends$missing
and then this script again."
        fi
        say "Installing$missing"
        as_root apt-get -q update
        # shellcheck disable=SC2086 # a list of words
        as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 \
            install --no-install-recommends $missing
    fi
    if ! printf '3.25\n%s\n' "$(cmake --version | sed -n 's/^cmake version //p')" | sort -V -C; then
        stop "CMake is $(cmake --version | sed -n 's/^cmake version //p'), and 3.25 or newer is needed: that of Debian 12 or Ubuntu 24.04."
    fi
}

# Configures, builds and tests one preset of CMakePresets.json. Ninja would run two jobs more than there are processors, which
# takes up to a third longer: compilers wait for memory and not for files.
workflow() {
    export CMAKE_BUILD_PARALLEL_LEVEL="${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}"
    say "Preset $1"
    # Sanitizers of clang 14 cannot place their shadow memory in every randomised layout of newer kernels.
    if setarch "$(uname -m)" -R true 2>/dev/null; then
        setarch "$(uname -m)" -R cmake --workflow --preset "$1"
    else
        cmake --workflow --preset "$1"
    fi
    count_tests "$@"
}

# Adds a line to `counts`: how many tests of a preset were started, in the build folder that is named after it or given,
# and how many cases of doctest these hold. None is a failure.
counts=""
count_tests() {
    log=build/${2-$1}/Testing/Temporary/LastTest.log
    if [ -f "$log" ]; then
        counts="$counts$(awk -v preset="$1" '
            /^[0-9]+\/[0-9]+ Testing: / { tests += 1 }
            /^\[doctest\] test cases: / { split($0, words, ":"); cases += words[2] + 0 }
            END {
                printf "%-12s %5d tests, %5d cases of doctest in them\n.", preset, tests, cases
                exit tests == 0
            }' "$log")"
        counts=${counts%.}
    fi
}

demo() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $demo_packages
    workflow demo
    say "Both ways to render, one above the other"
    ls build/demo_output/generative_rendering/comparison.*
}

run_tests() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $test_packages
    workflow test
    workflow asan
    workflow tsan
    say "Passed; slow ones were left out: sh cmake/quickstart.sh slow_checks"
    printf '%s' "$counts"
}

# What clang-tidy reads: all of the library by its umbrella, and programs as users write them.
tidy_units="tests/house/umbrella_first.cpp examples/first_render.cpp examples/maps_and_noise.cpp
    examples/your_own_correspondence.cpp examples/your_own_denoiser.cpp examples/blender_maps.cpp"

slow_checks() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $slow_check_packages
    say "clang-format"
    find include tests examples benchmarks python '(' -name '*.[ch]pp' -o -name '*.inl' ')' -exec \
        clang-format-14 --dry-run --Werror '{}' +
    workflow slow_checks test
    say "Fuzzing"
    GENRENDER_FUZZ_SECONDS="${GENRENDER_FUZZ_SECONDS:-10}" workflow fuzz
    say "clang-tidy"
    # shellcheck disable=SC2086 # a list of words
    printf '%s\n' $tidy_units | xargs -P 2 -n 1 clang-tidy --quiet --warnings-as-errors='*' -p build/test \
        --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument
    say "Passed"
    printf '%s' "$counts"
}

fuzz() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $test_packages
    GENRENDER_FUZZ_SECONDS="${GENRENDER_FUZZ_SECONDS:-60}" workflow fuzz
    say "Passed"
}

evaluate() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $evaluate_packages
    workflow evaluate
    say "Rendering and measuring"
    build/evaluate/examples/evaluate --out build/evaluation "$@"
    if [ -f build/evaluation/consistency.csv ]; then
        gnuplot -e "folder='build/evaluation'" examples/evaluation/consistency.gnuplot
    fi
    case "$*" in
        "" | *--full*)
            say "Matching pixels with and without textures"
            build/evaluate/examples/blender_maps walking_figure build/evaluation/blender_sequence 24 512
            build/evaluate/examples/correspondence_tables --maps build/evaluation/blender_sequence \
                --out build/evaluation/correspondence.md
            ;;
    esac
    say "Tables, contact sheets, slices over time and the plot"
    ls build/evaluation
}

bench() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $bench_packages
    workflow bench
    say "Measuring"
    cmake -P build/bench/benchmarks/measure.cmake -- "$@"
    say "The table and all figures"
    ls build/bench/benchmarks.*
}

# Engines are fetched into build/engines, each by a script of its own; one that is not to be had is skipped.
engines() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $engine_packages
    for script in examples/engines/*/get.sh; do
        engine=$(basename "$(dirname "$script")")
        say "Fetching $engine"
        sh "$script" "build/engines/$engine" || say "$engine is not to be had"
    done
    say "Building and running the clients"
    cmake -D BUILD=build/engines/clients -P examples/engines/table.cmake
}

gpu() {
    if ! nvidia-smi -L 2>/dev/null | grep -q '^GPU'; then
        say "There is no NVIDIA GPU here. Skipped: the kernel of eq. 6 against the host's and its speed; a whole run on the GPU"
        return
    fi
    nvcc=$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)
    if [ ! -x "$nvcc" ]; then
        stop "nvcc is not found, neither in PATH nor in /usr/local/cuda/bin: install a CUDA toolkit, which compiles the kernel."
    fi
    # shellcheck disable=SC2086 # a list of words
    install_packages $engine_packages
    mkdir -p build/engines
    say "The kernel of eq. 6"
    "$nvcc" -std=c++20 -O2 -arch=native -I include -o build/engines/mix_rows_on_device \
        examples/engines/gpu/mix_rows_on_device.cu
    build/engines/mix_rows_on_device
    python=${GENRENDER_PEER_PYTHON:-python3}
    if ! "$python" -c 'import torch; assert torch.cuda.is_available()' 2>/dev/null; then
        say "$python has no PyTorch that sees the GPU (GENRENDER_PEER_PYTHON names another). Skipped: a whole run on the GPU"
        return
    fi
    say "A whole run of LibTorch on the GPU, against the library's own network on the processor"
    # Products of 10 bits, cuDNN's usual ones, are further from the processor's than the bound.
    export NVIDIA_TF32_OVERRIDE=0 GENRENDER_ENGINE_DEVICE=cuda CUDACXX="$nvcc"
    cmake -D BUILD=build/engines/clients_gpu -D "ENGINES=libtorch;torchscript" -D "PYTHON=$python" \
        -D OPTIONS=-DGENRENDER_TORCH_CUDA=ON -P examples/engines/table.cmake
    say "A whole run on the GPU, against the same in plain PyTorch there"
    build/engines/clients_gpu/libtorch/whole_run 64 128
}

docs() {
    # shellcheck disable=SC2086 # a list of words
    install_packages $docs_packages
    say "The reference"
    cmake -D OUT=build/docs -P docs/reference.cmake
}

cd "$(dirname "$0")/.."
case ${1-} in
    demo) demo ;;
    evaluate)
        shift
        evaluate "$@"
        ;;
    tables) cmake -P cmake/write_tables.cmake ;;
    test) run_tests ;;
    slow_checks) slow_checks ;;
    fuzz) fuzz ;;
    bench)
        shift
        bench "$@"
        ;;
    engines) engines ;;
    gpu) gpu ;;
    docs) docs ;;
    packages) # shellcheck disable=SC2086 # a list of words
        install_packages $slow_check_packages $evaluate_packages ;;
    *)
        usage >&2
        exit 2
        ;;
esac
