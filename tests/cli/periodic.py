# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of strut path --periodic share: oscillators of known motions, and Duffing's folds."""
import math

from testing import answer, models

DUFFING = f"{models}/basics/duffing.yaml"
BILINEAR = """strut: 1
name: Bilinear oscillator, which meets a spring when it has gone as far as the gap
parameters: {frequency: 1 Hz, gap: 30 mm, push: 1 N}
nodes: {top: {position: [0, 1 + gap], fixed: both}, mass: {position: [0, gap], fixed: x, mass: 1}}
members: {spring: {kind: spring, nodes: [top, mass], stiffness: 100, damping: 1, rest_length: 1}}
ground: {stiffness: 100, damping: 0, contacts: {mass: {}}}
loads: {push: {node: mass, force: [0, push], signal: {sine: {amplitude: 1, frequency: frequency}}}}
solver: {integrator: rk4, step: 1 ms}
run: {periods: 100, of: push, measure: {node: mass}}
"""
WELLS = """strut: 1
name: Two wells, whose motions double their period ever again
parameters: {force: 0.17 N, damping: 0.25 N s/m, start: 10.2 m}
nodes: {wall: {position: [0, 0], fixed: both}, mass: {position: [start, 0], fixed: y, mass: 1}}
members:
  spring: {kind: spring, nodes: [wall, mass], law: {kind: polynomial, coefficients: [-1 N/m, 0, 1 N/m^3]},
           damping: damping, rest_length: 10}
loads: {push: {node: mass, force: [force, 0], signal: {sine: {amplitude: 1, frequency: 1/(2*pi)*1 Hz}}}}
solver: {integrator: rk4, step: 1 ms}
run: {periods: 200, of: push, measure: {node: mass}}
"""


def follow(model, over, *words, **how):
    return answer("path", "--periodic", model, "--over", over, *words, **how)


def special(result, kind, branch=0):
    return [point for point in result["branches"][branch]["special"] if point["point"] == kind]


def duffing_folds(amplitude):
    """(Hz, N) of both folds of DUFFING's harmonic balance ((s - w^2)^2 + (c w)^2) A^2 = F^2, with
    s = 1 + 3/4 b A^2: where its derivative by A^2 vanishes, a quadratic equation of w^2."""
    cubic = damping = 0.05
    s = 0.75 * cubic * amplitude**2
    mean, product = 1 + 2 * s - damping**2 / 2, (1 + s) * (1 + 3 * s)
    squares = [mean + sign * math.sqrt(mean**2 - product) for sign in (-1, 1) if mean**2 >= product]
    return [(math.sqrt(w2) / 2 / math.pi, amplitude * math.sqrt((1 + s - w2)**2 + damping**2 * w2)) for w2 in squares]


def duffing_folds_at(force):
    """Frequencies [Hz] of both, the upper one first."""
    curves = zip(*(pair for k in range(300, 6000) if len(pair := duffing_folds(1e-3 * k)) == 2))
    return [a[0] + (force - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for curve in curves
            for a, b in zip(curve, curve[1:]) if (a[1] - force) * (b[1] - force) <= 0]
