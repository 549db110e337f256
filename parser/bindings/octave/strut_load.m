function s = strut_load (file, varargin)
  % S = strut_load (FILE, NAME, VALUE, ...)
  %
  % Opens a model. Pairs of a NAME and a VALUE set its parameters: a number in SI units, or a text with a
  % unit.
  %
  %   s = strut_load ("crawler.yaml", "frequency", "10 Hz");
  %
  % S.parameters has their values, S.names the names of nodes, members and so on, in the order of every
  % matrix; S.position (nodes x 2) [m], S.members (members x 2, numbers of nodes), S.length,
  % S.rest_length [m], S.stiffness [N/m] and S.pretension [N] describe the drawn structure.
  % S is for strut_run, strut_sweep, strut_equilibria, strut_modes, strut_rigidity, strut_form,
  % strut_path and strut_matrices. The scene is released with the last copy of S.
  %
  % Errors have the identifier strut:bad_scene, and every message with its line as text.
  [handle, s] = strut_mex ("load", file, varargin{:});
  s.file = file;
  s.handle = handle;
  s.release = onCleanup (@() strut_mex ("close", handle));
end

% SPDX-License-Identifier: GPL-3.0-or-later
