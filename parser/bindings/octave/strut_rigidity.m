function r = strut_rigidity (s, varargin)
  % R = strut_rigidity (S, OPTION, VALUE, ...)
  %
  % Self-stress states, mechanisms and prestress stability: R is what "strut rigidity --json" prints; and
  % R.equilibrium_matrix, R.connectivity_matrix (sparse), columns and rows in the order of R.names.
  %
  %   r = strut_rigidity (s);
  %   size (null (full (r.equilibrium_matrix)), 2)     % states of self-stress
  %
  % Options are those of the program's "strut rigidity" without the dashes.
  r = strut_mex ("rigidity", s.handle, varargin{:});
  at = {};
  for k = 1:2:numel (varargin)
    if strcmp (varargin{k}, "at")
      at = varargin(k:k + 1);
    end
  end
  m = strut_mex ("matrices", s.handle, at{:});
  r.equilibrium_matrix = m.equilibrium;
  r.connectivity_matrix = m.connectivity;
end

% SPDX-License-Identifier: GPL-3.0-or-later
