"""Laws of raydiff.py: a right tracer is right, planted bugs are found, and each error has its line."""
import re

import numpy as np
import raydiff
from numpy_tracer import trace


def refused(kind, words, call):
    try:
        call()
    except raydiff.Error as error:
        assert error.kind == kind and words in str(error), (error.kind, str(error))
        return
    raise AssertionError('not refused: ' + words)


def sphere(n):
    """A closed mesh of 2 n (n - 1) triangles."""
    angle = np.arange(n) * (2 * np.pi / n)
    rings = [np.stack([np.sin(h) * np.cos(angle), np.sin(h) * np.sin(angle), np.full(n, np.cos(h))], 1)
             for h in np.arange(1, n) * (np.pi / n)]
    vertices = np.concatenate([[[0, 0, 1]], *rings, [[0, 0, -1]]]).astype(np.float32)
    last, indices = len(vertices) - 1, []
    for k in range(n):
        m = (k + 1) % n
        indices += [(0, 1 + k, 1 + m), (last, last - n + m, last - n + k)]
        for ring in range(n - 2):
            i, j = 1 + ring * n, 1 + (ring + 1) * n
            indices += [(i + k, j + k, j + m), (i + k, j + m, i + m)]
    return vertices, np.array(indices)


# The structures of the module are those of the header.
sizes = dict(re.findall(r'sizeof\(struct raydiff_(\w+)\) == (\d+)', open('tests/library/abi.txt').read()))
for name, size in (('answer', raydiff.ANSWER.itemsize), ('nearest', raydiff.EXACT.itemsize),
                   ('crossing', raydiff.CROSSING.itemsize), ('judged', raydiff.JUDGED.itemsize),
                   ('counts', raydiff.ctypes.sizeof(raydiff._Counts)), ('why', raydiff.ctypes.sizeof(raydiff._Why)),
                   ('judging', raydiff.ctypes.sizeof(raydiff._Judging)),
                   ('faults', raydiff.ctypes.sizeof(raydiff._Faults)), ('mesh', raydiff.ctypes.sizeof(raydiff._Mesh)),
                   ('instance', raydiff._INSTANCE.itemsize), ('case', raydiff.ctypes.sizeof(raydiff._Case))):
    assert int(sizes[name]) == size, (name, size)
assert raydiff.VERDICTS[0] == 'right' and raydiff.VERDICTS[-1] == 'wrong' and len(raydiff.FAULTS) == 16

vertices, indices = sphere(12)
scene = raydiff.Scene(vertices, indices)
rays = scene.hard_rays(4000, seed=7)
assert rays.shape == (4000, 8) and rays.dtype == np.float32
assert np.array_equal(rays, raydiff.hard_rays(vertices, indices, 4000, seed=7))
assert not np.array_equal(rays, scene.hard_rays(4000, seed=8))

# Exact answers are those of the tracer but where rounding decides.
exact = scene.exact(rays)
t, u, v, triangle = trace(vertices, indices, rays)
same = exact['triangle'] == triangle.astype(np.uint32)
both = same & (triangle >= 0)
assert 0.5 < same.mean() < 1 and np.isclose(t, exact['t_lo'], 1e-4, 1e-6)[both].mean() > 0.95
assert (exact['t_lo'] <= exact['t_hi']).all() and set(exact['kind']) == {0, 1, 2, 3}
assert np.array_equal(exact, scene.exact(rays, threads=1))

# A tracer that is right, by its own formula and as an unknown one.
for how in ({}, {'formula': 'mt'}, {'formula': 'mt', 'rounding': 'vulkan'}):
    judged = scene.judge(rays, (t, u, v, triangle), **how)
    assert judged.faults == 0 and not judged.vacuous and len(judged.wrong) == 0, judged.reasons()
    assert judged.counts['right'] > 2000 and sum(judged.counts.values()) == len(judged) == 4000
    assert np.array_equal(judged.expected, exact['triangle'])
whole = raydiff.judge(vertices, indices, rays, (t, u, v, triangle), threads=2)
assert np.array_equal(whole.records, scene.judge(rays, (t, u, v, triangle)).records)

# Planted bugs, and that what is stated matters.
for bug, kind in (('wide', 'phantom'), ('culled', 'missed'), ('first', 'missed'), ('half', 'distance')):
    judged = scene.judge(rays, trace(vertices, indices, rays, bug))
    assert judged.faults > 10 and judged.counts[kind] > 10, (bug, judged.counts)
    first = judged.wrong[0]
    assert raydiff.FAULTS[judged.fault[first]] in judged.reason(first).split()[1], judged.reason(first)
    assert judged.reasons().count('\n') == 3
hits = np.zeros(4000, raydiff.ANSWER)
hits['t'], hits['u'], hits['v'], hits['triangle'] = t, u, v, triangle.astype(np.uint32)
hits_of_scene = hits
assert np.array_equal(scene.judge(rays, hits).records, scene.judge(rays, (t, u, v, triangle)).records)
off = (t, u + np.float32(2e-4), v, triangle)
assert scene.judge(rays, off).faults > 100 and scene.judge(rays, off, query='any').faults > 100
behind = [scene.exact_all(ray) for ray in rays[:200]]
assert max(map(len, behind)) >= 6 and all((k['t_lo'][:-1] <= k['t_hi'][1:]).all() for k in behind)
assert all((len(k) > 0) == (e != raydiff.NOTHING) for k, e in zip(behind, exact['triangle']))
refused('input', "query: 'nearest' is neither", lambda: scene.judge(rays, hits, query='nearest'))

# Origins and directions are rays from 0 to infinity.
pair = scene.exact((rays[:, 0:3], rays[:, 4:7]))
plain = rays.copy()
plain[:, 3], plain[:, 7] = 0, np.inf
assert np.array_equal(pair, scene.exact(plain))
down = np.array([[0, 0, 9, 0, 0, 0, -4, 9]], np.float32)
assert scene.exact_text(down[0], int(scene.exact(down)['triangle'][0])) == '2/1'

# The smallest case of a bug; an exception of the callback comes out.
calls = []
def fails(*case):
    if not len(case[1]): # shrinking tries no triangles at all, too
        return False
    calls.append(1)
    judged = raydiff.judge(*case[:2], case[2][None], trace(case[0], case[1], case[2][None], 'culled'))
    return judged.faults > 0
number = scene.judge(rays, trace(vertices, indices, rays, 'culled')).wrong[0]
small = raydiff.shrink(vertices, indices, rays[number], fails)
assert small[0].shape == (3, 3) and small[1].shape == (1, 3) and small[2].shape == (8,) and fails(*small)
few = len(calls)
raydiff.shrink(vertices, indices, rays[number], fails, calls=20)
assert len(calls) - few <= 21
try:
    raydiff.shrink(vertices, indices, rays[number], lambda *case: 1 // 0)
    raise AssertionError('no exception')
except ZeroDivisionError:
    pass

# A world: the mesh twice, the second one larger and met by masks with bit 2 alone.
world = raydiff.World([(vertices, indices)], [(0, np.eye(3, 4), 1), (0, [[2, 0, 0, 5], [0, 2, 0, 0], [0, 0, 2, 0]], 2)])
assert list(world.first) == [0, len(indices), 2 * len(indices)]
rays = world.hard_rays(2000, seed=3)
masks = np.arange(2000) % 4
every, met = world.exact(rays), world.exact(rays, masks=masks)
instance, triangle = world.placed(met['triangle'][met['triangle'] != raydiff.NOTHING])
assert set(instance) == {0, 1} and triangle.min() >= 0 and triangle.max() < len(indices)
assert (met['triangle'][masks == 0] == raydiff.NOTHING).all() and np.array_equal(every[masks == 3], met[masks == 3])
assert (met['triangle'][masks == 1] >= len(indices)).sum() == (met['triangle'][(masks == 1)] == raydiff.NOTHING).sum()
copies = np.concatenate([vertices, 2 * vertices + np.array([5, 0, 0], np.float32)])
hits = trace(copies, np.concatenate([indices, indices + len(vertices)]), rays)
assert world.judge(rays, hits).faults == 0
masked = world.judge(rays, hits, masks=masks)
assert masked.counts['masked'] > 50 and 'wrong masked' in masked.reason(masked.wrong[0]), masked.reasons()
refused('input', 'formula: in a world', lambda: world.judge(rays, hits, formula='mt'))
# The line on an answer says what its record says, whatever the masks of others.
for i in list(masked.wrong[:40]) + list(range(0, 2000, 17)):
    named = masked.reason(int(i)).split()
    assert named[0].lower() == raydiff.VERDICTS[masked.verdict[i]], (i, named, masked.verdict[i])
    assert named[0].lower() != 'wrong' or named[1].strip(':') == raydiff.FAULTS[masked.fault[i]], (i, named)
refused('input', 'masks: there are no instances', lambda: scene.exact(rays, masks=masks))
refused('input', 'masks: shape (3,)', lambda: world.exact(rays, masks=[1, 2, 3]))
refused('input', 'instance 0: mesh 1, but', lambda: raydiff.World([(vertices, indices)], [(1, np.eye(3, 4), 1)]))
refused('input', 'instance 0: transform: shape', lambda: raydiff.World([(vertices, indices)], [(0, np.eye(4), 1)]))

# What breaks a rule.
rays, hits = scene.hard_rays(4000, seed=7), hits_of_scene
refused('input', 'triangle 2: vertex index', lambda: raydiff.Scene(vertices, [[0, 1, 2], [2, 1, 0], [0, 1, 999]]))
refused('input', 'vertex 0: coordinate x is not finite', lambda: raydiff.Scene(vertices + np.inf, indices))
refused('input', 'float32 does not hold', lambda: raydiff.Scene(vertices.astype(float) + 1e-9, indices))
refused('input', 'shape (3, 2) is not (n, 3)', lambda: raydiff.Scene(np.zeros((3, 2)), indices))
refused('input', 'shape (3,) is not (m, 3)', lambda: raydiff.Scene(vertices, [0, 1, 2]))
refused('input', 'not whole numbers', lambda: raydiff.Scene(vertices, indices.astype(float)))
refused('input', 'not whole numbers', lambda: raydiff.Scene(vertices, -indices))
refused('input', "there is no 'edgs'; did you mean edges?", lambda: scene.hard_rays(3, 'edgs'))
refused('input', "there is no 'mtt'; did you mean mt?", lambda: scene.judge(rays, hits, formula='mtt'))
refused('input', 'hits: u has shape (9,)', lambda: scene.judge(rays, (t, u[:9], v, triangle)))
refused('input', 'hits: shape (9,)', lambda: scene.judge(rays, hits[:9]))
refused('input', "does not begin as a packed tree does", lambda: scene.check_tree(b'RDPX' + bytes(60)))
refused('input', 'oracle: is NULL', lambda: (scene.close(), scene.exact(rays)))
print('python: raydiff %d.%d.%d, numpy %s' % (*raydiff.version(), np.__version__))
