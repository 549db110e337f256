% SPDX-License-Identifier: GPL-3.0-or-later
% Reads a Matrix Market file of coordinates; symmetric ones are made whole.
function a = mm(path)
  f = fopen(path);
  banner = fgetl(f);
  line = fgetl(f);
  while line(1) == '%'
    line = fgetl(f);
  end
  s = sscanf(line, '%d');
  t = fscanf(f, '%g', [3, s(3)]);
  fclose(f);
  a = sparse(t(1, :), t(2, :), t(3, :), s(1), s(2));
  if strfind(banner, 'symmetric')
    a = a + tril(a, -1)';
  end
end
