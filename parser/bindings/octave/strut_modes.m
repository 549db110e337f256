function r = strut_modes (s, varargin)
  % R = strut_modes (S, OPTION, VALUE, ...)
  %
  % Natural frequencies and their shapes.
  %
  %   m = strut_modes (s, "at", "II");
  %   [m.modes.frequency]
  %
  % Options are those of the program's "strut modes" without the dashes. R is what "strut modes --json"
  % prints, lists as column vectors or struct arrays.
  r = strut_mex ("modes", s.handle, varargin{:});
end

% SPDX-License-Identifier: GPL-3.0-or-later
