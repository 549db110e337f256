#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluations of python3-cmaes on the functions of tests/unit/cma_test.c, from the same starts: medians.

    python3 tests/bench/cma.py
"""
import statistics

import numpy
from cmaes import CMA


def sphere(x):
    return float(numpy.sum((x - 1) ** 2))


def rosenbrock(x):
    return float(numpy.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))


def ellipsoid(x):
    n = len(x)
    v = numpy.arange(1, n + 1)
    y = x - 2 * v * (v @ x) / (v @ v)
    return float(numpy.sum(1e6 ** (numpy.arange(n) / (n - 1)) * y**2))


def rastrigin(x):
    return float(numpy.sum(x**2 + 10 * (1 - numpy.cos(2 * numpy.pi * x))))


def evaluations(f, n, population, seed):
    bounds = numpy.array([[-5.0, 5.0]] * n)
    search = CMA(mean=numpy.full(n, -2.0), sigma=2.0, bounds=bounds, seed=seed,
                 population_size=population)
    count = 0
    while count < 30000:
        reported = []
        for _ in range(search.population_size):
            x = search.ask()
            value = f(x)
            reported.append((x, value))
            count += 1
        if min(value for _, value in reported) <= 1e-10:
            return count
        search.tell(reported)
    return None


for f, n, population in ((sphere, 10, None), (rosenbrock, 5, None), (ellipsoid, 10, None),
                         (rastrigin, 3, 60)):
    counts = [evaluations(f, n, population, seed) for seed in range(1, 16)]
    median = statistics.median(count or 1e9 for count in counts)
    print(f"{f.__name__} {n}: {median:g} evaluations, {counts.count(None)} of 15 failed")
