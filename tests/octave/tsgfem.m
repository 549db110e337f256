% SPDX-License-Identifier: GPL-3.0-or-later
% TsgFEM's planar T-bar, two bars of 2 m crossed in four strings, as its script describes it and as
% models/gallery/t-bar.yaml does, with the prestress of its design (`short` = 1).
1;

% as in a script: nodes, indices of bars and strings, lengths, equilibrium matrix
N = [-1 0 1 0; 0 -1 0 1];
ends = [1 3; 2 4; 1 2; 3 4; 2 3; 4 1];
C = sparse([1:6, 1:6]', ends(:), [-ones(6, 1); ones(6, 1)], 6, 4);
H = N * C';
l = sqrt(sum(H.^2))';
blocks = arrayfun(@(k) H(:, k), 1:6, "UniformOutput", false);
A = kron(C', eye(2)) * blkdiag(blocks{:}) * diag(1 ./ l);
self_stress = null(A);

% and here
s = strut_load("models/gallery/t-bar.yaml", "short", 1);
k = strut_rigidity(s);
assert(norm(full(k.equilibrium_matrix) - A) < 1e-14)
assert(k.self_stress.count == size(self_stress, 2))
q = strut_matrices(s);
w = sqrt(eig(full(q.stiffness_elastic + q.stiffness_geometric), full(q.mass)));
f = sort(real(w)) / (2 * pi);
m = strut_modes(s);
assert(max(abs(f(4:8) - sort([m.modes(4:8).frequency]')) ./ f(4:8)) < 1e-9)
[m.modes.frequency]        % 0 0 0 4.4289 4.4289 4.6416 393.33 393.36 Hz, as TsgFEM's tenseg_mode
