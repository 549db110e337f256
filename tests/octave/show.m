% SPDX-License-Identifier: GPL-3.0-or-later
% Prints every number of some calls as "NAME HEX", by which octave_test.py compares bits.
function show (command, file, varargin)
  s = strut_load (file);
  switch (command)
    case "run"
      r = strut_run (s, varargin{:});
      print_value ("json", r.summary);
      print_value ("time", r.time);
      for name = {"x", "y", "vx", "vy", "length", "force"}
        if (isfield (r, name{1}))
          print_value (name{1}, r.(name{1}));
        end
      end
    otherwise
      r = feval (["strut_" command], s, varargin{:});
      for name = {"names", "equilibrium_matrix", "connectivity_matrix"}
        if (isfield (r, name{1}))
          r = rmfield (r, name{1});
        end
      end
      print_value ("json", r);
  end
end

function print_value (name, value)
  if (isstruct (value))
    fields = fieldnames (value);
    for k = 1:numel (value)
      for f = 1:numel (fields)
        index = "";
        if (numel (value) > 1 || (size (value, 2) == 1 && size (value, 1) ~= 1))
          index = sprintf (".%d", k - 1);
        end
        print_value ([name index "." fields{f}], value(k).(fields{f}));
      end
    end
  elseif (iscell (value))
    for k = 1:numel (value)
      print_value (sprintf ("%s.%d", name, k - 1), value{k});
    end
  elseif (ischar (value))
    printf ("%s '%s'\n", name, value);
  elseif (islogical (value))
    printf ("%s %d\n", name, value);
  elseif (isempty (value))
    printf ("%s null\n", name);
  else
    hex = num2hex (value(:));
    for k = 1:rows (hex)
      printf ("%s[%d] %s\n", name, k - 1, hex(k, :));
    end
  end
end
