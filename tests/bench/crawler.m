% SPDX-License-Identifier: GPL-3.0-or-later
% The paper's crawler as a vectorised script: arrays over members and nodes, the incidence matrix for
% differences and sums, RK4. crawler.m STEPS prints nanoseconds per step and node 1 after so many.
1;

function a = acceleration(p, t, q, v)
  d = p.B * q;                                % members x 2
  u = p.B * v;
  l = sqrt(sum(d .^ 2, 2));
  w = 2 * pi * p.f;
  rest = p.rest + p.drive * (p.a * sin(w * t));
  rate = sum(d .* u, 2) ./ l - p.drive * (p.a * w * cos(w * t));
  F = p.weight - p.Bt * ((p.c .* (l - rest) + p.k .* rate) ./ l .* d);
  y = q(:, 2);
  vx = v(:, 1);
  vy = v(:, 2);
  N = (y < 0) .* (-1e5 * y - 100 * min(vy, 0));
  R = F(:, 1);
  slip = abs(vx) >= 1e-4;
  F(:, 1) -= slip .* (p.mu * N .* sign(vx)) + ~slip .* (sign(R) .* min(abs(R), p.mu * N));
  F(:, 2) += N;
  a = p.W * F;
endfunction

function [q, v] = advance(p, q, v, n, steps, h)
  for i = n:n + steps - 1
    a1 = acceleration(p, i * h, q, v);
    v2 = v + h / 2 * a1;
    a2 = acceleration(p, (i + 0.5) * h, q + h / 2 * v, v2);
    v3 = v + h / 2 * a2;
    a3 = acceleration(p, (i + 0.5) * h, q + h / 2 * v2, v3);
    v4 = v + h * a3;
    a4 = acceleration(p, (i + 1) * h, q + h * v3, v4);
    q += h / 6 * (v + 2 * (v2 + v3) + v4);
    v += h / 6 * (a1 + 2 * (a2 + a3) + a4);
  endfor
endfunction

% Table 1: i1, i2, rest length, c, k, m
T = [1 2 0.10 1e6 0.2 0.1;  3 5 0.02 1e6 0.2 0.02; 4 5 0.02 1e6 0.2 0.02
     1 3 0.02 3e3 0.2 0;    2 3 0.02 3e3 0.2 0;    2 4 0.02 3e3 0.2 0
     1 4 0.02 3e3 0.2 0;    1 5 0.01 1e4 0.2 0;    2 5 0.01 1e4 0.2 0];
B = zeros(9, 5);
B(sub2ind(size(B), (1:9)', T(:, 1))) = -1;
B(sub2ind(size(B), (1:9)', T(:, 2))) = 1;
m = T(:, 6);
M = abs(B)' * diag(m / 6) * abs(B);
M += diag(diag(M));
weight = [zeros(5, 1), -9.81 / 2 * (abs(B)' * m)];
p = struct("B", B, "Bt", B', "rest", T(:, 3), "c", T(:, 4), "k", T(:, 5), "W", inv(M), ...
           "weight", weight, "drive", double((1:9)' == 8), "mu", 0.1, "f", 10, "a", 1e-4);
q = [0 0; 96.5109 23.8714; 52.6668 28.3691; 60.2933 0; 43.4758 10.6875] * 1e-3;
v = zeros(5, 2);
h = 1e-4;
steps = 2000;
words = argv();
if numel(words) > 0
  steps = str2double(words{1});
endif
warm = min(200, floor(steps / 2));
[q, v] = advance(p, q, v, 0, warm, h);
start = tic();
[q, v] = advance(p, q, v, warm, steps - warm, h);
printf("%.17g ns per step, node 1 at %.17g\n", 1e9 * toc(start) / (steps - warm), q(1, 1));
