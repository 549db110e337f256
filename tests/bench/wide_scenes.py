# SPDX-License-Identifier: GPL-3.0-or-later
"""Random scenes of every kind that the language has, for testing what `--accuracy` promises.

make(random) returns (scene, unit): the scene as a mapping that JSON writes, and a time [s] that
divides the run and its window: the drive's period, or a two-hundredth of the run; make_robot(random) one that also has
sensors. Structures have 2 to
8 nodes joined by springs, bars and cables; they stand on, fall on or hang above level, sloping and moving
ground with each law of friction and of contact damping, and are driven by up to three actuators and a load.
"""
import math

GRAVITY = 9.81


def place_nodes(random, count, pitch):
    """Positions of a strip of triangles on the ground, jittered."""
    at = []
    for i in range(count):
        x = 0.5 * pitch * i + random.uniform(-0.1, 0.1) * pitch
        y = (i % 2) * pitch * random.uniform(0.6, 1.0)
        at.append([round(x, 4), round(y, 4)])
    at[0][1] = 0.0
    if count == 2:
        at[1] = [round(pitch * random.uniform(0.7, 1.3), 4), 0.0]
    return at


def make_members(random, count, weight, pitch):
    """Neighbours in the strip joined, so that nothing is loose; some members cables or heavy."""
    members, soft = {}, weight / pitch
    for i in range(count):
        for j in (i + 1, i + 2):
            if j >= count:
                continue
            kind = random.choice(["spring", "spring", "bar", "cable"])
            if j == i + 1 and kind == "cable" and count == 2:
                kind = "spring"
            stiffness = soft * (random.uniform(10, 120) if kind != "bar" else random.uniform(100, 800))
            m = {"kind": kind, "nodes": [f"n{i}", f"n{j}"], "stiffness": round(stiffness, 1),
                 "damping": round(random.uniform(0.05, 0.3) * math.sqrt(stiffness * weight / GRAVITY / count), 3)}
            if kind == "cable":
                m["rest_length_ratio"] = round(random.uniform(0.9, 1.05), 3)
            if random.random() < 0.3:
                m["mass"] = 0.05
            members[f"m{i}{j}"] = m
    return members


def friction_law(random):
    law = random.choice(["coulomb", "coulomb", "karnopp", "karnopp", "smooth", "none"])
    if law == "none":
        return None
    mu = round(random.uniform(0.05, 0.8), 2)
    f = {"law": law}
    if law == "smooth":
        f.update(mu=mu, width=random.choice([1e-3, 5e-3, 2e-2]))
        return f
    if random.random() < 0.45:
        f.update(mu_kinetic=mu, mu_static=round(mu * random.uniform(1.05, 1.5), 3))
    else:
        f["mu"] = mu
    if law == "karnopp":
        f["stick_velocity"] = random.choice([1e-4, 5e-4, 2e-3])
    return f


def make_ground(random, weight):
    stiffness = weight / random.uniform(2e-4, 8e-3)
    ground = {"stiffness": round(stiffness, 1)}
    if random.random() < 0.3:
        ground.update(damping_law="hunt_crossley", dissipation=round(random.uniform(0.2, 3), 3))
    else:
        ground["damping"] = round(random.uniform(0, 0.8) * math.sqrt(stiffness * weight / GRAVITY), 3)
    friction = friction_law(random)
    if friction:
        ground["friction"] = friction
    if random.random() < 0.3:
        ground["slope"] = f"{random.uniform(-6, 6):.2f} deg"
    if random.random() < 0.2:
        ground["belt_speed"] = round(random.uniform(-0.2, 0.2), 3)
    return ground


def make_signal(random, amplitude, frequency):
    kind = random.choice(["sine", "sine", "sine", "half_sine", "square", "sum"])
    if kind == "sum":
        return {"sum": [{"sine": {"amplitude": amplitude, "frequency": frequency}},
                        {"sine": {"amplitude": round(amplitude * random.uniform(0.2, 0.6), 5),
                                  "frequency": 2 * frequency,
                                  "phase": round(random.uniform(0, 6.2), 2)}}]}
    return {kind: {"amplitude": amplitude, "frequency": frequency}}


def make(random):
    count = random.choice([2, 3, 3, 4, 4, 5, 5, 6, 7, 8])
    pitch = random.uniform(0.1, 0.6)
    at = place_nodes(random, count, pitch)
    masses = [round(random.uniform(0.1, 0.9), 3) for _ in at]
    weight = GRAVITY * sum(masses)
    lift = random.choice([0, 0, 0, round(random.uniform(0.01, 0.3) * pitch, 4)])
    nodes = {f"n{i}": {"position": [x, round(y + lift, 4)], "mass": masses[i]} for i, (x, y) in enumerate(at)}
    members = make_members(random, count, weight, pitch)
    scene = {"strut": 1, "gravity": [0, -GRAVITY], "nodes": nodes, "members": members,
             "ground": make_ground(random, weight)}
    frequency = round(random.uniform(1.5, 12), 2)
    driven = random.sample(list(members), min(len(members), random.choice([1, 1, 1, 2, 3])))
    scene["actuators"] = {}
    for k, name in enumerate(driven):
        amplitude = round(pitch * random.uniform(0.01, 0.12), 5)
        times = 1 if k == 0 else random.choice([1, 1, 2])
        scene["actuators"][f"d{k}"] = {"member": name, "signal": make_signal(random, amplitude, times * frequency)}
    if random.random() < 0.2:
        scene["loads"] = {"push": {"node": f"n{count - 1}",
                                   "force": [round(random.uniform(-0.2, 0.2) * weight, 3), 0],
                                   "signal": {"sine": {"amplitude": 1, "frequency": frequency}}}}
    if random.random() < 0.7:
        periods = random.choice([5, 10, 20, 30, 40, 60])
        scene["run"] = {"periods": periods, "of": "d0", "measure": {"last": min(periods, random.choice([2, 5, 10]))}}
        unit = 1 / frequency
    else:
        duration = round(random.uniform(0.5, 4), 3)
        scene["run"] = {"duration": duration}
        if random.random() < 0.5:
            scene["run"]["measure"] = {"last": round(0.5 * duration, 4)}
        unit = duration / 200
    scene["solver"] = {"integrator": "adaptive", "step": unit / 50}
    return scene, unit


def make_reflex(random, members, amplitude, frequency):
    """Sensors and a signal that follows them: a drive that a foot's contact starts, a relay, a controller or feedback."""
    name = random.choice([m for m in members if len(members[m]["nodes"]) == 2])
    sensors = {"l": {"length": name}, "touch": {"contact": "n0"}}
    kind = random.choice(["starts", "starts", "relay", "pid", "feedback", "held"])
    if kind == "starts":
        signal = {"half_sine": {"amplitude": amplitude, "frequency": frequency}, "starts": {"contact": "n0", "each": True}}
        return sensors, {}, signal
    wave = f"{amplitude} m * sin(2*pi*{frequency} Hz*t)"
    if kind == "relay":
        relay = {"kind": "relay", "of": "touch", "on_above": 0.6, "off_below": 0.4, "on_value": amplitude,
                 "off_value": -amplitude, "every": 0.05 / frequency}
        return sensors, {"reflex": relay}, {"expression": "reflex", "lag": 0.2 / frequency}
    if kind == "pid":
        pid = {"sensor": "l", "target": members[name]["rest"], "gain": round(random.uniform(0.1, 0.5), 2),
               "integral": f"{frequency} Hz", "least": -amplitude, "most": amplitude, "every": 0.05 / frequency}
        return sensors, {"hold": pid}, {"expression": "hold"}
    if kind == "held":
        return sensors, {}, {"expression": f"{wave} * touch", "every": 0.02 / frequency}
    return sensors, {}, {"expression": f"{wave} - {random.uniform(0.02, 0.2):.3f} * (l - {members[name]['rest']} m)"}


def make_robot(random):
    """A scene of make() with feet on the ground that also has sensors, a reflex, stops and a running cable."""
    scene, unit = make(random)
    while "d0" not in scene["actuators"] or "periods" not in scene["run"] or len(scene["nodes"]) < 3:
        scene, unit = make(random)
    members, places = scene["members"], {n: v["position"] for n, v in scene["nodes"].items()}
    for m in members.values():
        m["rest"] = round(math.dist(*(places[n] for n in m["nodes"])), 4)
    frequency = random.choice([1.0, 1.0, 2.0]) / unit
    amplitude = round(0.03 * min(m["rest"] for m in members.values()), 5)
    sensors, controllers, signal = make_reflex(random, members, amplitude, round(frequency, 3))
    reflex = random.choice([m for m in members if m != scene["actuators"]["d0"]["member"]])
    scene["sensors"] = sensors
    if controllers:
        scene["controllers"] = controllers
    scene["actuators"] = {"d0": scene["actuators"]["d0"], "reflex": {"member": reflex, "signal": signal}}
    stiffest = max(m["stiffness"] for m in members.values())
    for name in random.sample(list(members), min(2, len(members))):
        if members[name]["kind"] == "spring" and random.random() < 0.7:
            members[name].update(longest=round(1.03 * members[name]["rest"], 4), stop_stiffness=10 * stiffest)
    for m in members.values():
        del m["rest"]
    if random.random() < 0.6:
        members["tendon"] = {"kind": "cable", "nodes": ["n0", "n1", "n2"], "rest_length_ratio": 0.97,
                             "stiffness": round(0.3 * stiffest, 1), "damping": 0.1}
    rests = "friction" in scene["ground"] and not {"slope", "belt_speed"} & set(scene["ground"])
    if rests and random.random() < 0.6:
        scene["initial"] = {"settle": True}
    return scene, unit
