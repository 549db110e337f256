# SPDX-License-Identifier: GPL-3.0-or-later
"""strut sweep with variants: their rows are those of studies with the same keys, each by itself."""
import os

from testing import check, finish, rows, run, same_table, work, write

os.chdir(work)


def sweep(name, text, *words, **how):
    """The table, if there is one."""
    write(name + ".yaml", text)
    run("sweep", name + ".yaml", "-o", name, "--quiet", *words, **how)
    return rows(name, "table.csv") if os.path.exists(f"{name}/table.csv") else []


write("block.yaml", """strut: 1
name: Block
parameters: {stiffness: 100 N/m, mass: 1 kg, step: 1 ms, place: "near"}
nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: mass, fixed: y}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: stiffness, damping: 1 N s/m}}
configurations: {near: {}, far: {block: [1.2, 0]}}
initial: {configuration: place}
solver: {step: step}
run: {duration: 0.5 s, measure: {node: block}}
""")
STUDY = """strut: 1
study: one
model: block.yaml
axes: [{mass: [1 kg, 2 kg]}, {stiffness: {from: 100, to: 200, step: 50}}]
solver: {integrator: verlet}
keep: [velocity, distance, steps, step, duration, positions, energy]
"""
KEYS = {"near": "{solver: {step: 2 ms}}",
        "far": "{initial: {configuration: far}, run: {duration: 0.25 s, measure: {last: 0.1 s}}}",
        "rk4": "{solver: {integrator: rk4}, initial: {configuration: far}}"}
variants = STUDY + "variants:\n" + "".join(f"  {name}: {keys}\n" for name, keys in KEYS.items())
table = sweep("all", variants)
check([row["variant"] for row in table] == [name for name in KEYS for _ in range(6)],
      "variants are the slowest axis, in the order of the file")
for name, keys in KEYS.items():
    text = STUDY.replace("solver: {integrator: verlet}\n", "")
    if name == "rk4":
        text += "solver: {integrator: rk4}\n"
    else:
        text += "solver: {integrator: verlet%s}\n" % (", step: 2 ms" if name == "near" else "")
    if name != "near":
        text += "initial: {configuration: far}\n"
    if name == "far":
        text += "run: {duration: 0.25 s, measure: {last: 0.1 s}}\n"
    alone = sweep(name, text)
    of_all = [row for row in table if row["variant"] == name]
    check(len(alone) == len(of_all) == 6, f"{name}: {len(alone)}, {len(of_all)} rows")
    for one, other in zip(alone, of_all):
        wanted = {**other, "point": one["point"]}
        del wanted["variant"]
        check(one == wanted, f"{name}: alone {one}, as a variant {other}")
check(len({row["velocity [m/s]"] for row in table}) == 13, "variants are alike, but for those that begin at rest")

# Their names and their keys decide results, their figures do not.
for old, new in (("  rk4:", "  other:"), ("step: 2 ms", "step: 1 ms")):
    sweep("all", variants.replace(old, new), code=1, err="another study")
figures = """figures: {near: {x: stiffness, y: velocity, series: mass, only: variant=near},
          less: {x: stiffness, y: velocity, series: mass, panels: variant, difference: mass}}
"""
sweep("all", variants + figures)
check(os.path.exists("all/near.svg") and os.path.exists("all/less.svg"), "figures")
for old, new, wanted in (("only: variant=", "only: varian=", "did you mean 'variant'?"),
                         ("only: variant=near", "only: variant", "expects COLUMN=TEXT, not 'variant'"),
                         ("difference: mass", "difference: mas", "did you mean 'mass'?"),
                         ("=near", "=nea", "'nea' is no value of 'variant'")):
    sweep("all", variants + figures.replace(old, new), code=2, err=wanted)
sweep("all", variants, "--set", "variant=near", code=2, err="variant")

same_table("all.yaml", "all", shards=(0, 0, 0, 0))
finish()
