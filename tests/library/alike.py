"""The library and `raydiff judge` judge alike, from files to counts.
    alike.py RAYS HITS VERDICTS            reads what raydiff gen wrote, answers it with some bugs, judges
    alike.py --compare JSON SAID VERDICTS  holds that against the command's JSON and its lines"""
import json
import sys

import numpy as np
import raydiff
from numpy_tracer import trace


def read(path):
    rows = {'v': [], 't': [], 'r': []}
    query = 'closest'
    for line in open(path):
        word, *rest = line.split()
        if word == 'query':
            query = rest[0]
        elif word in 'vr':
            rows[word].append([float.fromhex(x) for x in rest])
        elif word == 't':
            rows[word].append([int(x) for x in rest])
    return (np.array(rows['v'], np.float32), np.array(rows['t']), np.array(rows['r'], np.float32), query)


def answers(vertices, indices, rays):
    t, u, v, triangle = trace(vertices, indices, rays)
    triangle[::19] = -1
    t[3::19] *= np.float32(1.0001)
    v[5::19] += np.float32(0.001)
    found = triangle >= 0
    triangle[7::19] = np.where(found[7::19], (triangle[7::19] + 1) % len(indices), -1)
    t, u, v = (np.where(triangle >= 0, x, 0) for x in (t, u, v))
    return t, u, v, triangle


if sys.argv[1] == '--compare':
    row = json.load(open(sys.argv[2]))['rows'][0]
    said, ours = open(sys.argv[3]).read(), json.load(open(sys.argv[4]))
    theirs = {name: count for name, count in row['counts'].items() if count}
    assert theirs == ours['verdicts'], (theirs, ours['verdicts'])
    assert {name: count for name, count in row['wrong'].items() if count} == ours['faults'], row['wrong']
    assert row['hits'] == ours['hits'] and len(ours['verdicts']) >= 3 and len(ours['faults']) >= 3
    lines = [line.split(' ray ', 1)[1] for line in said.splitlines() if line.startswith('WRONG ') and ' ray ' in line]
    assert lines, said
    for line in lines: # "12 o=(...": the number and the reason without its first words
        number, rest = line.split(' ', 1)
        assert ours['reasons'][number].endswith(' ' + rest), (line, ours['reasons'][number])
    print('alike: %s' % ours['verdicts'])
else:
    vertices, indices, rays, query = read(sys.argv[1])
    t, u, v, triangle = answers(vertices, indices, rays)
    with open(sys.argv[2], 'w') as out:
        for k in range(len(rays)):
            out.write('m\n' if triangle[k] < 0 else 'h %s %s %s %d\n' % (
                *(float(x[k]).hex() for x in (t, u, v)), triangle[k]))
    judged = raydiff.judge(vertices, indices, rays, (t, u, v, triangle), query=query)
    counts = judged.counts
    json.dump({'verdicts': {name: counts[name] for name in raydiff.VERDICTS if name in counts},
               'faults': {name: counts[name] for name in raydiff.FAULTS if name in counts},
               'hits': judged.hits, 'reasons': {int(i): judged.reason(i) for i in judged.wrong}},
              open(sys.argv[3], 'w'))
