# SPDX-License-Identifier: GPL-3.0-or-later
"""Sensitivity with OpenTURNS: which tolerance decides at which load a truss snaps through.

Stiffness, span and height of a shallow two-bar truss scatter by some per cent. OpenTURNS makes the whole sample, one
call of sweep follows every truss's path up to its limit point, and OpenTURNS makes Sobol's indices of
the limit loads.

    python3 sensitivity.py [PICTURE]
"""

# %% The model, and how its parameters scatter
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import openturns as ot

import strut

models = pathlib.Path(__file__).resolve().parents[2] / "models"
picture = sys.argv[1] if len(sys.argv) > 1 else "sensitivity.png"

LOAD = 1000.0  # N; the path's factor counts multiples of it
truss = strut.load(models / "gallery/von-mises.yaml", load=LOAD, stiffness="10 kN/m")
names = ["stiffness", "span", "height"]
spread = [0.08, 0.02, 0.04]  # standard deviations over means
means = [truss[f"parameters.{name}"] for name in names]
inputs = ot.ComposedDistribution([ot.Normal(m, s * m) for m, s in zip(means, spread)])

# %% The whole sample in one call
ot.RandomGenerator.SetSeed(1)
size = 1500
sample = ot.SobolIndicesExperiment(inputs, size).generate()
table = truss.sweep(points=sample, names=names, compute="path", keep="limit_factor")
assert set(table.status) == {"completed"}
loads = table["limit_factor"] * LOAD

# %% The closed form of this truss: every point agrees
stiffness, span, height = np.array(sample).T
length = np.hypot(span, height)
exact = 2 * stiffness * length * (1 - (span / length) ** (2 / 3)) ** 1.5
assert np.allclose(loads, exact, rtol=1e-8)

# %% Indices
sensitivity = ot.SaltelliSensitivityAlgorithm(sample, ot.Sample(loads[:, np.newaxis]), size)
first, total = map(np.array, (sensitivity.getFirstOrderIndices(), sensitivity.getTotalOrderIndices()))
low = np.array(sensitivity.getFirstOrderIndicesInterval().getLowerBound())
high = np.array(sensitivity.getFirstOrderIndicesInterval().getUpperBound())
print(f"{len(table)} trusses: limit load {loads.mean():.0f} N, standard deviation {loads.std():.0f} N")
for name, one, all_ in zip(names, first, total):
    print(f"{name:10} first order {one:.2f}, total {all_:.2f}")
assert first[2] > first[0] > first[1]

# %% A picture
figure, axes = plt.subplots(
    1, 4, figsize=(10, 3), width_ratios=(1, 1, 1, 1.3), layout="constrained"
)
labels = ["stiffness [kN/m]", "half span [m]", "height [m]"]
for axis, values, label, scale in zip(axes, (stiffness, span, height), labels, (1e-3, 1, 1)):
    axis.plot(values * scale, loads, ".", ms=2, alpha=0.5)
    axis.set(xlabel=label, ylim=(0, 1.05 * loads.max()))
    axis.label_outer()
axes[0].set_ylabel("limit load [N]")
bars = axes[3]
place = np.arange(len(names))
bars.bar(place - 0.2, first, 0.4, label="first order", color="tab:blue")
bars.errorbar(place - 0.2, first, [first - low, high - first], fmt="none", ecolor="k", capsize=3)
bars.bar(place + 0.2, total, 0.4, label="total", color="tab:orange")
bars.set(xticks=place, xticklabels=["stiffness", "span", "height"], ylabel="Sobol's index", ylim=(0, 1))
bars.legend(frameon=False, loc="upper left")
figure.savefig(picture, dpi=150)
