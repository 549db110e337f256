function r = strut_path (s, varargin)
  % R = strut_path (S, OPTION, VALUE, ...)
  %
  % Follows an equilibrium while a load or a parameter grows.
  %
  % Options are those of the program's "strut path" without the dashes. R is what "strut path --json"
  % prints, lists as column vectors or struct arrays.
  r = strut_mex ("path", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
