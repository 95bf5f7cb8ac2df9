"""trimesh's own tracer, judged where trimesh is installed (Debian 13: python3-trimesh python3-rtree
python3-scipy). Its rays have no range: those of the set edges go from 0 to beyond the mesh."""
import sys

import numpy as np
import raydiff


def skip(why):
    """Without trimesh nothing is judged; it is a fault where the call asks for it."""
    print('SKIP trimesh: %s' % why)
    raise SystemExit(1 if '--trimesh' in sys.argv else 0)


try:
    import trimesh
    from trimesh.ray.ray_triangle import RayMeshIntersector
except ImportError as error:
    skip(error)

ball = trimesh.creation.icosphere(subdivisions=3)
mesh = trimesh.Trimesh(ball.vertices.astype(np.float32), ball.faces, process=False)
scene = raydiff.Scene(mesh.vertices, mesh.faces)
rays = scene.hard_rays(3000, 'edges', seed=3)


def answers(offset):
    """The nearest hits of trimesh, with u and v of their places, all in float64."""
    origin, direction = rays[:, 0:3].astype(float), rays[:, 4:7].astype(float)
    triangles, numbers, places = RayMeshIntersector(mesh).intersects_id(
        origin, direction, multiple_hits=True, return_locations=True)
    t = ((places - origin[numbers]) * direction[numbers]).sum(1) / (direction[numbers] ** 2).sum(1) + offset
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[triangles], places)
    order = np.lexsort((t, numbers))
    first = order[np.unique(numbers[order], return_index=True)[1]]
    out = [np.zeros(len(rays)) for _ in range(3)] + [np.full(len(rays), -1)]
    for column, values in zip(out, (t, weights[:, 1], weights[:, 2], triangles)):
        column[numbers[first]] = values[first]
    return out


try:
    hits = answers(0.0)
except ImportError as error: # a package that trimesh recommends
    skip('its tracer needs more: %s' % error)
judged = scene.judge(rays, hits)
print('trimesh %s: %d of %d answers at fault: %s' % (trimesh.__version__, judged.faults, len(rays), judged.counts))
assert judged.hits > 2500 and judged.counts['right'] > 2900 and judged.faults < 10, judged.reasons()
spoiled = scene.judge(rays, answers(1e-3))
assert spoiled.counts['distance'] > 2000, spoiled.reasons()
