# SPDX-License-Identifier: GPL-3.0-or-later
"""models/topologies/clipper.yaml is faster and cheaper than the paper's crawler on three grounds."""
from testing import check, copy_models, finish, sweep

STUDY = """model: copied/topologies/{model}
set: {{frequency: {frequency} Hz}}
axes: [{{friction: [0.1, 0.2, 0.5]}}]
solver: {{accuracy: 1 %}}
keep: [velocity, expected_error, cost_of_transport, total_mass]
"""
copy_models()


def table(model, frequency):
    """Of a model on three grounds."""
    found = sweep(f"{model}-{frequency}", STUDY.format(model=model, frequency=frequency))
    return [{key.split(" [")[0]: value for key, value in row.items()} for row in found]


ours = table("clipper.yaml", 10)
speeds = [float(row["velocity"]) for row in ours]
check(len(ours) == 3 and (min(speeds) > 0 or max(speeds) < 0), f"one direction: {speeds}")
# The folder's frequency, and those at which the paper's is fastest or cheapest on these grounds.
for frequency in (10, 8.7, 8.9, 11.2):
    for row, rival in zip(ours, table("nine-member.yaml", frequency)):
        friction = row["friction"]
        check(abs(float(row["total_mass"]) - float(rival["total_mass"])) < 1e-9, "masses differ")
        check(float(row["expected_error"]) <= 0.01, f"{friction}: {row['expected_error']}")
        check(abs(float(row["velocity"])) > 1.05 * abs(float(rival["velocity"])),
              f"friction {friction}: {row['velocity']}, "
              f"the paper's {rival['velocity']} at {frequency} Hz")
        if not rival["cost_of_transport"] or abs(float(rival["velocity"])) < 1e-3:
            continue  # it fell, and stays where it is
        check(float(row["cost_of_transport"]) < 0.95 * float(rival["cost_of_transport"]),
              f"friction {friction}: {row['cost_of_transport']}, "
              f"the paper's {rival['cost_of_transport']} at {frequency} Hz")
finish()
