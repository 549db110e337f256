#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut.m in Octave: what it returns is what the program prints and writes; its arguments, errors and warnings.
. "$(dirname "$0")/lib.sh"
octave=$(command -v octave-cli || command -v octave) || { echo "skipped: Octave is not installed"; exit 77; }
cp -R "$models" models
mkdir "it's a folder"
cp models/basics/von-mises-truss.yaml "it's a folder/\$x.yaml"
OCTAVE_PATH=$(dirname "$strut")/matlab
STRUT=$strut
export OCTAVE_PATH STRUT

yaml fit.yaml <<'YAML'
study: A stiffness from a frequency
model: models/basics/oscillator.yaml
fit: {over: {stiffness: {from: 50 N/m, to: 500 N/m}},
      match: {hammer: {compute: modes, frequency_1: 1.62 Hz, noise: 0.01 Hz}}}
YAML
yaml study.yaml <<'YAML'
study: Points that fail, and a message with a comma
model: models/crawler/crawler.yaml
axes: [{step: [0.1 ms, 10 ms]}, {start: [I, II]}]
run: {periods: 20, measure: {last: 5}}
keep: [velocity, outcome]
YAML
yaml bad.yaml <<'YAML'
nodes: {a: {positon: [0, 0]}}
YAML

# The program's own numbers and texts: wanted NAME FILTER makes NAME of the JSON in out, a line for each.
wanted() { jq -r "$2" out >"$1"; }
crawler=models/crawler/crawler.yaml
expect 0 run $crawler --accuracy '1 %' --set "frequency=11 Hz" --json -o run
wanted velocity '.velocity, .energy.kinetic, .accuracy.expected'
expect 0 modes $crawler --at II --json
wanted frequency '.modes[].frequency'
wanted shape '.modes[].shape.n3[1]'
wanted kind '.modes[].kind'
expect 0 equilibria models/basics/robot.yaml --json
wanted energy '.equilibria[].energy'
wanted name '.equilibria[].name'
wanted friction '.equilibria[] | .rest.friction // "NaN"'
wanted barrier '.barriers[].height'
expect 0 path models/basics/von-mises-truss.yaml --until 3 --json
wanted factor '.points[].factor'
wanted apex '.points[].nodes.apex[1]'
wanted event '.events[].kind'
expect 0 check $crawler --json
wanted rest '.members[].rest_length'
expect 0 sweep fit.yaml --json -o fit
wanted stiffness '.parameters[0] | .value, .low, .high'
expect 3 sweep study.yaml --json -o study

cat >checks.m <<'M'
1;
function numbers(found, file) % as in the file, but for the last bits, in which Octave reads decimal numbers otherwise
  wanted = load(file);
  found = double(found(:));
  assert(numel(found), numel(wanted), 0);
  assert(isnan(found), isnan(wanted));
  there = ~isnan(wanted);
  assert(all(abs(found(there) - wanted(there)) <= 1e-15 * abs(wanted(there))), file);
end
function texts(found, file)
  assert(iscellstr(found));
  assert(found, strsplit(strtrim(fileread(file)), "\n")');
end
function fails(identifier, part, call)
  try
    call();
  catch problem
    assert(problem.identifier, identifier);
    assert(~isempty(strfind(problem.message, part)), problem.message);
    return;
  end
  error('no error, expected %s', part);
end

crawler = 'models/crawler/crawler.yaml';
model = strut.load(crawler, 'frequency', '11 Hz');
rest = structfun(@(member) member.rest_length, model.members);
numbers(rest, 'rest');

% A run, its motion, and the same by other arguments.
[run, motion] = strut.run(model, 'accuracy', '1 %');
numbers([run.velocity, run.energy.kinetic, run.accuracy.expected], 'velocity');
assert(fieldnames(motion), {'contacts'; 'members'; 'nodes'; 'time'});
for part = {'contacts', 'members', 'nodes'}
  table = dlmread(['run/' part{1} '.csv'], ',', 1, 0);
  columns = struct2cell(motion.(part{1}));
  assert(numel(columns) + 1, size(table, 2));
  assert([motion.time, columns{:}], table, -1e-14);
end
assert(isfield(motion.nodes, 'n1_x') && isfield(motion.members, 'm8_force'));
same = @(other) assert(other.velocity, run.velocity);
same(strut.run(crawler, 'Accuracy', 0.01, 'frequency', 11));
same(strut.run(crawler, 'accuracy', '1 %', 'set', struct('frequency', '11 Hz')));
same(strut.run(crawler, 'accuracy', '1 %', 'set', {'frequency', 11}));
same(strut.run(crawler, 'accuracy', '1 %', 'set', 'frequency=0.011 kHz'));
same(strut.run(strut.load(model, 'frequency', '12 Hz'), 'accuracy', '1 %', 'frequency', '11 Hz'));
run = strut.run(crawler, 'step', 5e-5, 'set', {'step', '0.1 ms'}, 'output', 'kept', 'draw', 'period', 'plot', 'it''s.svg');
assert([run.step, run.parameters.step], [5e-5, 1e-4]); % an option and a parameter of one name
assert(exist('kept/nodes.csv', 'file') == 2 && exist('it''s.svg', 'file') == 2);

[run, motion] = strut.run('models/parts/wave-crawler-of-cells.yaml'); % names of copies
assert(size(motion.nodes.foot_0_n_x), size(motion.time));
assert(run.nodes.foot_0_n.position(1), motion.nodes.foot_0_n_x(end), 1e-12);

parameters = struct('friction', 0.123456789012345, 'amplitude', '0.2 mm');
run = strut.run(crawler, 'set', parameters, 'accuracy', '5 %');
assert([run.parameters.friction, run.parameters.amplitude], [0.123456789012345, 2e-4], -1e-15);

% Lists of things are columns, also of a single thing.
found = strut.modes(crawler, 'at', 'II');
numbers(found.modes.frequency, 'frequency');
numbers(found.modes.shape.n3(:, 2), 'shape');
texts(found.modes.kind, 'kind');
found = strut.equilibria('models/basics/robot.yaml');
numbers(found.equilibria.energy, 'energy');
texts(found.equilibria.name, 'name');
numbers(found.equilibria.rest.friction, 'friction'); % not all have the struct
assert(iscellstr(found.equilibria.ends_as)); % nor a text
numbers(found.barriers.height, 'barrier');
found = strut.path('models/basics/von-mises-truss.yaml', 'until', 3);
numbers(found.points.factor, 'factor');
numbers(found.points.nodes.apex(:, 2), 'apex');
texts(found.events.kind, 'event');
found = strut.command('rigidity', 'models/basics/x-frame.yaml');
assert(isfield(found, 'rank'));
found = strut.command('compare', {'models/basics/x-frame.yaml', 'models/basics/von-mises-truss.yaml'});
assert(isequal(found.models.model, {'x-frame'; 'von-mises-truss'}));

% Fits and studies.
[fit, residuals] = strut.fit('fit.yaml', 'output', 'fitted');
found = fit.parameters.stiffness;
numbers([found.value, found.low, found.high], 'stiffness');
assert(found.verdict, 'identified');
assert({residuals.measured, residuals.of}, {1.62, {'frequency_1'}});
assert(fileread('fitted/table.csv'), fileread('fit/table.csv'));
[table, study] = strut.sweep('study.yaml');
[~, identifier] = lastwarn();
assert(identifier, 'strut:warning');
assert([study.points, study.failed, isnan(table.velocity)'], [4, 2, 0, 0, 1, 1]);
assert(table.start, {'I'; 'II'; 'I'; 'II'});
assert(table.outcome(3:4), {''; ''});
wanted = regexp(strtrim(fileread('study/table.csv')), '[^"]*"$', 'match');
assert([table.message{4} '"'], wanted{1});

% A sweep of a model, beside it in another folder; a parameter with the name of an option.
mkdir('elsewhere');
cd('elsewhere');
lastwarn('');
model = strut.load('../models/crawler/crawler.yaml', 'friction', 0.3, 'frequency', 12);
assert(lastwarn(), ''); % such as that the file's own step is too long
table = strut.sweep(model, 'frequency', [10 11], 'start', {'I', 'II'}, 'keep', {'velocity', 'outcome'}, ...
                    'accuracy', '5 %', 'output', 'swept');
assert(table.frequency', [10 10 11 11]);
assert(table.message, {''; ''; ''; ''});
run = strut.run(model, 'frequency', 11, 'start', 'II', 'accuracy', '5 %');
assert(table.velocity(4), run.velocity, -1e-14);
assert(exist('swept/table.csv', 'file') == 2);
cd('..');
range = struct('from', '10 Hz', 'to', '12 Hz', 'count', 3);
short = struct('periods', 20, 'measure', struct('last', 5));
table = strut.sweep(crawler, 'axes', struct('step', [1e-4, 5e-5]), 'frequency', range, 'run', short);
assert([table.step, table.frequency], [1e-4 10; 1e-4 11; 1e-4 12; 5e-5 10; 5e-5 11; 5e-5 12]);
assert(~any(isnan(table.velocity)));
table = strut.sweep('it''s a folder/$x.yaml', 'height', [0.3 0.4], 'compute', 'path', 'keep', 'limit_factor');
assert(numel(table.limit_factor), 2);

% Errors, warnings.
fails('strut:scene', 'bad.yaml:2:13: error: unknown key ''positon''', @() strut.run('bad.yaml'));
fails('strut:usage', 'strut.run needs a file, as in strut.run(''model.yaml'')', @() strut.run());
fails('strut:usage', 'strut.fit needs a file', @() strut.fit());
fails('strut:usage', 'what strut.load returned, not of class double', @() strut.run(3));
fails('strut:usage', 'one cell, {''a.yaml'', ''b.yaml''}', @() strut.command('compare', crawler, crawler));
fails('strut:scene', 'bad.yaml:2:13: error: unknown key ''positon''', @() strut.load('bad.yaml'));
fails('strut:scene', 'did you mean ''frequency''?', @() strut.run(crawler, 'frequncy', 3));
fails('strut:scene', 'options of the command: accuracy,', @() strut.run(crawler, 'acuracy', '1 %'));
fails('strut:usage', 'the last has no value', @() strut.run(crawler, 'accuracy'));
fails('strut:usage', 'use strut.sweep', @() strut.fit('study.yaml'));
fails('strut:usage', 'unknown command', @() strut.command('nothing', crawler));
fails('strut:failed', 'the step 0.01 s is above the largest stable step', @() strut.run(crawler, 'step', '10 ms'));
fails('strut:file', 'No such file', @() strut.run('nowhere.yaml'));
fails('strut:file', 'No such file', @() strut.sweep('nowhere.yaml'));
lastwarn('', '');
found = strut.run('models/basics/bouncing-node.yaml', 'step', 1, 'force', true);
[text, identifier] = lastwarn();
assert({identifier, text(1:14)}, {'strut:warning', 'the energy bal'});
assert(found.warnings.text, {text}); % one warning, in a column
found = strut.run(crawler, 'accuracy', '2 %', 'friction_law', 'coulomb');
assert(found.status, 'completed');

% The program: beside the file, or of the environment.
setenv('STRUT', '');
same(strut.run(crawler, 'accuracy', '1 %', 'frequency', 11));
setenv('STRUT', '/nowhere/strut');
fails('strut:notFound', 'environment variable STRUT', @() strut.run(crawler));
M
"$octave" --quiet --no-init-file --no-gui checks.m >out 2>err || fail "Octave: $(tail -n 30 err)"

# Octave leaves nothing behind, and warns of nothing when the folder is added to its path.
mkdir tmp
TMPDIR=$work/tmp "$octave" --quiet --no-init-file --no-gui --eval "addpath('$OCTAVE_PATH'); strut.run('$crawler', 'step', 5e-5);" >out 2>err ||
  fail "Octave: addpath"
out_empty
[ -z "$(ls -A tmp)" ] || fail "files are left: $(ls -A tmp)"
! grep -v '^error: ignoring const execution_exception' err || fail "warnings"
