# SPDX-License-Identifier: GPL-3.0-or-later
"""scipy's optimiser over a gait: the frequency and the phase between two drives that walk fastest.

The crawler gets a second drive on its other strong spring. Velocity over frequency and phase is full of cliffs, where
the robot falls into another state, so a method without derivatives is used: differential evolution,
which asks for whole generations at once. One call of sweep computes a generation on all processors.

    python3 gait.py [PICTURE]
"""

# %% The model: that of the file, changed key by key
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import differential_evolution

import strut

models = pathlib.Path(__file__).resolve().parents[2] / "models"
picture = sys.argv[1] if len(sys.argv) > 1 else "gait.png"

TWO_DRIVES = """
strut: 1
base: crawler.yaml
name: Crawler with two drives
parameters: {phase: 0 deg}
actuators:
  second: {member: m9, signal: {sine: {amplitude: amplitude, frequency: frequency, phase: phase}}}
solver: {accuracy: 2 %}
run: {measure: {steady: true}}
"""
robot = strut.loads(TWO_DRIVES, name=str(models / "crawler/two-drives.yaml"))

# %% The objective, for many gaits at once
bounds = {"frequency": (9.0, 14.0), "phase": (-np.pi, np.pi)}
tried = []


def slowness(gaits: np.ndarray) -> np.ndarray:
    """Minus the velocity of each column of gaits (parameters, gaits)."""
    table = robot.sweep(points=gaits.T, names=list(bounds), keep="velocity")
    velocity = np.nan_to_num(table["velocity"])  # a gait that fails does not walk
    tried.extend(zip(*gaits, velocity))
    return -velocity


# %% Search
found = differential_evolution(
    slowness, list(bounds.values()), vectorized=True, updating="deferred",
    popsize=8, maxiter=7, polish=False, seed=2,
)  # fmt: skip
frequency, phase = found.x
best = robot(frequency=frequency, phase=phase).run(record=False)
alone = strut.load(models / "crawler/crawler.yaml").run(accuracy="2 %", record=False)
print(f"one drive at 10 Hz: {alone.velocity * 1e3:.2f} mm/s")
print(
    f"two drives at {frequency:.2f} Hz, {np.degrees(phase):.0f} deg apart: "
    f"{best.velocity * 1e3:.2f} mm/s, after {len(tried)} runs"
)
assert best.velocity == -found.fun  # a point of a sweep has the bits of a run
assert best.velocity > 1.2 * alone.velocity

# %% A picture
frequencies, phases, velocities = np.array(tried).T
figure, (map_, curve) = plt.subplots(1, 2, figsize=(8.5, 3.6), layout="constrained")
order = np.argsort(velocities)
dots = map_.scatter(
    frequencies[order], np.degrees(phases[order]), c=velocities[order] * 1e3, s=22, cmap="viridis"
)
map_.plot(frequency, np.degrees(phase), "o", ms=11, mfc="none", mec="tab:red", mew=1.8)
map_.set(xlabel="frequency [Hz]", ylabel="phase [deg]", yticks=range(-180, 181, 90))
figure.colorbar(dots, ax=map_)
map_.set_title("velocity of each run [mm/s]", fontsize="medium")
curve.plot(velocities * 1e3, ".", ms=4, color="0.6", label="each run")
curve.plot(np.maximum.accumulate(velocities) * 1e3, color="tab:red", label="fastest so far")
curve.axhline(alone.velocity * 1e3, color="k", linestyle="--", linewidth=1, label="one drive")
curve.set(xlabel="run", ylabel="velocity [mm/s]", ylim=(-0.5, 1.45e3 * velocities.max()))
curve.legend(frameon=False, loc="upper right")
figure.savefig(picture, dpi=150)
