function r = strut_equilibria (s, varargin)
  % R = strut_equilibria (S, OPTION, VALUE, ...)
  %
  % Finds the states in which the structure can rest.
  %
  %   e = strut_equilibria (s);
  %   [e.equilibria.energy]
  %
  % Options are those of the program's "strut equilibria" without the dashes. R is what "strut equilibria --json"
  % prints, lists as column vectors or struct arrays.
  r = strut_mex ("equilibria", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
