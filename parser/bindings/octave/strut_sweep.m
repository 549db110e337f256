function t = strut_sweep (s, varargin)
  % T = strut_sweep (S, NAME, VALUES, ..., OPTION, VALUE, ...)
  % T = strut_sweep (S, POINTS, NAMES, OPTION, VALUE, ...)
  %
  % Computes many points. In the first form every combination of the VALUES of parameters, the last one
  % changing fastest: vectors in SI units, or cell arrays of texts. In the second, each row of POINTS is one point,
  % and NAMES (a cell array) says what the columns are.
  %
  %   t = strut_sweep (s, "frequency", linspace (8, 12, 81), "keep", {"velocity", "outcome"});
  %   plot (t.frequency, t.velocity);
  %
  % Options: "keep", a cell array of what to keep of each point, words as in a study; "compute" ("run",
  % "equilibria", "modes", "rigidity", "path" or "form"), "threads", "batch", "limit_time",
  % "limit_evaluations", "at", "lowest". T has a column for each axis and for what is kept, numbers as
  % vectors, words as cell arrays; T.status is 0 for points that could be computed.
  axes = {};
  lists = {};
  keep = {};
  options = {};
  points = [];
  words = {};
  if ~isempty (varargin) && isnumeric (varargin{1})
    if numel (varargin) < 2
      error ("strut:usage", "expected the names of the columns behind the points");
    end
    points = double (varargin{1});
    axes = cellstr (varargin{2});
    varargin(1:2) = [];
  end
  if mod (numel (varargin), 2)
    error ("strut:usage", "expected pairs of a name and values");
  end
  whole = ~isempty (axes);
  for k = 1:2:numel (varargin)
    name = varargin{k};
    value = varargin{k + 1};
    if strcmp (name, "keep")
      keep = cellstr (value);
    elseif any (strcmp (name, {"compute", "threads", "batch", "limit_time", "limit_evaluations", "at", "lowest"}))
      options(end + 1:end + 2) = {name, value};
    elseif whole
      error ("strut:usage", "unknown option '%s'", name);
    else
      if ischar (value)
        value = {value};
      end
      axes{end + 1} = name;
      lists{end + 1} = value;
    end
  end
  if ~whole
    [points, words] = combine (lists);
  end
  t = strut_mex ("sweep", s.handle, axes, points, words, keep, options{:});
end

function [points, words] = combine (lists)
  count = prod (cellfun (@numel, lists));
  points = zeros (count, numel (lists));
  words = {};
  fast = 1;
  for a = numel (lists):-1:1
    list = lists{a};
    which = mod (floor ((0:count - 1)' / fast), numel (list)) + 1;
    if iscell (list)
      if isempty (words)
        words = cell (count, numel (lists));
      end
      words(:, a) = list(which);
    else
      points(:, a) = double (list(which));
    end
    fast = fast * numel (list);
  end
end

% SPDX-License-Identifier: GPL-3.0-or-later
