function m = strut_matrices (s, varargin)
  % M = strut_matrices (S, OPTION, VALUE, ...)
  %
  % Sparse matrices of the structure in the shape that the option "at" names (as drawn without it):
  % M.mass, M.connectivity (nodes x members, -1 and 1), M.equilibrium (free coordinates x members),
  % M.stiffness_elastic, M.stiffness_geometric, M.damping and, where nodes touch the ground,
  % M.stiffness_contact.
  m = strut_mex ("matrices", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
