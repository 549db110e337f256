% SPDX-License-Identifier: GPL-3.0-or-later
classdef strut
  %STRUT  Planar tensegrity structures and robots from MATLAB and Octave.
  %   model = strut.load('crawler.yaml', 'frequency', '24 Hz', ...)     a model that is valid, with its parameters set
  %   [result, motion] = strut.run(model, 'accuracy', '0.5 %', ...)     motion.time, motion.nodes.n1_x, ...
  %   found = strut.equilibria(model, ...)                              found.equilibria.name, found.barriers.height
  %   found = strut.modes(model, 'at', 'II', ...)                       found.modes.frequency, found.modes.shape.n1
  %   found = strut.path(model, 'over', 'n1.y', 'until', '-1 mm', ...)  found.points.value, found.points.nodes.n2
  %   table = strut.sweep(model, 'friction', [0.1 0.3], 'keep', {'velocity'}, ...)
  %   [table, study] = strut.sweep('study.yaml', ...)                   table.velocity, table.status
  %   [found, residuals] = strut.fit('study.yaml', ...)                 found.parameters.friction.value
  %   [result, tables] = strut.command('rigidity', model, ...)          any command with --json
  %
  %   A model is a file or what strut.load returned. Names are options of the command ('mass_model' is --mass-model);
  %   all others are parameters of the model, as are those in 'set', struct('step', '1 ms'). Numbers are in SI units;
  %   texts may have units. 'output' names a folder that keeps the files of the program.
  %
  %   Results have the fields that the command prints with --json. A list of things is a struct of columns with a row
  %   for each thing; a table is a struct of columns named as in the CSV file, without units. What does not exist is
  %   NaN, '' or [].
  %
  %   In sweeps of a model all names but options of `strut sweep` and the keys keep, compute, check, derive, initial,
  %   limit, lowest, path, run, solver, variants of a study are parameters with a list of values, or a range
  %   struct('from', 1, 'to', 2, 'count', 5). Every combination is a point, the last parameter varying fastest. A
  %   parameter with the name of an option or key goes into 'axes', struct('step', [1e-4 2e-4]).
  %
  %   Errors have the identifiers strut:usage, :scene, :failed, :file, :interrupted and :notFound. Warnings of the
  %   program have strut:warning; points that fail and parameters that a fit does not identify are warnings, too: see
  %   table.status and found.parameters.NAME.verdict.
  %
  %   The program is that of the variable STRUT, of the build or installation of this file, or of the PATH.

  methods (Static)
    function model = load(varargin)
      model = model_of(varargin, 'load');
      model.set = [model.set, settings_of(varargin(2:end))];
      found = strut.command('check', model);
      found.file = model.file;
      found.set = model.set;
      model = found;
    end

    function [result, motion] = run(varargin)
      if nargout < 2 % without files
        result = strut.command('run', varargin{:});
        return;
      end
      [result, motion] = strut.command('run', varargin{:});
      for name = fieldnames(motion)'
        motion.time = motion.(name{1}).time;
        motion.(name{1}) = rmfield(motion.(name{1}), 'time');
      end
    end

    function result = equilibria(varargin), result = strut.command('equilibria', varargin{:}); end
    function result = modes(varargin), result = strut.command('modes', varargin{:}); end
    function result = path(varargin), result = strut.command('path', varargin{:}); end

    function [table, study] = sweep(varargin)
      model = model_of(varargin, 'sweep');
      options = varargin(2:end);
      is_study = @(text) ~isempty(regexp(text, '^[{\s]*"?study"?\s*:', 'once', 'lineanchors'));
      if exist(model.file, 'file') == 2 && ~is_study(fileread(model.file))
        [model, options, folder] = study_of(model, options);
        before = cd(folder);
        back = onCleanup(@() cd(before)); %#ok<NASGU>
      end
      [study, tables] = strut.command('sweep', model, options{:});
      table = struct();
      if isfield(tables, 'table')
        table = tables.table;
      end
    end

    function [result, residuals] = fit(varargin)
      [result, tables] = strut.command('sweep', model_of(varargin, 'fit'), varargin{2:end});
      if ~isfield(result, 'parameters')
        error('strut:usage', 'this study has no fit: use strut.sweep');
      end
      residuals = tables.residuals;
      names = matlab.lang.makeValidName(result.parameters.parameter);
      columns = rmfield(result.parameters, 'parameter');
      result.parameters = struct();
      for i = 1:numel(names)
        for key = fieldnames(columns)'
          value = columns.(key{1})(i);
          if iscell(value)
            value = value{1};
          end
          result.parameters.(names{i}).(key{1}) = value;
        end
      end
    end

    function [result, tables] = command(name, varargin)
      name = char(name);
      model = model_of(varargin, name);
      folder = tempname();
      mkdir(folder);
      cleaner = onCleanup(@() system(['rm -rf ' quoted(folder)])); %#ok<NASGU>
      known = options_of(name, folder);
      [words, settings, output] = words_of(name, known, varargin(2:end));
      settings = [model.set, settings];
      [~, last] = unique(regexprep(settings, '=.*', ''), 'last'); % of two for one parameter
      words = [words, cellfun(@(setting) ['--set=' setting], settings(sort(last(:)')), 'UniformOutput', false)];
      if isempty(output) && (nargout > 1 || strcmp(name, 'sweep'))
        output = fullfile(folder, 'results');
      end
      if ~isempty(output)
        words = [words, {'--output', output}];
      end
      words = [words, reshape(cellstr(model.file), 1, [])]; % compare takes several

      [status, out, err] = execute([{name, '--json'}, words], folder, model.text);
      failed = ~any(status == [0, 5]);
      if failed && isempty(err) % the messages are in the JSON
        [status, ~, err] = execute([{name}, words], folder, model.text);
      end
      if failed && ~(status == 3 && strcmp(name, 'sweep') && ~isempty(out)) % points that failed are rows
        complain(name, status, err, known);
      elseif ~isempty(err) && ~strcmp(name, 'check') % what computes the model says it
        warning('strut:warning', '%s', err);
      end
      % A null in front of a list of things makes it a cell, even if there is a single thing.
      result = columns_of(jsondecode(regexprep(out, '(":\s*)\[\{', '$1[null,{')));
      tables = struct();
      if nargout > 1
        for file = dir(fullfile(output, '*.csv'))'
          [~, table] = fileparts(file.name);
          tables.(matlab.lang.makeValidName(table)) = read_table(fullfile(output, file.name));
        end
      end
    end
  end
end

% ---- the program ----

function path = program()
  beside = {'../strut', '../../../bin/strut', '../../../build/release/strut'}; % in a build, an installation, a clone
  paths = [{getenv('STRUT')}, fullfile(fileparts(mfilename('fullpath')), beside), {'strut'}];
  there = cellfun(@(path) exist(path, 'file') == 2, paths);
  path = paths{find(there | [~isempty(paths{1}), 0, 0, 0, 1], 1)};
end

% Runs the program from a script for sh: system() takes the user's shell, which may be another.
function [status, out, err] = execute(words, folder, input)
  files = fullfile(folder, {'in', 'out', 'err', 'command.sh'});
  write(files{1}, input);
  % MATLAB puts libraries of its own before those of the program.
  libraries = strsplit(getenv('LD_LIBRARY_PATH'), ':');
  libraries(strncmp(libraries, matlabroot(), numel(matlabroot()))) = [];
  parts = cellfun(@quoted, [{strjoin(libraries, ':'), program()}, words, files], 'UniformOutput', false);
  write(files{4}, sprintf('LD_LIBRARY_PATH=%s %s <%s >%s 2>%s\n', parts{1}, strjoin(parts(2:end - 4), ' '), ...
                          parts{end - 3:end - 1}));
  [status, ~] = system(['sh ' parts{end}]);
  out = fileread(files{2});
  err = regexprep(strtrim(fileread(files{3})), '^strut: (error: |warning: )?', '', 'lineanchors');
end

function write(path, text)
  file = fopen(path, 'w');
  fwrite(file, text, 'char');
  fclose(file);
end

function word = quoted(word)
  word = ['''' strrep(word, '''', '''\''''') ''''];
end

% The options of a command, as its help lists them: those with a value, and flags.
function known = options_of(name, folder)
  persistent helps
  if ~isfield(helps, name)
    [status, out, err] = execute({name, '--help'}, folder, '');
    if status ~= 0
      complain(name, status, err, struct('valued', {{}}, 'flags', {{}}));
    end
    for kind = {'valued', ' \S'; 'flags', '(?:  |$)'}'
      found = regexp(out, ['^ .*?--([\w-]+)' kind{2}], 'tokens', 'lineanchors', 'dotexceptnewline');
      helps.(name).(kind{1}) = [found{:}];
    end
  end
  known = helps.(name);
end

function complain(name, status, err, known)
  if any(status == [126, 127])
    error('strut:notFound', ['no program strut (%s): set the environment variable STRUT to its path, or add its ' ...
                             'folder to PATH'], err);
  end
  if isempty(err)
    err = sprintf('the program ended with exit code %d', status);
  elseif ~isempty(regexp(err, 'has no parameters?\>', 'once'))
    names = setdiff([known.valued, known.flags], {'json', 'help', 'quiet'});
    err = sprintf('%s\nNames are parameters of the model or options of the command: %s', err, ...
                  strrep(strjoin(names, ', '), '-', '_'));
  end
  identifiers = {'usage', 'scene', 'failed', 'file', 'interrupted'};
  error(['strut:' identifiers{min(max(status, 1), 5)}], '%s', err);
end

% ---- arguments ----

% The first argument as a file, settings NAME=VALUE, and the text of the file '-', which is standard input.
function model = model_of(given, name)
  assert(~isempty(given), 'strut:usage', 'strut.%s needs a file, as in strut.%s(''model.yaml'')', name, name);
  model = given{1};
  if ~isstruct(model)
    assert(ischar(model) || iscellstr(model) || isa(model, 'string'), 'strut:usage', ...
           'strut.%s: a model is a file or what strut.load returned, not of class %s', name, class(model));
    model = struct('file', {model}, 'set', {cell(1, 0)});
  end
  if ~isfield(model, 'text')
    model.text = '';
  end
end

% Names and values as options of the program, settings, and the name of a folder.
function [words, settings, output] = words_of(name, known, given)
  [words, settings, output] = deal(cell(1, 0), cell(1, 0), '');
  if mod(numel(given), 2)
    error('strut:usage', ['strut.%s: arguments are names and values, but the last has no value; several models are ' ...
                          'one cell, {''a.yaml'', ''b.yaml''}'], name);
  end
  for i = 1:2:numel(given)
    value = given{i + 1};
    option = strrep(lower(char(given{i})), '_', '-');
    if strcmp(option, 'set')
      settings = [settings, settings_of(value)]; %#ok<AGROW>
    elseif any(strcmp(option, known.flags))
      if value
        words{end + 1} = ['--' option]; %#ok<AGROW>
      end
    elseif ~any(strcmp(option, known.valued))
      settings = [settings, settings_of(given(i:i + 1))]; %#ok<AGROW>
    elseif strcmp(option, 'output')
      output = char(value);
    else
      words{end + 1} = ['--' option '=' strjoin(texts_of(value), ',')]; %#ok<AGROW>
    end
  end
end

% Settings NAME=VALUE of {'friction', 0.2, ...}, of struct('friction', 0.2), or of such texts.
function settings = settings_of(value)
  if isstruct(value)
    value = [fieldnames(value), struct2cell(value)]';
  elseif ~iscell(value)
    settings = cellstr(value);
    return;
  end
  if mod(numel(value), 2)
    error('strut:usage', 'parameters are names and values, but the last has no value');
  end
  settings = cell(1, numel(value) / 2);
  for i = 1:numel(settings)
    settings{i} = [char(value{2 * i - 1}) '=' strjoin(texts_of(value{2 * i}), ',')];
  end
end

% Numbers with all their digits, or texts, as a row of texts.
function texts = texts_of(values)
  if isnumeric(values) || islogical(values)
    values = arrayfun(@(value) sprintf('%.17g', value), values, 'UniformOutput', false);
  end
  texts = reshape(cellstr(values), 1, []);
end

% A study of a model over axes, as standard input in the model's folder, and what of the arguments are options.
function [study, options, folder] = study_of(model, given)
  [folder, name, extension] = fileparts(model.file);
  folder = absolute(folder);
  words = {'accuracy', 'budget', 'integrator', 'step', 'tolerance', 'steady', 'threads', 'set'};
  keys = {'compute', 'check', 'derive', 'initial', 'limit', 'lowest', 'path', 'run', 'solver', 'variants'};
  parts = {'"strut": 1', '"study": "Sweep"', ['"model": ' jsonencode([name extension])]};
  axes = struct();
  options = {};
  for i = 1:2:numel(given) - 1
    key = char(given{i});
    value = given{i + 1};
    if any(strcmpi(key, words))
      options = [options, {key, value}]; %#ok<AGROW>
    elseif any(strcmpi(key, {'output', 'plot'}))
      options = [options, {key, absolute(char(value))}]; %#ok<AGROW>
    elseif any(strcmp(key, keys))
      parts{end + 1} = [jsonencode(key) ': ' jsonencode(value)]; %#ok<AGROW>
    elseif strcmp(key, 'keep')
      parts{end + 1} = ['"keep": ' list_of(value)]; %#ok<AGROW>
    elseif strcmp(key, 'axes')
      for axis = fieldnames(value)'
        axes.(axis{1}) = value.(axis{1});
      end
    else
      axes.(key) = value;
    end
  end
  names = fieldnames(axes)';
  lists = cellfun(@(name) ['{' jsonencode(name) ': ' list_of(axes.(name)) '}'], names, 'UniformOutput', false);
  parts{end + 1} = ['"axes": [' strjoin(lists, ', ') ']'];
  is_axis = ismember(regexprep(model.set, '=.*', ''), names);
  study = struct('file', '-', 'set', {model.set(~is_axis)}, 'text', ['{' strjoin(parts, ', ') '}']);
end

function path = absolute(path)
  if isempty(path) || path(1) ~= '/', path = fullfile(pwd(), path); end
end

function text = list_of(values)
  if isstruct(values) % a range
    text = jsonencode(values);
  elseif isnumeric(values)
    text = ['[' strjoin(texts_of(values), ', ') ']'];
  else
    text = jsonencode(texts_of(values));
  end
end

% ---- results ----

% Decoded JSON, whose lists of things are cells that begin with [], with structs of columns in their place.
function value = columns_of(value)
  if isstruct(value)
    for name = fieldnames(value)'
      value.(name{1}) = columns_of(value.(name{1}));
    end
  elseif iscell(value) && numel(value) > 1 && isempty(value{1}) && isstruct(value{2})
    value = joined(value(2:end));
  end
end

% One struct of columns from the structs of all rows; [] is a row without values.
function table = joined(rows)
  table = struct();
  for i = 1:numel(rows)
    if isstruct(rows{i})
      for name = fieldnames(rows{i})'
        if ~isfield(table, name{1})
          table.(name{1}) = cell(numel(rows), 1);
        end
        table.(name{1}){i} = rows{i}.(name{1});
      end
    end
  end
  for name = fieldnames(table)'
    table.(name{1}) = column(table.(name{1}));
  end
end

% The column of the values of all rows: a struct of columns, a matrix with a row for each, texts, or a cell.
function values = column(values)
  there = ~cellfun(@isempty, values);
  found = values(there);
  every = @(holds) all(cellfun(holds, found));
  if isempty(found)
    values = nan(numel(values), 1);
  elseif every(@(value) isstruct(value) && isscalar(value))
    values = joined(values);
  elseif every(@ischar)
    values(~there) = {''};
  elseif every(@(value) ~iscell(value) && iscolumn(value) && numel(value) == numel(found{1}))
    values = nan(numel(there), numel(found{1}));
    values(there, :) = double([found{:}])';
  else
    values = cellfun(@columns_of, values, 'UniformOutput', false);
  end
end

% A CSV file as a struct of columns; "n1.x [m]" is n1_x.
function table = read_table(path)
  text = fileread(path);
  head = find(text == sprintf('\n'), 1);
  header = strsplit(text(1:head - 1), ',');
  names = matlab.lang.makeUniqueStrings(matlab.lang.makeValidName(regexprep(header, ' \[.*\]$', '')));
  text = text(head + 1:end);
  if isempty(regexp(text, '[^-+.,\d\neE]|,,|,\n', 'once')) % numbers only, fast
    cells = num2cell(reshape(sscanf(strrep(text, ',', ' '), '%f'), numel(names), [])', 1);
  else
    words = regexp(text, '("(?:[^"]|"")*"|[^,\n]*)[,\n]', 'tokens');
    words = reshape([words{:}], numel(names), [])';
    cells = cell(1, numel(names));
    for i = 1:numel(names)
      cells{i} = str2double(words(:, i));
      given = ~cellfun(@isempty, words(:, i));
      if any(isnan(cells{i}(given))) || ~(any(given) || any(header{i} == '[')) % texts, or an empty column without unit
        cells{i} = strrep(regexprep(words(:, i), '^"|"$', ''), '""', '"');
      end
    end
  end
  table = cell2struct(cells, names, 2);
end
