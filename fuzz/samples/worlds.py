# A tracer of worlds in Python: every triangle of every instance for every ray, in double precision.
#   raydiff check mixed --engine 'pipe:python3 fuzz/samples/worlds.py'
#   raydiff gen mixed | python3 fuzz/samples/worlds.py --text | raydiff verify
import struct, sys

CULL_DISABLE, FLIP, FORCE_OPAQUE, FORCE_NO_OPAQUE = 1, 2, 4, 8  # flags of instances
OPAQUE, NO_OPAQUE, FIRST, CULL_BACK, CULL_FRONT = 1, 2, 4, 0x10, 0x20  # flags of rays
CULL_OPAQUE, CULL_NO_OPAQUE, SKIP_TRIANGLES = 0x40, 0x80, 0x100
NONE = 0xFFFFFFFF

def dot(a, b): return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def minus(a, b): return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
def cross(a, b): return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]
def place(m, p): return [dot(m[4 * k:4 * k + 3], p) + m[4 * k + 3] for k in range(3)]

def passes(rule, numbers, u, v):
    """Whether the filter lets a hit count on a triangle that is not opaque."""
    kind, seed, share = rule
    if kind < 2:
        return kind == 0
    cells = [min(max(int(x * 4), 0), 3) for x in (u, v)]
    hash = seed
    for number in numbers + ([cells[0] * 4 + cells[1]] if kind == 3 else []):
        hash ^= number
        hash = (hash ^ hash >> 16) * 0x85EBCA6B & NONE
        hash = (hash ^ hash >> 13) * 0xC2B2AE35 & NONE
        hash ^= hash >> 16
    return hash & 255 < share

class World:
    def __init__(self, rule, meshes, instances):
        """meshes: (vertices, triangles, geometries); instances: (mesh, custom, mask, flags, M and T)"""
        self.rule, self.placed = rule, []
        for number, (mesh, custom, mask, flags, m) in enumerate(instances):
            vertices, triangles, geometries = meshes[mesh] if mesh != NONE else ([], [], [])
            det = dot(m[0:3], cross(m[4:7], m[8:11]))
            at, first, listed = [place(m, p) for p in vertices], 0, []
            for g, (count, opaque) in enumerate(geometries):
                for t in range(count):
                    a, b, c = [at[k] for k in triangles[first + t]]
                    listed.append(([number, g, t], opaque, a, minus(b, a), minus(c, a)))
                first += count
            self.placed.append((mask, flags, det, custom, listed))

    def trace(self, query, ray):
        """The hit: t, u, v, instance, geometry, triangle, 1 if the front is seen, custom index; or None"""
        origin, tmin, direction, tmax, seen, flags = ray[0:3], ray[3], ray[4:7], ray[7], ray[8], ray[9]
        best = None
        for mask, how, mirror, custom, triangles in self.placed:
            if not mask & seen or flags & SKIP_TRIANGLES:
                continue
            for numbers, opaque, a, e1, e2 in triangles:
                p, s = cross(direction, e2), minus(origin, a)
                det, q = dot(e1, p), cross(s, e1)  # Moeller and Trumbore 1997
                if det == 0:
                    continue
                t, u, v = dot(e2, q) / det, dot(s, p) / det, dot(direction, q) / det
                if u < 0 or v < 0 or u + v > 1 or not tmin <= t <= tmax or best and t >= best[0]:
                    continue
                if how & (FORCE_OPAQUE | FORCE_NO_OPAQUE):
                    opaque = how & FORCE_OPAQUE
                if flags & (OPAQUE | NO_OPAQUE):
                    opaque = flags & OPAQUE
                front = (det * mirror > 0) != (how & FLIP != 0)
                if flags & (CULL_OPAQUE if opaque else CULL_NO_OPAQUE):
                    continue
                if flags & (CULL_FRONT if front else CULL_BACK) and not how & CULL_DISABLE:
                    continue
                if not opaque and not passes(self.rule, numbers, u, v):
                    continue
                best = [t, u, v, *numbers, int(front), custom]
                if query or flags & FIRST:
                    return best
        return best

def pipe():  # version 2 of the protocol, in words of 32 bits
    def take(form, count=1):
        return list(struct.iter_unpack('<' + form, sys.stdin.buffer.read(struct.calcsize('<' + form) * count)))
    while head := sys.stdin.buffer.read(32):
        magic, version, query, meshes, instances, rays, same, zero = struct.unpack('<4s7I', head)
        refused = b''
        if version == 1 and (meshes or rays):
            refused = b'this tracer takes worlds alone'
            sys.stdin.buffer.read((not same) * 12 * (meshes + instances) + 32 * rays)
        if version == 2 and not same:
            rule, made = take('3I4x')[0], []
            for i in range(meshes):
                vertices, triangles, geometries = take('3I4x')[0]
                made.append((take('3f', vertices), take('3I', triangles), take('2I8x', geometries)))
            world = World(rule, made, [(*i[:4], i[4:]) for i in take('4I12f', instances)])
        out = struct.pack('<4s7I', b'RDRA', version, bool(refused), len(refused) or rays, 0, 0, 8, 0) + refused
        for ray in take('8f2I', rays) if version == 2 else []:
            out += struct.pack('<3f5I', *(world.trace(query, ray) or (0, 0, 0, NONE, 0, 0, 0, 0)))
        sys.stdout.buffer.write(out)
        sys.stdout.buffer.flush()

def text():  # the same as lines
    def number(word):  # of 32 bits: a decimal is the nearest of them
        x = float('nan') if word[:3] == 'nan' else float.fromhex(word) if 'x' in word else float(word)
        return struct.unpack('f', struct.pack('f', x))[0]
    meshes, instances, world, query, rule = [], [], None, 0, (0, 0, 0)
    for line in sys.stdin:
        kind, *word = line.split()
        if kind == 'raydiff' and word != ['2']:
            return print('refused this tracer takes worlds alone')
        if kind in ('raydiff', 'from'):
            print(line, end='')
        elif kind == 'query':
            query = word[0] == 'any'
        elif kind == 'filter':
            rule = ['all', 'none', 'triangles', 'cells'].index(word[0]), int(word[1]), int(word[2])
        elif kind == 'mesh':
            meshes.append(([], [], []))
        elif kind == 'v':
            meshes[-1][0].append([number(x) for x in word])
        elif kind == 't':
            meshes[-1][1].append([int(x) for x in word])
        elif kind == 'g':
            meshes[-1][2].append((int(word[0]), word[1] == 'opaque'))
        elif kind == 'i':
            mesh = NONE if word[0] == '-' else int(word[0])
            instances.append((mesh, *map(int, word[1:4]), [number(x) for x in word[4:]]))
        elif kind == 'r':
            world = world or World(rule, meshes, instances)
            hit = world.trace(query, [number(x) for x in word[:8]] + [int(x) for x in word[8:]])
            print('h %r %r %r %d %d %d %s %d' % (*hit[:6], 'front' if hit[6] else 'back', hit[7]) if hit else 'm')

text() if '--text' in sys.argv else pipe()
