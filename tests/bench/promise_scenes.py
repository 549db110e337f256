# SPDX-License-Identifier: GPL-3.0-or-later
"""Random scenes of six classes: smooth, contact, friction, stiff, wide, robots. Numbers in SI units.

make(kind, random) gives (scene, grid): the scene as a mapping that JSON writes, and a time [s] that
divides the whole run and its window, small beside the fastest motion that matters.
"""
import math

import wide_scenes

GRAVITY = 9.81


def frame(random, count, radius, stiffness, damping, mass, height):
    """A polygon of `count` nodes with every diagonal, its lowest node at `height`."""
    turn = random.uniform(0, 2 * math.pi)
    corner = [(radius * random.uniform(0.8, 1.2) * math.cos(turn + 2 * math.pi * i / count),
               radius * random.uniform(0.8, 1.2) * math.sin(turn + 2 * math.pi * i / count))
              for i in range(count)]
    low = min(y for _, y in corner)
    nodes = {f"n{i}": [x, y - low + height] for i, (x, y) in enumerate(corner)}
    members = {f"m{i}{j}": {"kind": "bar", "nodes": [f"n{i}", f"n{j}"],
                            "stiffness": stiffness * random.uniform(0.5, 2), "damping": damping,
                            "mass": mass * random.uniform(0.5, 1.5)}
               for i in range(count) for j in range(i + 1, count)}
    return nodes, members


def thrown(random, nodes, speed, spin):
    """Velocities of a body that flies and turns."""
    x = sum(p[0] for p in nodes.values()) / len(nodes)
    y = sum(p[1] for p in nodes.values()) / len(nodes)
    vx, vy, turn = random.uniform(-speed, speed), random.uniform(-speed, speed), random.uniform(-spin, spin)
    return {n: [vx - turn * (p[1] - y), vy + turn * (p[0] - x)] for n, p in nodes.items()}


def timed(scene, duration, node=None, last=None):
    """A run over so much time; its grid divides it and its window."""
    grid = duration / 2000
    measure = {}
    if node:
        measure["node"] = node
    if last:
        measure["last"] = last * duration
    scene["run"] = {"duration": duration}
    if measure:
        scene["run"]["measure"] = measure
    scene["solver"] = {"step": grid}
    return scene, grid


def periodic(scene, frequency, periods, last, drive, node=None):
    measure = {"last": last}
    if node:
        measure["node"] = node
    scene["run"] = {"periods": periods, "of": drive, "measure": measure}
    scene["solver"] = {"step": 1 / frequency / 400}
    return scene, 1 / frequency / 400


def part(random):
    """Of a run, to measure over: all of it, or a last part that no step need divide evenly."""
    return random.choice([None, 0.25, 0.5, random.uniform(0.1, 0.9)])


def chain(random, ratio=None):
    count = random.randint(2, 5)
    length, mass = random.uniform(0.1, 1), random.uniform(0.1, 2)
    soft = mass * GRAVITY * count / length * random.uniform(5, 50)
    nodes = {"top": {"position": [0, 0], "fixed": "both"}}
    members = {}
    before, lean = "top", random.uniform(-0.5, 0.5)
    x = y = 0.0
    for i in range(count):
        angle = lean + random.uniform(-0.3, 0.3)
        x, y = x + length * math.sin(angle), y - length * math.cos(angle)
        nodes[f"n{i}"] = {"position": [x, y], "mass": mass * random.uniform(0.5, 2)}
        stiff = soft * (ratio if ratio and (i + 1) % 2 else 1)
        members[f"m{i}"] = {"kind": "bar" if stiff > soft else "spring", "nodes": [before, f"n{i}"],
                            "stiffness": stiff * random.uniform(0.7, 1.4),
                            "damping": random.choice([0, 0.02, 0.2]) * math.sqrt(soft * mass)}
        before = f"n{i}"
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY]}
    return timed(scene, random.uniform(0.5, 2) * 2 * math.pi * math.sqrt(length / GRAVITY), before, part(random))


def net(random):
    """Prestressed, between fixed edges, struck once."""
    size, pitch = random.randint(2, 4), random.uniform(0.1, 0.5)
    mass, pull = random.uniform(0.05, 0.5), random.uniform(5, 50)
    nodes, members = {}, {}
    for i in range(size + 2):
        for j in range(size + 2):
            edge = [i in (0, size + 1), j in (0, size + 1)]
            if all(edge):
                continue
            at = {"position": [i * pitch, j * pitch]}
            nodes[f"n{i}{j}"] = {**at, "fixed": "both"} if any(edge) else {**at, "mass": mass}
    for i in range(size + 2):
        for j in range(size + 2):
            for di, dj in ((1, 0), (0, 1)):
                a, b = f"n{i}{j}", f"n{i + di}{j + dj}"
                if a in nodes and b in nodes and not ("fixed" in nodes[a] and "fixed" in nodes[b]):
                    members[f"c{a}{b}"] = {
                        "kind": "cable", "nodes": [a, b], "pretension": pull,
                        "stiffness": pull / pitch * random.uniform(20, 60),
                        "damping": random.uniform(0, 0.05) * math.sqrt(pull / pitch * mass)}
    slow = math.sqrt(pull / pitch / mass)
    scene = {"strut": 1, "nodes": nodes, "members": members,
             "loads": {"blow": {"node": "n11", "force": [random.uniform(0.1, 0.5) * pull,
                                                         random.uniform(-0.5, 0.5) * pull],
                                "signal": {"half_sine": {"amplitude": 1, "frequency": slow}}}}}
    return timed(scene, random.uniform(1, 4) * 2 * math.pi / slow, random.choice(["n11", "n12"]), part(random))


def tumbling(random, ratio=1.0):
    count, radius, mass = random.randint(3, 5), random.uniform(0.05, 0.5), random.uniform(0.05, 0.5)
    soft = mass * random.uniform(100, 2000)
    nodes, members = frame(random, count, radius, soft, 0.0, mass, 0.0)
    for m in list(members.values())[::2]:
        m["stiffness"] *= ratio
    swing = math.sqrt(soft / mass)
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY],
             "initial": {"velocities": thrown(random, nodes, swing * radius, 0.5 * swing)}}
    return timed(scene, random.uniform(2, 6) * 2 * math.pi / swing, random.choice([None, "n0"]), part(random))


def shaken(random, ratio=1.0):
    """A free row of springs, one of them driven, damped: its rest lengths swing."""
    count, mass, frequency = random.randint(2, 4), random.uniform(0.1, 1), random.uniform(1, 20)
    stiffness = mass * (2 * math.pi * frequency) ** 2 * random.uniform(0.3, 8)
    nodes = {"wall": {"position": [0, 0], "fixed": "both"}}
    members, before = {}, "wall"
    for i in range(count):
        nodes[f"n{i}"] = {"position": [0.1 * (i + 1), 0.02 * (i % 2)], "mass": mass}
        members[f"m{i}"] = {"kind": "spring", "nodes": [before, f"n{i}"],
                            "stiffness": stiffness * (ratio if i % 2 else 1),
                            "damping": random.uniform(0.05, 0.3) * math.sqrt(stiffness * mass)}
        members[f"g{i}"] = {"kind": "spring", "nodes": ["wall", f"n{i}"],
                            "stiffness": stiffness * random.uniform(0.2, 0.5),
                            "damping": 0.1 * math.sqrt(stiffness * mass)}
        before = f"n{i}"
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY],
             "actuators": {"drive": {"member": "m0", "signal": {"sine": {
                 "amplitude": random.uniform(0.001, 0.01), "frequency": frequency}}}}}
    return periodic(scene, frequency, random.randint(8, 40), random.choice([1, 2, 5]), "drive",
                    random.choice(["n0", before]))


def ground(random, weight, depth):
    stiffness = weight / depth
    mass = weight / GRAVITY
    return {"stiffness": stiffness,
            "damping": random.choice([0, 1, 1, 1]) * random.uniform(0.05, 0.8) * 2 * math.sqrt(stiffness * mass)}


def dropped(random, friction=False):
    count, radius, mass = random.randint(3, 5), random.uniform(0.05, 0.3), random.uniform(0.05, 0.5)
    weight = mass * count * GRAVITY
    soft = weight / radius * random.uniform(30, 300)
    height = random.uniform(0.01, 0.3)
    nodes, members = frame(random, count, radius, soft,
                           random.uniform(0.02, 0.2) * math.sqrt(soft * mass), mass, height)
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY],
             "ground": ground(random, weight, radius * random.uniform(0.001, 0.02)),
             "initial": {"velocities": thrown(random, nodes, 0.5, 3)}}
    if friction:
        scene["ground"]["friction"] = law(random, 1e-3)
    fall = math.sqrt(2 * height / GRAVITY) + 0.1
    return timed(scene, random.uniform(1.5, 3) * fall, random.choice([None, "n0"]), part(random))


def ball(random):
    """A ball thrown onto a slope without friction."""
    mass, height = random.uniform(0.05, 2), random.uniform(0.02, 0.5)
    g = ground(random, mass * GRAVITY, height * random.uniform(1e-4, 1e-2))
    g["slope"] = random.uniform(-0.4, 0.4)
    scene = {"strut": 1, "nodes": {"ball": {"position": [0, height], "mass": mass}},
             "gravity": [0, -GRAVITY], "ground": g,
             "initial": {"velocities": {"ball": [random.uniform(-1, 1), random.uniform(-1, 1)]}}}
    return timed(scene, random.uniform(1.5, 5) * math.sqrt(2 * height / GRAVITY), None, part(random))


def tethered(random):
    """A mass on a spring that swings into the ground."""
    length, mass = random.uniform(0.2, 1), random.uniform(0.1, 1)
    k = mass * GRAVITY / length * random.uniform(5, 40)
    lean = random.uniform(0.3, 1.2)
    scene = {"strut": 1,
             "nodes": {"pin": {"position": [0, length * random.uniform(0.7, 1.05)], "fixed": "both"},
                       "bob": {"mass": mass}},
             "members": {"rope": {"kind": random.choice(["cable", "spring"]), "nodes": ["pin", "bob"],
                                  "stiffness": k, "rest_length": length,
                                  "damping": random.uniform(0, 0.1) * math.sqrt(k * mass)}},
             "gravity": [0, -GRAVITY],
             "ground": {**ground(random, mass * GRAVITY, length * random.uniform(3e-4, 1e-2)), "nodes": ["bob"]}}
    pin = scene["nodes"]["pin"]["position"]
    scene["nodes"]["bob"]["position"] = [length * math.sin(lean), max(0.05 * length, pin[1] - length * math.cos(lean))]
    return timed(scene, random.uniform(0.5, 2) * 2 * math.pi * math.sqrt(length / GRAVITY), "bob", part(random))


def hopper(random):
    """A frame that an actuator lets hop or dance, without friction, on a slope or not."""
    count, radius, mass = random.randint(3, 4), random.uniform(0.05, 0.2), random.uniform(0.05, 0.2)
    frequency, weight = random.uniform(3, 15), mass * count * GRAVITY
    soft = weight / radius * random.uniform(50, 300)
    nodes, members = frame(random, count, radius, soft, random.uniform(0.1, 0.3) * math.sqrt(soft * mass), mass, 0.001)
    g = ground(random, weight, radius * random.uniform(0.002, 0.02))
    g["slope"] = random.choice([0, random.uniform(-0.05, 0.05)])
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY], "ground": g,
             "actuators": {"drive": {"member": random.choice(list(members)), "signal": {"sine": {
                 "amplitude": radius * random.uniform(0.005, 0.05), "frequency": frequency}}}}}
    return periodic(scene, frequency, random.randint(4, 12), random.choice([1, 2]), "drive",
                    random.choice([None, "n0"]))


def law(random, band):
    mu = random.uniform(0.05, 0.6)
    over = random.choice([1, 1, random.uniform(1, 1.6)])
    kind = random.choice(["karnopp", "karnopp", "coulomb"])
    friction = {"law": kind, "mu_static": mu * over, "mu_kinetic": mu}
    if kind == "karnopp":
        friction["stick_velocity"] = band
    return friction


def belt(random):
    mass, stiffness, speed = random.uniform(0.2, 5), random.uniform(20, 500), random.uniform(0.02, 0.3)
    normal, deep = mass * GRAVITY, 1e-4
    friction = law(random, speed * 1e-3)
    scene = {"strut": 1,
             "nodes": {"wall": {"position": [-0.5, -deep], "fixed": "both"},
                       "block": {"position": [0, -deep], "mass": mass}},
             "members": {"spring": {"kind": "spring", "nodes": ["wall", "block"],
                                    "stiffness": stiffness, "rest_length": 0.5,
                                    "damping": random.choice([0, 0.02]) * math.sqrt(stiffness * mass)}},
             "gravity": [0, -GRAVITY],
             "ground": {"stiffness": normal / deep, "damping": 0.3 * math.sqrt(normal / deep * mass),
                        "belt_speed": speed, "nodes": ["block"], "friction": friction},
             "initial": {"velocities": {"block": [random.choice([0, speed]), 0]}}}
    return timed(scene, random.uniform(2, 6) * 2 * math.pi * math.sqrt(mass / stiffness), "block", part(random))


def block(random):
    """A sliding block that a load of two harmonics drives, with a spring to a wall or free."""
    mass, frequency = random.uniform(0.2, 5), random.uniform(1, 20)
    normal, deep = mass * GRAVITY, 1e-4
    force = normal * random.uniform(0.3, 1.5)
    scene = {"strut": 1, "nodes": {"block": {"position": [0, -deep], "mass": mass}},
             "gravity": [0, -GRAVITY],
             "ground": {"stiffness": normal / deep, "damping": 0.3 * math.sqrt(normal / deep * mass),
                        "friction": law(random, 1e-4), "nodes": ["block"]},
             "loads": {"drive": {"node": "block", "force": [force, 0], "signal": {"sum": [
                 {"sine": {"amplitude": 1, "frequency": frequency}},
                 {"sine": {"amplitude": random.uniform(0.3, 1), "frequency": 2 * frequency,
                           "phase": random.uniform(0, 6.28)}}]}}}}
    if random.random() < 0.4:
        k = mass * (2 * math.pi * frequency) ** 2 * random.uniform(0.1, 2)
        scene["nodes"]["wall"] = {"position": [-0.5, -deep], "fixed": "both"}
        scene["members"] = {"spring": {"kind": "spring", "nodes": ["wall", "block"], "stiffness": k}}
    return periodic(scene, frequency, random.randint(8, 40), random.choice([1, 4]), "drive", "block")


def crawler(random):
    """A frame of random shape with one driven member on rough ground."""
    count, radius, mass = random.randint(3, 5), random.uniform(0.03, 0.2), random.uniform(0.02, 0.2)
    frequency, weight = random.uniform(4, 20), mass * count * GRAVITY
    soft = weight / radius * random.uniform(100, 1000)
    nodes, members = frame(random, count, radius, soft, random.uniform(0.05, 0.2) * math.sqrt(soft * mass), mass, 0.0)
    scene = {"strut": 1, "nodes": nodes, "members": members, "gravity": [0, -GRAVITY],
             "ground": {**ground(random, weight, radius * random.uniform(0.001, 0.01)), "friction": law(random, 1e-4)},
             "actuators": {"drive": {"member": random.choice(list(members)), "signal": {"sine": {
                 "amplitude": radius * random.uniform(0.002, 0.03), "frequency": frequency}}}}}
    scene["ground"]["damping"] = max(scene["ground"]["damping"], 0.2 * math.sqrt(scene["ground"]["stiffness"] * mass))
    return periodic(scene, frequency, random.choice([30, 60, 120]), 5, "drive")


def two_masses(random):
    """Two masses on rough ground and a driven spring between them, two harmonics."""
    frequency, first = random.uniform(3, 15), random.uniform(0.5e-3, 3e-3)
    heavy, light, deep = random.uniform(0.5, 3), random.uniform(0.2, 1), 1e-3
    friction = law(random, 1e-5)
    friction["mu_static"] = friction["mu_kinetic"] = random.uniform(0.03, 0.3)
    k = light * (2 * math.pi * frequency) ** 2 * random.uniform(20, 200)
    scene = {"strut": 1,
             "nodes": {"left": {"position": [0, -deep], "mass": heavy},
                       "right": {"position": [0.1, -deep], "mass": light}},
             "members": {"link": {"kind": "bar", "nodes": ["left", "right"], "stiffness": k,
                                  "damping": 0.1 * math.sqrt(k * light)}},
             "gravity": [0, -GRAVITY],
             "ground": {"stiffness": heavy * GRAVITY / deep, "friction": friction,
                        "contacts": {"right": {"stiffness": light * GRAVITY / deep}}},
             "actuators": {"drive": {"member": "link", "signal": {"sum": [
                 {"sine": {"amplitude": first, "frequency": frequency}},
                 {"sine": {"amplitude": first * random.uniform(0.3, 0.7), "frequency": 2 * frequency}}]}}}}
    return periodic(scene, frequency, random.choice([30, 60]), 10, "drive")


def stiffness_ratio(random):
    return 10 ** random.uniform(3, 6)


def wide(random):
    scene, unit = wide_scenes.make(random)
    return scene, unit / 1000


def robot(random):
    scene, unit = wide_scenes.make_robot(random)
    return scene, unit / 1000


CLASSES = {
    "smooth": [chain, net, tumbling, shaken],
    "contact": [dropped, ball, tethered, hopper],
    "friction": [belt, block, crawler, two_masses, lambda r: dropped(r, True)],
    "stiff": [lambda r: chain(r, stiffness_ratio(r)), lambda r: tumbling(r, stiffness_ratio(r)),
              lambda r: shaken(r, stiffness_ratio(r))],
    "wide": [wide],
    "robots": [robot],
}


def make(kind, random):
    return random.choice(CLASSES[kind])(random)
