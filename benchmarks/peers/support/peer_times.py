# SPDX-License-Identifier: MIT
"""How every peer times its cases, names itself and prints what benchmarks/support/benchmark_results.hpp reads."""

import argparse
import json
import re
import statistics
import time


class peer_times:
    """The times of a script's cases. `about` is what the script tells of itself, `kernels` which rows it is a peer of: the
    constant KERNELS in a line of its own, by which it is only run if one of them is measured."""

    def __init__(self, about, kernels):
        parser = argparse.ArgumentParser(description=about)
        parser.add_argument("--seconds", type=float, default=0.5, help="least time of a case")
        parser.add_argument("--filter", default="", help="a regular expression, as that of Google Benchmark")
        arguments = parser.parse_args()
        self._seconds = arguments.seconds
        self._is_wanted = not arguments.filter.startswith("-")
        self._filter = arguments.filter.removeprefix("-")
        self._kernels = kernels
        self._times = []

    def wants(self, name):
        """Whether a case, by the full name that Google Benchmark gives to ours, is to run."""
        return (re.search(self._filter, name) is not None) == self._is_wanted

    def add(self, name, peer, *bodies, warm_ups=2):
        """Keeps the time of the fastest of `bodies`, which are ways of `peer` to do the same."""
        if name.split("/")[0] not in self._kernels:
            raise ValueError(f"{name} is not among the script's KERNELS: {self._kernels}")
        wall, cpu = min(self._medians(body, warm_ups) for body in bodies)
        self._times.append({"name": name, "peer": peer, "seconds": wall, "cpu_seconds": cpu})

    def print(self):
        """Prints a list of {"name", "peer", "seconds", "cpu_seconds"}: by the clock on the wall, and of all threads."""
        print(json.dumps(self._times, indent=2))

    def _medians(self, body, warm_ups):
        """Of at least three runs and as many as fill the least time; of fewer where three take ten times as long."""
        for _ in range(warm_ups):
            body()
        walls, cpus = [], []
        while len(walls) < 3 and sum(walls) < 10 * self._seconds or sum(walls) < self._seconds:
            wall, cpu = time.perf_counter(), time.process_time()
            body()
            walls.append(time.perf_counter() - wall)
            cpus.append(time.process_time() - cpu)
        return statistics.median(walls), statistics.median(cpus)


def pytorch_name(body=None):
    """`PyTorch 2.1.0`, or `PyTorch 2.1.0 (oneDNN)` if a profile of `body` shows that it ran kernels of oneDNN.

    PyTorch decides by shape, threads and layout: a build with oneDNN does not run it everywhere.
    """
    import torch

    name = f"PyTorch {torch.__version__.split('+')[0]}"
    if body is None:
        return name
    with torch.autograd.profiler.profile() as profile:
        body()
    return name + " (oneDNN)" * any("mkldnn" in event.key for event in profile.key_averages())
