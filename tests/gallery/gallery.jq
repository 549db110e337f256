# SPDX-License-Identifier: GPL-3.0-or-later
# What filters of tests/gallery/*.answers may use besides jq's own. See gallery_test.py.

# Are two values the same, numbers within the tolerance? Lists and mappings entry by entry.
def agrees($got; $want; $tolerance):
  if ($got | type) != ($want | type) then false
  elif ($got | type) == "number" then (($got - $want) | fabs) <= $tolerance
  elif ($got | type) == "array" then
    ($got | length) == ($want | length) and
    all(range($got | length); agrees($got[.]; $want[.]; $tolerance))
  elif ($got | type) == "object" then
    ($got | keys) == ($want | keys) and
    all($want | keys[]; . as $key | agrees($got[$key]; $want[$key]; $tolerance))
  else $got == $want end;

# Of strut equilibria.
def labelled($what): [.equilibria[] | select(.label == $what)];
def named($name): .equilibria[] | select(.name == $name);
# How many of a label, and their energies in order.
def stable: labelled("stable") | length;
def saddles: labelled("saddle") | length;
def energies($what): labelled($what) | map(.energy) | sort;
# The equilibrium whose energy is nearest.
def at_energy($energy): .equilibria | min_by((.energy - $energy) | fabs);
# The equilibrium of a label whose node is nearest to a place.
def near($what; $node; $x; $y):
  labelled($what) | min_by((.nodes[$node][0] - $x) * (.nodes[$node][0] - $x) +
                            (.nodes[$node][1] - $y) * (.nodes[$node][1] - $y));
def stands($node; $x; $y): near("stable"; $node; $x; $y);
def tips($node; $x; $y): near("saddle"; $node; $x; $y);
def standing: labelled("stable")[0];

# Of strut run: where nodes are at the end. Of strut path: how far one has gone along x (0) or y (1).
def places: .nodes | map_values(.position);
def moved($node; $axis): .points | .[-1].nodes[$node][$axis] - .[0].nodes[$node][$axis];

# Of a mapping from nodes to places: how far apart two are.
def distance($a; $b):
  (.[$a][0] - .[$b][0]) as $x | (.[$a][1] - .[$b][1]) as $y | ($x * $x + $y * $y | sqrt);

# Of strut rigidity: rank, s and f. A state of self-stress as multiples of one member's force.
def counts: [.rank, .self_stress.count, .mechanisms.count];
def stress($unit): .self_stress.states[0].forces | .[$unit] as $one | map_values(. / $one);
def densities($unit): .self_stress.states[0].force_densities | .[$unit] as $one
  | map_values(. / $one);

# Of strut modes: angular frequencies [rad/s] and frequencies [Hz], in order; n of them.
def omegas: [.modes[].angular_frequency];
def hertz: [.modes[].frequency];

# Of strut path: the first event of a kind; the place of a node on the path at a factor that it has.
def event($kind): [.events[] | select(.kind == $kind)][0];
def at_factor($factor): [.points[] | select(((.factor - $factor) | fabs) < 1e-12)][0];
def final: .points[-1];

# For expected numbers: root(2) instead of (2 | sqrt), since | divides the fields of a line.
def root(f): f | sqrt;
def squared(f): f | . * .;
# Sine and cosine of degrees.
def sine(f): f * (1 | atan) / 45 | sin;
def cosine(f): f * (1 | atan) / 45 | cos;

# Of a mapping from nodes to places: the angle [deg] of the line from a to b; of the middle of two
# seen from the origin; and, from the downward direction [rad], of two rods that hang on each other.
def degrees: . * 45 / (1 | atan);
def turn($a; $b):
  (.[$b][0] - .[$a][0]) as $x | (.[$b][1] - .[$a][1]) as $y | atan2($y; $x) | degrees;
def toward($a; $b): atan2(.[$a][1] + .[$b][1]; .[$a][0] + .[$b][0]) | degrees;
def swing($pin; $middle; $tip):
  [atan2(.[$middle][0] - .[$pin][0]; .[$pin][1] - .[$middle][1]),
   atan2(.[$tip][0] - .[$middle][0]; .[$middle][1] - .[$tip][1])];
# How far a place is from (0, 0).
def distance_from_origin: .[0] * .[0] + .[1] * .[1] | sqrt;
