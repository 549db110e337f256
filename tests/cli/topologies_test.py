# SPDX-License-Identifier: GPL-3.0-or-later
"""models/topologies: comparable, as fast as their heads say, and by another method too."""
import glob
import os
import re

from testing import answer, check, finish, models as folder

files = sorted(path for path in glob.glob(f"{folder}/topologies/*.yaml")
               if not re.search(r"^study:", open(path, encoding="utf-8").read(), re.M))
models = answer("compare", *files, "--no-states")["models"]
ours = 0
for path, model in zip(files, models):
    v, text = model["values"], open(path, encoding="utf-8").read()
    for key, wanted in (("mass", 0.14), ("friction", 0.1), ("drive_frequency", 10), ("drive_amplitude", 1e-4)):
        check(abs(v[key] - wanted) < 1e-9, f"{path}: {key} is {v[key]}: it cannot be compared with the others")
    found = 1e-3 * float(re.search(r"^# Found: ([-+\d.]+) mm/s", text, re.M).group(1))
    check(abs(v["velocity"] - found) <= 0.01 * abs(found) + 1e-5, f"{path}: {v['velocity']} m/s, its head says {found}")
    check(model["motion"] == "periodic", f"{path}: its motion is {model['motion']}")
    if "nine-member.yaml" not in path and found > 5e-3:
        ours += 1
        # The classical method with small steps, which shares only the forces with what was used.
        by_rk4 = answer("run", path, "--integrator", "rk4", "--step", "20 us", "--quiet")["velocity"]
        check(abs(by_rk4 - v["velocity"]) <= 0.02 * found, f"{path}: {by_rk4} m/s by rk4, not {v['velocity']}")
check(len(files) >= 4 and ours >= 2, f"{len(files)} topologies, {ours} of them ours that crawl")

# The symmetric one cannot know a direction, and says nothing of a cost of transport.
gull = models[[os.path.basename(f) for f in files].index("gull.yaml")]
cost = gull["values"]["cost_of_transport"]
check(cost is None, f"the gull has a cost of transport: {cost}")

finish()
