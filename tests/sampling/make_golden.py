# SPDX-License-Identifier: MIT
"""Writes data/k_diffusion.json: what the public package k-diffusion computes in double precision where the tests ask
genrender.

Needs Python 3.9 or later with PyTorch and SciPy (any recent version, CPU only), tqdm and k-diffusion 0.1.1.post1:

    pip install torch scipy tqdm
    pip install --no-deps k-diffusion==0.1.1.post1
    python3 tests/sampling/make_golden.py

Only k_diffusion.sampling and k_diffusion.external are used; what else the package imports (torchvision, torchsde, ...)
is replaced by empty stand-ins and need not be installed. The tests read the file and never run Python.
"""

import importlib.util
import math
import pathlib
import sys
import types
from unittest import mock

import torch

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "data"))
from golden_data import write  # noqa: E402

torch.set_default_dtype(torch.float64)


def import_k_diffusion():
    """The package's two modules without its __init__, which would import training and evaluation."""
    package = types.ModuleType("k_diffusion")
    package.__path__ = list(importlib.util.find_spec("k_diffusion").submodule_search_locations)
    sys.modules["k_diffusion"] = package
    for name in ["torchdiffeq", "torchsde", "torchvision", "torchvision.transforms", "PIL", "safetensors"]:
        sys.modules[name] = mock.MagicMock()
    from k_diffusion import external, sampling
    return sampling, external


sampling, external = import_k_diffusion()

SIGMA_MIN, SIGMA_MAX = 0.0292, 14.6146
STARTS = torch.tensor([-22.0, -3.5, 0.25, 17.0])


def stable_diffusion_schedule():
    betas = torch.linspace(math.sqrt(0.00085), math.sqrt(0.012), 1000) ** 2
    return external.DiscreteEpsDDPMDenoiser(None, torch.cumprod(1 - betas, dim=0), quantize=False)


class CountedDenoiser:
    """A clean estimate D(z, sigma), which counts how often it is asked."""

    def __init__(self, estimate):
        self.estimate = estimate
        self.evaluations = 0

    def __call__(self, z, sigma):
        self.evaluations += 1
        return self.estimate(z, sigma)


def gaussian(z, sigma, mu=0.7, s=1.3):
    """Posterior mean under the prior N(mu, s^2)."""
    return (s**2 * z + sigma**2 * mu) / (s**2 + sigma**2)


def two_points(z, sigma):
    """Posterior mean under a prior of two equally likely points, -1 and 1."""
    return torch.tanh(z / sigma**2)


def two_clusters(z, sigma, s=0.5):
    """Posterior mean under a prior of two equally likely clusters, N(-1, s^2) and N(1, s^2)."""
    return (s**2 * z + sigma**2 * torch.tanh(z / (s**2 + sigma**2))) / (s**2 + sigma**2)


def runs():
    """The runs, each with what becomes of the starts."""
    methods = {"euler": sampling.sample_euler, "heun": sampling.sample_heun, "dpmpp_2m": sampling.sample_dpmpp_2m}
    for estimate in (gaussian, two_points, two_clusters):
        for method_name, method in methods.items():
            for steps in (1, 2, 10):
                model = CountedDenoiser(estimate)
                last = method(model, STARTS, sampling.get_sigmas_karras(steps, SIGMA_MIN, SIGMA_MAX), disable=True)
                yield {"prior": estimate.__name__, "sampler": method_name, "steps": steps,
                       "evaluations": model.evaluations, "last": last.tolist()}


def main():
    schedule = stable_diffusion_schedule()
    # k-diffusion rounds times to single precision: these are exact in it.
    times = [0.0, 0.5, 1.0, 10.25, 499.0, 500.75, 998.5, 999.0]
    sigmas_of_times = schedule.t_to_sigma(torch.tensor(times)).tolist()
    levels = [0.001, 0.0292, 0.03, 0.1, 0.5, 1.0, 2.5, 7.0, 14.0, 14.6146, 80.0]
    times_of_levels = schedule.sigma_to_t(torch.tensor(levels)).tolist()

    write("k_diffusion.json", {
        "computed_by": "k-diffusion 0.1.1.post1 in double precision",
        "written_by": "tests/sampling/make_golden.py",
        "karras": {steps: sampling.get_sigmas_karras(steps, SIGMA_MIN, SIGMA_MAX).tolist() for steps in (1, 2, 10, 50)},
        "times": times, "sigmas_of_times": sigmas_of_times,
        "levels": levels, "times_of_levels": times_of_levels,
        "starts": STARTS.tolist(), "runs": list(runs()),
    })


if __name__ == "__main__":
    main()
