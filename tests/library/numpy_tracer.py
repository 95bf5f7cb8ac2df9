"""A tracer in numpy: every ray against every triangle by Moeller and Trumbore 1997, in float32."""
import numpy as np


def trace(vertices, indices, rays, bug=None):
    """t, u, v and triangle (-1: a miss) of the nearest hits. bug: a mistake that tracers had."""
    with np.errstate(all='ignore'):
        a, b, c = (vertices[indices[:, k]] for k in range(3))
        e1, e2 = (b - a)[None], (c - a)[None]
        origin, direction = rays[:, None, 0:3], rays[:, None, 4:7]
        cross, dot = np.cross, lambda p, q: (p[..., 0] * q[..., 0] + p[..., 1] * q[..., 1]) + p[..., 2] * q[..., 2]
        p = cross(direction, e2)
        det, s = dot(e1, p), origin - a[None]
        q = cross(s, e1)
        t, u, v = dot(e2, q) / det, dot(s, p) / det, dot(direction, q) / det
        hit = (det != 0) & (u >= 0) & (v >= 0) & (t >= rays[:, None, 3]) & (t <= rays[:, None, 7])
        hit &= u + v <= (1.02 if bug == 'wide' else 1)
        if bug == 'culled':
            hit &= det > 1e-12
        best = np.argmin(np.where(hit, t, np.inf), axis=1)
        if bug == 'first':
            best = np.argmax(hit, axis=1)
    row = np.arange(len(rays))
    triangle = np.where(hit.any(axis=1), best, -1)
    out = [np.where(triangle >= 0, x[row, best], 0).astype(np.float32) for x in (t, u, v)]
    if bug == 'half':
        out[0] = out[0].astype(np.float16).astype(np.float32)
    return (*out, triangle)
