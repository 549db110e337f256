#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every member of the structs of things has a row in engine/scene/things_table.h, or a reason to have none.

A number without a row would be missing from what an equilibrium is known by, and a cached answer wrong.

    things_rows.py ROOT
"""
import re
import sys

STRUCTS = ['node', 'member', 'maxwell', 'hinge', 'cell', 'collision', 'unbalance', 'sliding_mass', 'load',
           'ground', 'contact', 'law']

# Members without a row, and why nothing at rest depends on them.
EXCEPTIONS = {
    'name': 'nothing computes with names',
    'node.velocity': 'of runs',
    'ground.present': 'scene.grounds never have it; that of scene.ground has a row',
    'ground.motion': 'of runs',
    'ground.moves': 'of runs',
    'contact.friction': 'of runs',
    'unbalance.speed': 'of runs',
    'load.signal': 'loads with a signal are off at rest',
    'law.source': 'which of the lists of points is given',
    'sliding_mass.travel': 'a tag of its signal, whose value at t = 0 counts',
}


def members(source, struct):
    """The names of a struct's members."""
    body = re.search(r'typedef struct strut_%s \{(.*?)\n\} strut_%s;' % (struct, struct), source, re.S).group(1)
    body = re.sub(r'/\*.*?\*/', '', body, flags=re.S)
    body = '\n'.join(line for line in body.split('\n') if not line.startswith('#'))
    for declaration in body.split(';'):
        for name in re.sub(r'\(\*(\w+)\)', r'\1', declaration).split(','):
            word = re.search(r'(\w+)\s*(?:\[\d+\])*\s*$', name)
            if word:
                yield word.group(1)


def main():
    root = sys.argv[1]
    read = lambda name: open('%s/engine/scene/%s' % (root, name), encoding='utf-8').read()
    structs = read('scene.h') + read('law.h')
    parameters = [name for name in re.findall(r'X\([A-Z_]+, (\w+),', read('laws/numbers.h')) if name not in ('field', 'key')]
    table = read('things_table.h')
    missing, seen = [], 0
    for struct in STRUCTS:
        object_ = 'strut_ground_section' if struct in ('ground',) else 'strut_' + struct
        inner = 'ground.' if struct == 'ground' else ''
        for name in members(structs, struct):
            if name.startswith('STRUT_') or (struct == 'law' and name in parameters):
                continue
            seen += 1
            place = r'\(%s, (\w+, )?%s%s\b' % (object_, re.escape(inner), name)
            counted = r'\(%s, [\w.]+, %s%s\b' % (object_, re.escape(inner), name)
            plain = r'\(strut_%s, (\w+, )?%s\b' % (struct, name)
            if any(re.search(pattern, table) for pattern in (place, counted, plain)):
                continue
            if name not in EXCEPTIONS and '%s.%s' % (struct, name) not in EXCEPTIONS:
                missing.append('strut_%s.%s' % (struct, name))
    for name in parameters:
        seen += 1
        if not re.search(r'FIELD\(strut_law, %s\)' % name, table) and name not in ('coefficients', 'points',
                                                                            'control_points'):
            missing.append('strut_law.%s' % name)
    if missing:
        sys.exit('no row in engine/scene/things_table.h: ' + ', '.join(missing))
    if seen < 80:
        sys.exit('only %d members were found' % seen)
    print('%d members have rows' % seen)


main()
