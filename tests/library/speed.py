"""How long it takes to judge answers from Python, the oracle included: make library-speed.
    speed.py REQUEST [COUNT [THREADS [MOST]]]      REQUEST: what raydiff gen wrote of a scene
Prints the seconds of raydiff.judge with each description of the tracer, the best of 3; exit 1 if the one without
a formula takes over MOST seconds [2]. The answers are the exact ones, rounded to float32."""
import sys
import time

import numpy as np
import raydiff

count = int(sys.argv[2]) if len(sys.argv) > 2 else 10**6
threads = int(sys.argv[3]) if len(sys.argv) > 3 else 2
most = float(sys.argv[4]) if len(sys.argv) > 4 else 2.0
lines = [line.split() for line in open(sys.argv[1])]
vertices = np.array([[float.fromhex(x) for x in line[1:]] for line in lines if line[0] == 'v'], np.float32)
indices = np.array([[int(x) for x in line[1:]] for line in lines if line[0] == 't'])


def weights(rays, triangle):
    """u and v of each ray on its triangle, in float64."""
    a, b, c = (vertices[indices[triangle, k]].astype(float) for k in range(3))
    origin, direction = rays[:, 0:3].astype(float), rays[:, 4:7].astype(float)
    p, s = np.cross(direction, c - a), origin - a
    q, det = np.cross(s, b - a), ((b - a) * p).sum(1)
    return (s * p).sum(1) / det, (direction * q).sum(1) / det


with raydiff.Scene(vertices, indices) as scene:
    rays = scene.hard_rays(count, seed=1)
    exact = scene.exact(rays)
found = exact['triangle'] != raydiff.NOTHING
triangle = np.where(found, exact['triangle'], 0)
hits = np.zeros(count, raydiff.ANSWER)
with np.errstate(all='ignore'):
    hits['u'], hits['v'] = weights(rays, triangle)
hits['t'], hits['triangle'] = exact['t_lo'], exact['triangle']
worst = 0
for how in ({}, {'formula': 'mt'}):
    took = []
    for _ in range(3):
        start = time.monotonic()
        judged = raydiff.judge(vertices, indices, rays, hits, threads=threads, **how)
        took.append(time.monotonic() - start)
    if not how:
        worst = min(took)
    print('%d answers, %d triangles, %d threads, formula %s: %.2f s; %d at fault, %.0f %% hits' % (
        count, len(indices), threads, how.get('formula', 'unknown'), min(took), judged.faults,
        100 * judged.hits / count))
print('bound: %.1f s without a formula: %s' % (most, 'kept' if worst <= most else 'NOT kept'))
sys.exit(worst > most)
