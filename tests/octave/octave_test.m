% SPDX-License-Identifier: GPL-3.0-or-later
% Calls of strut in Octave: what comes back, errors, sweeps, matrices. octave_test.py compares the bits.
1;

function expect (condition, what)
  if (! condition)
    error ("failed: %s", what);
  end
end

function expect_error (call, identifier, text)
  try
    call ();
  catch e
    expect (strcmp (e.identifier, identifier), ["identifier " e.identifier " of " e.message]);
    expect (! isempty (strfind (e.message, text)), ["message " e.message]);
    return
  end
  error ("failed: no error with '%s'", text);
end

models = getenv ("STRUT_MODELS");
crawler = fullfile (models, "crawler", "crawler.yaml");

% a scene, with settings as texts and as numbers
s = strut_load (crawler, "frequency", "10 Hz", "friction", 0.2);
expect (s.parameters.frequency == 10, "a setting with a unit");
expect (s.parameters.friction == 0.2, "a setting in SI units");
expect (numel (s.names.members) == 9 && rows (s.position) == numel (s.names.nodes), "names");
expect (all (s.members(:) >= 1 & s.members(:) <= rows (s.position)), "nodes of members");

% a run: matrices, and the same by name
r = strut_run (s);
expect (strcmp (r.status, "ok"), "status");
expect (isequal (size (r.x), [numel(r.time), numel(r.names.nodes)]), "shape of x");
node = r.names.nodes{1};
expect (isequal (r.nodes.(node).x, r.x(:, 1)), "a node by name");
expect (isequal (r.members.m8.length, r.length(:, strcmp (r.names.members, "m8"))), "a member");
d = r.x(:, s.members(:, 2)) - r.x(:, s.members(:, 1));
e = r.y(:, s.members(:, 2)) - r.y(:, s.members(:, 1));
expect (max (max (abs (hypot (d, e) - r.length))) < 1e-15, "lengths are those between nodes");

% the states, their vibration, self-stress
e = strut_equilibria (strut_load (crawler));
for name = {"I", "II", "III"}
  expect (sum (strcmp ({e.equilibria.name}, name{1})) == 1, ["state " name{1}]);
end
expect (all ([e.equilibria.energy] > 0), "energies");
m = strut_modes (strut_load (crawler), "at", "II");
expect (all ([m.modes.frequency] >= 0), "modes");

% T-bar of TsgFEM: the matrices from N, C and by strut
t = strut_load (fullfile (models, "gallery", "t-bar.yaml"), "short", 1);
N = t.position';
C = sparse ([1:6, 1:6]', [t.members(:, 1); t.members(:, 2)], [-ones(6, 1); ones(6, 1)], 6, 4);
H = N * C';
L = sqrt (sum (H .^ 2))';
A = kron (C', eye (2)) * blkdiag (num2cell (H, 1){:}) / diag (L); % forces to nodal forces
k = strut_rigidity (t);
expect (issparse (k.equilibrium_matrix), "sparse");
expect (full (max (max (abs (k.connectivity_matrix' - C)))) == 0, "connectivity");
expect (min (norm (full (k.equilibrium_matrix) - A), norm (full (k.equilibrium_matrix) + A)) < 1e-14, "equilibrium");
K = strut_matrices (t);
frequency = sort (sqrt (abs (eig (full (K.stiffness_elastic + K.stiffness_geometric), full (K.mass)))) / (2 * pi));
m = strut_modes (t);
expect (max (abs (frequency(4:8) - sort ([m.modes.frequency]')(end-4:end)) ./ frequency(4:8)) < 1e-9, "frequencies");

% sweeps: products, samples, words
p = strut_sweep (s, "frequency", [8, 10], "friction", [0.1, 0.2, 0.3], "keep", {"velocity", "outcome"});
expect (isequal (p.frequency', [8 8 8 10 10 10]) && isequal (p.friction', [0.1 0.2 0.3 0.1 0.2 0.3]), "product");
q = strut_sweep (s, [p.frequency, p.friction], {"frequency", "friction"}, "keep", {"velocity", "outcome"}, "threads", 2);
expect (isequal (p.velocity, q.velocity) && isequal (p.outcome, q.outcome), "points");
expect (iscellstr (p.outcome) && all (p.status == 0), "words");

% errors: identifiers, places, and a scene that goes on
expect_error (@() strut_load ("nowhere.yaml"), "strut:file_trouble", "nowhere.yaml");
expect_error (@() strut_load (crawler, "frequncy", 3), "strut:bad_scene", "frequency");
expect_error (@() strut_load (crawler, "frequency", "3 kg"), "strut:bad_scene", "kg");
expect_error (@() strut_load (crawler, "frequency"), "strut:usage", "pairs");
expect_error (@() strut_load (crawler, "frequency", {1}), "strut:usage", "frequency");
expect_error (@() strut_run (s, "step", "-1 s"), "strut:usage", "step");
expect_error (@() strut_run (struct ("handle", uint64 (7))), "strut:usage", "no open scene");
expect_error (@() strut_mex ("jump", s.handle), "strut:usage", "jump");
expect_error (@() strut_mex (), "strut:usage", "strut_load");
expect_error (@() strut_sweep (s, [1 2], {"frequency"}), "strut:usage", "columns");

% scenes are released with their last copy
before = s.handle;
u = s;
clear s
expect (strut_run (u).time(end) > 0, "a copy keeps the scene");
clear u
expect_error (@() strut_mex ("run", before), "strut:usage", "no open scene");
for k = 1:200
  strut_load (crawler);
end
disp ("all fine");
