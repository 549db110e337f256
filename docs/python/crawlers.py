# SPDX-License-Identifier: GPL-3.0-or-later
"""A search over structures: which connectivity and which lengths crawl faster and cheaper than the paper's.

A topology is a connected graph of 3 to 6 nodes and at most 9 members, each a bar or a spring, one spring
driven. All have the paper's mass, size at rest, ground, drive and kinds of members, and no mechanism. A shape
is drawn at random so that it rests as drawn: the forces follow from the equilibrium and the states of
self-stress, the rest lengths from the forces. Its lowest frequency must lie near the drive's; that needs no
run. Then runs on three grounds decide. docs/articles/design-a-crawler.md tells what came out.

    python3 crawlers.py [PICTURE] [--topologies N] [--shapes N] [--finalists N] [--evaluations N]
                        [--robust N] [--robust-evaluations N] [--seed N] [-o FILE]
"""

# %% What all candidates share
import argparse
import itertools
import json
import math

import numpy as np

import strut

MASS, GRAVITY = 0.140, 9.81  # kg, m/s^2
WIDTH, HEIGHT = 96.5e-3, 28.4e-3  # m, of the paper's crawler in state I
BAR, SPRINGS = 1e6, (3000.0, 10000.0)  # N/m
LARGEST_FORCE = 600.0  # N; 581 N in the paper's crawler
AMPLITUDE, FREQUENCY = 0.1e-3, 10.0  # m, Hz: the paper's drive
# What the paper's crawler does on each ground: velocity [m/s] and cost of transport. As made (stiffer: 1) these
# are its best over 5 to 15 Hz from states I and II, each number at a frequency of its own, costs at more than
# 1 mm/s. With springs 5 % softer or stiffer the frequency is 9.7 Hz for velocity and 10 Hz for cost, where the
# worst of them are best.
RIVAL = {  # stiffer: {friction: ...}
    0.95: {
        0.1: (11.8e-3, 0.67),
        0.2: (16.0e-3, 0.45),
        0.3: (13.6e-3, 0.51),
        0.4: (10.9e-3, 0.72),
        0.5: (7.2e-3, 1.08),
    },
    1.00: {
        0.1: (15.45e-3, 0.390),
        0.15: (22.16e-3, 0.394),
        0.2: (23.10e-3, 0.384),
        0.25: (19.03e-3, 0.420),
        0.3: (19.93e-3, 0.450),
        0.35: (18.51e-3, 0.512),
        0.4: (14.95e-3, 0.605),
        0.45: (12.75e-3, 0.690),
        0.5: (11.69e-3, 0.800),
    },
    1.05: {
        0.1: (13.0e-3, 0.69),
        0.2: (16.2e-3, 0.67),
        0.3: (19.6e-3, 0.56),
        0.4: (16.3e-3, 0.71),
        0.5: (12.8e-3, 0.91),
    },
}
THREE, FIVE = (0.1, 0.2, 0.5), (0.1, 0.2, 0.3, 0.4, 0.5)  # frictions


# %% Connectivities: graphs without a mechanism, up to renaming of nodes
def pairs(nodes: int) -> list[tuple[int, int]]:
    return list(itertools.combinations(range(nodes), 2))


def rows(position: np.ndarray, edges: list[tuple[int, int]]) -> np.ndarray:
    """How member lengths change with coordinates (members, 2 nodes), for positions (nodes, 2)."""
    matrix = np.zeros((len(edges), position.size))
    for row, (a, b) in zip(matrix, edges):
        unit = position[b] - position[a]
        unit = unit / np.linalg.norm(unit)
        row[2 * a : 2 * a + 2], row[2 * b : 2 * b + 2] = -unit, unit
    return matrix


def rank(position: np.ndarray, edges: list[tuple[int, int]]) -> int:
    return int(np.linalg.matrix_rank(rows(position, edges), tol=1e-9)) if edges else 0


def renamings(nodes: int) -> np.ndarray:
    """Where each permutation of nodes takes each pair, (permutations, pairs)."""
    index = {pair: i for i, pair in enumerate(pairs(nodes))}
    return np.array(
        [
            [index[min(p[a], p[b]), max(p[a], p[b])] for a, b in pairs(nodes)]
            for p in itertools.permutations(range(nodes))
        ]
    )


def graphs(nodes: int, members: int) -> list[tuple[int, ...]]:
    """Graphs of that many members without a mechanism, as numbers of pairs, one for each class."""
    moves = renamings(nodes)
    generic = np.random.default_rng(7).normal(size=(nodes, 2))
    seen: set[int] = set()
    found = []
    for chosen in itertools.combinations(range(len(pairs(nodes))), members):
        name = int((1 << moves[:, chosen].astype(np.int64)).sum(axis=1).min())
        if name in seen:
            continue
        seen.add(name)
        if rank(generic, [pairs(nodes)[i] for i in chosen]) == 2 * nodes - 3:
            found.append(chosen)
    return found


def topologies(nodes: int, members: int) -> list[dict]:
    """All kinds of members of those graphs: every node has a bar, bars do not hold the driven spring."""
    generic = np.random.default_rng(7).normal(size=(nodes, 2))
    found = []
    for chosen in graphs(nodes, members):
        edges = [pairs(nodes)[i] for i in chosen]
        place = {pair: i for i, pair in enumerate(chosen)}
        moves = renamings(nodes)[:, chosen]
        own = [[place[i] for i in row] for row in moves if set(row) == set(chosen)]
        seen = set()
        for kinds in itertools.product("bs", repeat=members):
            bars = [e for e, kind in zip(edges, kinds) if kind == "b"]
            if set(itertools.chain(*bars)) != set(range(nodes)) or rank(generic, bars) < len(bars):
                continue
            for driven in (i for i, kind in enumerate(kinds) if kind == "s"):
                if rank(generic, [*bars, edges[driven]]) == len(bars):
                    continue
                word = "".join("d" if i == driven else kind for i, kind in enumerate(kinds))
                name = min("".join(word[row.index(i)] for i in range(members)) for row in own)
                if name not in seen:
                    seen.add(name)
                    found.append({"nodes": nodes, "edges": edges, "kinds": word})
    return found


# %% A shape: genes to a structure that rests as drawn
class Shape:
    """Positions, forces and rest lengths of a topology; `frequency` is NaN if it does not stand."""

    def __init__(self, topology: dict, genes: dict) -> None:
        self.topology, self.genes = topology, genes
        edges, n = topology["edges"], topology["nodes"]
        self.position = np.array(genes["position"]) * 1e-3
        self.stiffness = np.array(
            [BAR if k == "b" else SPRINGS[s] for k, s in zip(topology["kinds"], genes["strong"])]
        )
        ends = np.array(edges)
        difference = self.position[ends[:, 1]] - self.position[ends[:, 0]]
        self.length = np.hypot(*difference.T)
        self.frequency, self.force = math.nan, np.zeros(len(edges))
        low, high = self.position.min(axis=0), self.position.max(axis=0)
        if np.any(high - low > (WIDTH, HEIGHT)) or np.any(self.length < 8e-3):
            return
        is_bar = np.array([k == "b" for k in topology["kinds"]])
        self.mass = np.where(is_bar, self.length, 0.0) * MASS / self.length[is_bar].sum()

        # Feet are the two nodes on the ground; the centre of mass lies between them.
        feet = [i for i in range(n) if self.position[i, 1] == 0.0]
        load = np.zeros((n, 2))
        np.add.at(load[:, 1], ends.ravel(), -0.5 * GRAVITY * np.repeat(self.mass, 2))
        centre = (load[:, 1] @ self.position[:, 0]) / load[:, 1].sum()
        x = self.position[feet, 0]
        share = (centre - x[0]) / (x[1] - x[0])
        if len(feet) != 2 or not 0.02 < share < 0.98:
            return
        load[feet[0], 1] += (1.0 - share) * MASS * GRAVITY
        load[feet[1], 1] += share * MASS * GRAVITY

        # Equilibrium, and the states of self-stress as the genes say.
        compatibility = rows(self.position, edges)
        left, value, right = np.linalg.svd(compatibility.T)
        order = 2 * n - 3
        if value[order - 1] < 1e-3:
            return
        force = right[:order].T @ ((left[:, :order].T @ load.ravel()) / value[:order])
        own = right[order:]
        if len(own):
            force = force + np.array(genes["stress"]) @ own
        self.force = force
        self.rest = self.length - force / self.stiffness
        if np.abs(force).max() > LARGEST_FORCE or np.any(self.rest < 4e-3):
            return
        self._vibrate(compatibility, difference / self.length[:, None], ends, feet)

    def _vibrate(self, compatibility, unit, ends, feet) -> None:
        """Lowest frequency with sliding feet, and how strongly the drive excites it."""
        n = len(self.position)
        k = compatibility.T @ (self.stiffness[:, None] * compatibility)
        m = np.zeros((2 * n, 2 * n))
        for (a, b), u, tension, mass in zip(ends, unit, self.force / self.length, self.mass):
            across = tension * (np.eye(2) - np.outer(u, u))
            for p, q, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                k[2 * p : 2 * p + 2, 2 * q : 2 * q + 2] += sign * across
                m[2 * p : 2 * p + 2, 2 * q : 2 * q + 2] += np.eye(2) * mass / (3 if p == q else 6)
        for foot in feet:
            k[2 * foot + 1, 2 * foot + 1] += 1e5
        root = np.linalg.inv(np.linalg.cholesky(m))
        value, vector = np.linalg.eigh(root @ k @ root.T)
        if value[0] < -1.0 or value[1] < 1.0:  # beside the free motion along the ground
            return
        self.frequency = math.sqrt(value[1]) / (2 * math.pi)
        mode = root.T @ vector[:, 1]
        driven = self.topology["kinds"].index("d")
        push = self.stiffness[driven] * AMPLITUDE * abs(compatibility[driven] @ mode) / value[1]
        self.excitation = push * np.abs(mode).max()  # static amplitude of the mode [m]

    def stands(self) -> bool:
        return 0.85 * FREQUENCY < self.frequency < 1.3 * FREQUENCY

    def scene(self, **solver: object) -> dict:
        """The structure and its experiment, as a scene's file has them."""
        members = {}
        for i, ((a, b), kind) in enumerate(zip(self.topology["edges"], self.topology["kinds"])):
            members[f"m{i + 1}"] = {
                "kind": "bar" if kind == "b" else "spring",
                "nodes": [f"n{a + 1}", f"n{b + 1}"],
                "stiffness": f"{self.stiffness[i]} N/m * stiffer" if kind != "b" else BAR,
                "damping": "0.2 N s/m",
                "rest_length": self.rest[i],
            } | ({"mass": self.mass[i]} if kind == "b" else {})
        drive = f"m{self.topology['kinds'].index('d') + 1}"
        sine = {"amplitude": "amplitude", "frequency": "frequency"}
        return {
            "strut": 1,
            "parameters": {
                "frequency": FREQUENCY,
                "amplitude": AMPLITUDE,
                "friction": 0.1,
                "stiffer": 1.0,
            },
            "nodes": {f"n{i + 1}": list(p) for i, p in enumerate(self.position)},
            "members": members,
            "gravity": [0, -GRAVITY],
            "ground": {
                "stiffness": "1e5 N/m",
                "damping": "100 N s/m",
                "friction": {"law": "karnopp", "mu": "friction", "stick_velocity": "0.1 mm/s"},
            },
            "actuators": {"drive": {"member": drive, "signal": {"sine": sine}}},
            "initial": {"settle": True},
            "solver": solver or {"integrator": "verlet-events", "step": "80 us"},
            "run": {
                "periods": 50,
                "of": "drive",
                "measure": {"last": 12},
            },
        }


def draw(topology: dict, random: np.random.Generator) -> Shape:
    """A random shape; most do not stand."""
    n = topology["nodes"]
    position = np.column_stack([random.uniform(0, 1, n), random.uniform(0.1, 1, n)])
    position[random.choice(n, 2, replace=False), 1] = 0.0
    position[:, 0] -= position[:, 0].min()
    position *= [random.uniform(0.6, 1) * 1e3 * WIDTH / position[:, 0].max(), 1e3 * HEIGHT]
    states = len(topology["edges"]) - (2 * n - 3)
    genes = {
        "position": position.tolist(),
        "stress": (random.normal(size=states) * 10 ** random.uniform(0, 2.8)).tolist(),
        "strong": [int(random.random() < 0.4) for _ in topology["edges"]],
    }
    return Shape(topology, genes)


# %% What decides: the worst of several grounds, in velocity and in cost of transport
def performance(shape: Shape, frictions=THREE, stiffer=(1.0,), **solver: object) -> np.ndarray:
    """Velocities [m/s] and costs of transport, (2, grounds, stiffnesses); NaN where a run fails."""
    try:
        scene = strut.Scene.from_dict(shape.scene(**solver))
        table = scene.sweep(
            friction=list(frictions),
            stiffer=list(stiffer),
            keep=["velocity", "cost_of_transport"],
            threads=1,
            limit_evaluations=1_000_000,
        )
    except strut.RunError:
        return np.full((2, len(frictions), len(stiffer)), np.nan)
    return np.array([table.grid("velocity"), table.grid("cost_of_transport")])


def score(found: np.ndarray, frictions=THREE, stiffer=(1.0,)) -> float:
    """Above 1: faster and cheaper than the rival's best on every ground, in one direction.

    A tenth of the mean tells candidates apart whose worst ratio is equally bad.
    """
    velocity, cost = found
    if not np.all(np.isfinite(velocity)) or not np.all(cost > 0):
        return -1.0
    rival = np.array([[RIVAL[s][friction] for s in stiffer] for friction in frictions])
    forward = velocity * np.sign(velocity.sum())
    faster = forward / rival[:, :, 0]
    cheaper = rival[:, :, 1] / cost * np.sign(forward)
    ratios = np.concatenate([faster, cheaper])
    return float(ratios.min() + 0.1 * (np.clip(ratios, -1, 2).mean() - 1))


def evaluate(shape: Shape, hopeless: float, frictions=THREE, stiffer=(1.0,)) -> dict:
    """Runs on all grounds, or on the second one only if that is too bad already."""
    second = performance(shape, frictions[1:2], stiffer)
    ratio = np.abs(second[0]).min() / RIVAL[1.0][frictions[1]][0]
    if not ratio > hopeless:
        return {"score": -1.0 + (ratio if ratio > 0 else 0.0)}
    rest = performance(shape, frictions[:1] + frictions[2:], stiffer)
    found = np.concatenate([rest[:, :1], second, rest[:, 1:]], axis=1)
    return {
        "score": score(found, frictions, stiffer),
        "velocity": found[0].tolist(),
        "cost": found[1].tolist(),
    }


# %% Search over the lengths of one topology: CMA-ES, after Hansen's tutorial (arXiv:1604.00772)
class Cma:
    """Ask for points, tell their values; the least is sought."""

    def __init__(self, start: np.ndarray, scale: np.ndarray, random: np.random.Generator) -> None:
        n = self.n = len(start)
        self.mean, self.scale, self.random = np.zeros(n), scale, random
        self.start, self.sigma, self.cov = start, 1.0, np.eye(n)
        self.size = 4 + int(3 * math.log(n))
        weights = np.log(self.size / 2 + 0.5) - np.log(np.arange(1, self.size // 2 + 1))
        self.weights = weights / weights.sum()
        self.mu = 1 / (self.weights**2).sum()
        mu = self.mu
        self.cs, self.cc = (mu + 2) / (n + mu + 5), (4 + mu / n) / (n + 4 + 2 * mu / n)
        self.c1 = 2 / ((n + 1.3) ** 2 + mu)
        self.cmu = min(1 - self.c1, 2 * (mu - 2 + 1 / mu) / ((n + 2) ** 2 + mu))
        self.damp = 1 + 2 * max(0.0, math.sqrt((mu - 1) / (n + 1)) - 1) + self.cs
        self.ps, self.pc = np.zeros(n), np.zeros(n)
        self._decompose()

    def _decompose(self) -> None:
        value, self.axes = np.linalg.eigh((self.cov + self.cov.T) / 2)
        self.spread = np.sqrt(np.maximum(value, 1e-14))

    def ask(self) -> np.ndarray:
        step = self.axes @ (self.spread * self.random.normal(size=self.n))
        return self.mean + self.sigma * step

    def point(self, x: np.ndarray) -> np.ndarray:
        return self.start + self.scale * x

    def tell(self, xs: list[np.ndarray], values: list[float]) -> None:
        best = np.array(xs)[np.argsort(values, kind="stable")[: len(self.weights)]]
        steps = (best - self.mean) / self.sigma
        step = self.weights @ steps
        self.mean = self.mean + self.sigma * step
        white = self.axes @ ((self.axes.T @ step) / self.spread)
        self.ps = (1 - self.cs) * self.ps + math.sqrt(self.cs * (2 - self.cs) * self.mu) * white
        length = np.linalg.norm(self.ps) / (math.sqrt(self.n) * (1 - 1 / (4 * self.n)))
        on = length < 1.4 + 2 / (self.n + 1)
        self.pc = (1 - self.cc) * self.pc + on * math.sqrt(self.cc * (2 - self.cc) * self.mu) * step
        self.cov = (
            (1 - self.c1 - self.cmu) * self.cov
            + self.c1 * np.outer(self.pc, self.pc)
            + self.cmu * (steps.T * self.weights) @ steps
        )
        self.sigma *= math.exp(min(1.0, self.cs / self.damp * (length - 1)))
        self._decompose()


def vector(genes: dict) -> tuple[np.ndarray, np.ndarray]:
    """Genes as numbers, and by how much they may change at first."""
    position = np.array(genes["position"])
    free = position[:, 1] > 0
    stress = np.array(genes["stress"])
    start = np.concatenate([position[:, 0], position[free, 1], stress])
    scale = np.concatenate(
        [np.full(len(position), 3.0), np.full(free.sum(), 1.5), 0.1 * np.abs(stress) + 0.5]
    )
    return start, scale


def with_vector(shape: Shape, x: np.ndarray) -> Shape:
    genes = dict(shape.genes)
    position = np.array(genes["position"])
    n, free = len(position), position[:, 1] > 0
    position[:, 0] = x[:n]
    height = x[n : n + free.sum()]
    position[free, 1] = np.clip(height, 1.0, 1e3 * HEIGHT)
    genes |= {"position": position.tolist(), "stress": x[n + free.sum() :].tolist()}
    return Shape(shape.topology, genes)


def improve(shape: Shape, found: dict, evaluations: int, random: np.random.Generator, **on):
    """The best of so many evaluations around a shape, and what it does."""
    best = (found["score"], shape, found)
    cma = Cma(*vector(shape.genes), random)
    spent = 0
    while spent < evaluations and cma.sigma > 1e-3:
        xs, values = [], []
        for _ in range(50 * cma.size):
            x = cma.ask()
            candidate = with_vector(shape, cma.point(x))
            if candidate.stands():
                result = evaluate(candidate, 0.1, **on)
                spent += 1
                xs.append(x)
                values.append(-result["score"])
                if result["score"] > best[0]:
                    best = (result["score"], candidate, result)
                if len(xs) == cma.size:
                    break
        else:
            cma.sigma *= 0.5
            continue
        cma.tell(xs, values)
    return best[1], best[2]


# %% The whole search
def candidates(count: int, seed: int) -> list[dict]:
    """Topologies of 3 to 5 nodes, all of them while count lasts, then some of 6 nodes; numbered."""
    random = np.random.default_rng(seed)
    few = [
        topology
        for nodes in (3, 4, 5)
        for members in range(2 * nodes - 3, min(9, len(pairs(nodes))) + 1)
        for topology in topologies(nodes, members)
    ]
    many = topologies(6, 9) if count > len(few) else []
    for number, topology in enumerate(few + many):
        topology["number"] = number
    if not many:
        return [few[i] for i in random.permutation(len(few))[:count]]
    chosen = random.choice(len(many), count - len(few), replace=False)
    return few + [many[i] for i in sorted(chosen)]


def screen(topology: dict, shapes: int, seed: int):
    """The best of some random shapes: those that the drive excites most."""
    random = np.random.default_rng([seed, topology["number"]])
    drawn = (draw(topology, random) for _ in range(300))
    standing = list(itertools.islice((s for s in drawn if s.stands()), 8))
    standing.sort(key=lambda shape: -shape.excitation)
    tried = [(evaluate(shape, 0.1), shape) for shape in standing[:shapes]]
    return max(tried, key=lambda pair: pair[0]["score"], default=None)


def report(shape: Shape, found: dict) -> str:
    nominal = len(found["velocity"][0]) // 2
    velocity, cost = (np.array(found[key])[:, nominal] for key in ("velocity", "cost"))
    return (
        f"topology {shape.topology['number']:4} ({len(shape.topology['edges'])} members "
        f"{shape.topology['kinds']}), lowest frequency {shape.frequency:.2f} Hz: "
        f"velocity {np.round(1e3 * velocity, 1)} mm/s, cost {np.round(cost, 3)}, "
        f"score {found['score']:.3f}"
    )


def search(options: argparse.Namespace) -> list[tuple[dict, Shape]]:
    """Screens topologies, improves the best, and the best of these once more with springs 5 % off."""
    screened = []
    for topology in candidates(options.topologies, options.seed):
        best = screen(topology, options.shapes, options.seed)
        if best:
            screened.append(best)
    screened.sort(key=lambda pair: -pair[0]["score"])
    print(f"{len(screened)} topologies stand, {sum('cost' in f for f, _ in screened)} crawl")
    improved = []
    for found, shape in (pair for pair in screened[: options.finalists] if "cost" in pair[0]):
        random = np.random.default_rng([options.seed + 1, shape.topology["number"]])
        shape, found = improve(shape, found, options.evaluations, random)
        improved.append((found, shape))
        print(report(shape, found), flush=True)
    improved.sort(key=lambda pair: -pair[0]["score"])
    robust = []
    on = {"frictions": FIVE, "stiffer": (0.95, 1.0, 1.05)}
    for _, shape in improved[: options.robust]:
        random = np.random.default_rng([options.seed + 2, shape.topology["number"]])
        start = evaluate(shape, -1, **on)
        shape, found = improve(shape, start, options.robust_evaluations, random, **on)
        robust.append((found, shape))
        if "cost" in found:
            print("robust:", report(shape, found), flush=True)
    robust.sort(key=lambda pair: -pair[0]["score"])
    return robust + improved + screened


def picture(found: dict, shape: Shape, path: str) -> None:
    """The best shape, and its velocity and cost beside the rival's."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (drawing, speed, cost) = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")
    for (a, b), kind in zip(shape.topology["edges"], shape.topology["kinds"]):
        color, width = {"b": ("k", 3), "s": ("tab:blue", 1.5), "d": ("tab:green", 2.5)}[kind]
        drawing.plot(*(1e3 * shape.position[[a, b]].T), color=color, linewidth=width)
    drawing.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title="driven: green")
    nominal = len(found["velocity"][0]) // 2
    ours = [np.abs(np.array(found[key])[:, nominal]) for key in ("velocity", "cost")]
    rival = np.array([RIVAL[1.0][friction] for friction in THREE]).T
    grounds = THREE if len(ours[0]) == len(THREE) else FIVE
    for axis, label, scale, a, b in (
        (speed, "speed [mm/s]", 1e3, ours[0], rival[0]),
        (cost, "cost of transport", 1, ours[1], rival[1]),
    ):
        axis.plot(grounds, scale * a, "o-", label="found")
        axis.plot(THREE, scale * b, "s--", color="0.5", label="the paper's, at its best")
        axis.set(xlabel="friction", ylabel=label, ylim=(0, None))
        axis.legend(frameon=False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("picture", nargs="?", default="crawlers.png")
    parser.add_argument("--topologies", type=int, default=12)
    parser.add_argument("--shapes", type=int, default=2)
    parser.add_argument("--finalists", type=int, default=1)
    parser.add_argument("--robust", type=int, default=0)
    parser.add_argument("--robust-evaluations", type=int, default=300)
    parser.add_argument("--evaluations", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output", help="a line of JSON for each topology")
    options = parser.parse_args()
    ranking = search(options)
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            for found, shape in ranking:
                row = {"topology": shape.topology, "genes": shape.genes, **found}
                file.write(json.dumps(row) + "\n")
    picture(*ranking[0], options.picture)
