function r = strut_form (s, varargin)
  % R = strut_form (S, OPTION, VALUE, ...)
  %
  % Finds a shape that is in equilibrium.
  %
  % Options are those of the program's "strut form" without the dashes. R is what "strut form --json"
  % prints, lists as column vectors or struct arrays.
  r = strut_mex ("form", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
