function r = strut_run (s, varargin)
  % R = strut_run (S, OPTION, VALUE, ...)
  %
  % Runs a model that strut_load opened. Options are those of the program's "strut run" without the dashes:
  %
  %   r = strut_run (s, "accuracy", "0.5 %");
  %   plot (r.time, r.nodes.n1.x);
  %
  % R.time (samples x 1) [s]; R.x, R.y, R.vx, R.vy (samples x nodes), R.length, R.force (samples x
  % members), R.normal, R.friction (samples x contacts), as far as the model's output names them, with
  % columns in the order of R.names; and the same by name: R.nodes.n1.x, R.members.m8.force. Dots of
  % names are _ there: cell_3_top. R.summary is what "strut run --json" prints, R.status why a run is not
  % whole: "ok", "diverged", "interrupted". All values are in SI units.
  r = strut_mex ("run", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
