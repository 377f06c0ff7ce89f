# SPDX-License-Identifier: MIT
"""What the trainings share: weights in two precisions, a schedule of the learning rate, checkpoints, a line of progress."""

import csv
import ctypes
import math
import time

import numpy
import torch


def keep_freed_memory():
    """Lets glibc keep what is freed for the next step, where a tenth of the time would go to new pages; elsewhere
    nothing."""
    try:
        glibc = ctypes.CDLL("libc.so.6")
        trim_threshold, top_pad, mmap_threshold = -1, -2, -3
        glibc.mallopt(mmap_threshold, 1 << 25)
        glibc.mallopt(trim_threshold, 2**31 - 1)
        glibc.mallopt(top_pad, 1 << 28)
    except (OSError, AttributeError):
        pass


def save_atomically(what, path):
    """A file that is whole or is not there."""
    partial = path.with_suffix(".part")
    torch.save(what, partial)
    partial.replace(path)


def learning_rate(step, steps, highest, warm_up=200, steady=0.5):
    """Warm up, stay until this share of the steps, fall as a cosine to 1 %."""
    if step < warm_up:
        return highest * (step + 1) / warm_up
    fall = min(1.0, max(0.0, (step / steps - steady) / (1 - steady)))
    return highest * (0.01 + 0.99 * (0.5 + 0.5 * math.cos(math.pi * fall)))


class TrainingRun:
    """Moves single-precision masters of a module's parameters, and keeps their running mean; the module multiplies in
    `precision`. A run that was stopped goes on at its last checkpoint, and draws what an unbroken one would."""

    def __init__(self, name, module, checkpoint, steps, rate, seed, precision, minutes=5, weight_decay=1e-3):
        self.name, self.checkpoint, self.steps, self.rate, self.seed = name, checkpoint, steps, rate, seed
        self.seconds = 60 * minutes
        self.masters = {n: p.detach().float().clone() for n, p in module.named_parameters()}
        self.averages = {n: value.clone() for n, value in self.masters.items()}
        self.module = module.to(precision).to(memory_format=torch.channels_last)
        self.parameters = dict(module.named_parameters())
        decayed = [value for value in self.masters.values() if value.dim() > 1]
        others = [value for value in self.masters.values() if value.dim() <= 1]
        self.optimizer = torch.optim.AdamW(
            [dict(params=decayed, weight_decay=weight_decay), dict(params=others, weight_decay=0)], lr=rate,
            betas=(0.9, 0.99))
        self.step, self.losses = 0, []
        if checkpoint.exists():
            saved = torch.load(checkpoint, weights_only=False)
            for n, value in self.masters.items():
                value.copy_(saved["masters"][n])
            self.averages = saved["averages"]
            self.optimizer.load_state_dict(saved["optimizer"])
            self.step, self.losses = saved["step"], saved["losses"]
            print(f"{name}: going on at step {self.step}", flush=True)

    def save(self):
        save_atomically(dict(masters=self.masters, averages=self.averages, optimizer=self.optimizer.state_dict(),
                             step=self.step, losses=self.losses), self.checkpoint)
        # One row for every 100 steps.
        with open(self.checkpoint.with_name(f"{self.name}_loss.csv"), "w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["step", "loss"])
            for last in range(100, len(self.losses) + 1, 100):
                rows.writerow([last, f"{numpy.mean(self.losses[last - 100:last]):.5f}"])

    def train(self, loss_of, samples, every=100, show=lambda step: None):
        """Steps until the last one. `loss_of(random, generator)` draws `samples` examples and says their loss; `show`
        is called after each checkpoint."""
        saved_at = began = time.time()
        first = self.step
        while self.step < self.steps:
            with torch.no_grad():
                for n, parameter in self.parameters.items():
                    parameter.copy_(self.masters[n])
            random = numpy.random.default_rng([self.seed, self.step])
            generator = torch.Generator().manual_seed(self.seed * 1_000_003 + self.step)
            loss = loss_of(random, generator)
            self.module.zero_grad(set_to_none=True)
            loss.backward()
            for n, parameter in self.parameters.items():
                self.masters[n].grad = None if parameter.grad is None else parameter.grad.float()
            torch.nn.utils.clip_grad_norm_(list(self.masters.values()), 1.0)
            for group in self.optimizer.param_groups:
                group["lr"] = learning_rate(self.step, self.steps, self.rate)
            self.optimizer.step()
            keep = min(0.999, (1 + self.step) / (10 + self.step))
            with torch.no_grad():
                torch._foreach_lerp_(list(self.averages.values()), list(self.masters.values()), 1 - keep)
            self.losses.append(loss.item())
            self.step += 1
            now = time.time()
            if self.step % every == 0:
                speed = samples * (self.step - first) / (now - began)
                print(f"{self.name}: step {self.step} of {self.steps}  loss {numpy.mean(self.losses[-every:]):.5f}  "
                      f"{speed:.1f} samples/s", flush=True)
            if now - saved_at > self.seconds or self.step == self.steps:
                self.save()
                show(self.step)
                saved_at = time.time()
        return self

    def averaged(self, into):
        """Loads the running mean into a module of the same shape, in single precision."""
        into.load_state_dict(self.averages)
        return into.float().eval()
