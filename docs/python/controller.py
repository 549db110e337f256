# SPDX-License-Identifier: GPL-3.0-or-later
"""A controller for the crawler: it walks at a wanted speed by switching its drive on and off.

At full drive the crawler walks at about 10 mm/s, and when the drive stops it coasts for five periods, so that
its velocity of the moment says little. Once a period of the drive the controller sums up the error of the
velocity so far, and switches the drive on if it walked too little and off otherwise (bang-bang control).

    python3 controller.py [PICTURE]
"""

# %% The model, and a simulation that is advanced from here
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import strut

models = pathlib.Path(__file__).resolve().parents[2] / "models"
picture = sys.argv[1] if len(sys.argv) > 1 else "controller.png"

crawler = strut.load(models / "crawler/crawler.yaml")
sim = crawler.simulation(step="0.1 ms")
period = 1 / crawler["parameters.frequency"]
steps = round(period / sim.step)
AS_THE_SCENE_SAYS, OFF = np.nan, 0.0

# %% Control
def wanted(time: float) -> float:
    """Wanted velocity [m/s]."""
    return 4e-3 if time < 8 else 7e-3 if time < 16 else 2e-3


x = sim.position["n1"]  # a live view: it follows the simulation
times, positions, drives = [sim.time], [x[0]], []
error = 0.0  # of the velocity, summed up [m]
while sim.time < 24 - 1e-6:
    on = error > 0
    sim.actuators["drive"] = AS_THE_SCENE_SAYS if on else OFF
    error += wanted(sim.time) * period
    sim.advance(steps)
    error -= x[0] - positions[-1]
    times.append(sim.time)
    positions.append(x[0])
    drives.append(on)

# %% How well it did, and a picture
times, positions = np.array(times), np.array(positions)
for begin, end in ((0, 8), (8, 16), (16, 24)):
    a, b = round(begin / period), round(end / period)
    mean = (positions[b] - positions[a]) / (end - begin)
    print(f"{begin} to {end} s: wanted {wanted(begin) * 1e3:.1f} mm/s, walked {mean * 1e3:.2f} mm/s")
assert abs(error) < 5e-3

goal = np.concatenate([[0], np.cumsum([wanted(t) * period for t in times[:-1]])])
figure, (path, lag, switch) = plt.subplots(
    3, 1, sharex=True, figsize=(7, 5.5), height_ratios=(4, 2, 1), layout="constrained"
)
path.plot(times, (positions - positions[0]) * 1e3, color="tab:blue", label="node n1")
path.plot(times, goal * 1e3, "k--", linewidth=1, label="at the wanted velocity")
for begin, name in ((0, "4 mm/s"), (8, "7 mm/s"), (16, "2 mm/s")):
    path.annotate(name, (begin + 4, 3), ha="center")
    path.axvline(begin, color="0.85", linewidth=0.8)
path.set(ylabel="distance [mm]")
path.legend(frameon=False, loc="upper left")
lag.plot(times, (positions - positions[0] - goal) * 1e3, color="tab:blue")
lag.axhline(0, color="k", linestyle="--", linewidth=1)
lag.set(ylabel="ahead [mm]")
switch.fill_between(times[:-1], np.array(drives, float), step="post", color="tab:orange")
switch.set(ylabel="drive", yticks=[0, 1], yticklabels=["off", "on"], xlabel="time [s]", xlim=(0, 24))
figure.align_ylabels()
figure.savefig(picture, dpi=150)
