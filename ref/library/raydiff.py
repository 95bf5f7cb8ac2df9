"""Is what a ray tracer answers right? Exact answers and verdicts, by libraydiff (docs/library.md).

    import raydiff
    rays = raydiff.hard_rays(vertices, indices, 10000)
    judged = raydiff.judge(vertices, indices, rays, (t, u, v, triangle))
    assert judged.faults == 0, judged.reasons()

Needs numpy and the shared library, and compiles nothing. The library is the file that RAYDIFF_LIBRARY
names, else the one installed or built beside this module, else the one that the system finds.

Shapes, for n vertices, m triangles and k rays:
    vertices   (n, 3) float32, finite
    indices    (m, 3) integers below n
    rays       (k, 8) float32: ox oy oz tmin dx dy dz tmax; or a pair of (k, 3) arrays, origins and
               directions, for 0 <= t <= inf. t counts in multiples of the direction
    hits       (t, u, v, triangle), four arrays of k: u weighs the triangle's second vertex, v its third; a
               miss is triangle -1. Or one array of dtype ANSWER, where it is NOTHING
Vertices and rays of float64 are taken if float32 holds them exactly: else a tracer and its judge would
look at different triangles. t, u and v are rounded to float32.

What breaks a rule raises Error with the line of the library.
"""
import ctypes
import os

import numpy as np

ABI = 1
NOTHING = 0xFFFFFFFF

ANSWER = np.dtype([('t', 'f4'), ('u', 'f4'), ('v', 'f4'), ('triangle', 'u4')])
EXACT = np.dtype([('triangle', 'u4'), ('ties', 'u4'), ('kind', 'u4'), ('refused', 'u4'),
                  ('t_lo', 'f8'), ('t_hi', 'f8'), ('t_next', 'f8')])
CROSSING = np.dtype([('triangle', 'u4'), ('kind', 'u4'), ('t_lo', 'f8'), ('t_hi', 'f8')])
JUDGED = np.dtype([('verdict', 'u4'), ('fault', 'u4'), ('expected', 'u4'), ('lost', 'u4'),
                   ('t_lo', 'f8'), ('t_hi', 'f8'), ('over', 'f8'), ('displacement', 'f8')])


class Error(ValueError):
    """A function of the library failed. str(error) is its line, error.kind one of KINDS."""

    KINDS = ('none', 'memory', 'input', 'limit', 'unsupported', 'stopped', 'internal')

    def __init__(self, line, kind='input'):
        super().__init__(line)
        self.kind = kind


class _Why(ctypes.Structure):
    _fields_ = [('line', ctypes.c_char * 320)]


class _Judging(ctypes.Structure):
    _fields_ = [('formula', ctypes.c_char_p), ('rounding', ctypes.c_char_p), ('mask', ctypes.c_void_p),
                ('displacement', ctypes.c_float), ('any', ctypes.c_bool), ('open', ctypes.c_bool),
                ('watertight', ctypes.c_bool), ('unnamed', ctypes.c_bool),
                ('demand_watertight', ctypes.c_bool)]


class _Counts(ctypes.Structure):
    _fields_ = [('answers', ctypes.c_uint64), ('hits', ctypes.c_uint64),
                ('verdict', ctypes.c_uint64 * 10), ('fault', ctypes.c_uint64 * 16),
                ('beside_edges', ctypes.c_uint64), ('in_fans', ctypes.c_uint64),
                ('faults', ctypes.c_uint64), ('over', ctypes.c_double),
                ('displacement', ctypes.c_double), ('vacuous', ctypes.c_bool)]


class _Faults(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint32) for name in (
        'loose_boxes', 'bad_references', 'cycles', 'lost_triangles', 'double_triangles',
        'bad_triangles', 'too_deep', 'bad_vertices')]


class _Mesh(ctypes.Structure):
    _fields_ = [('vertex', ctypes.c_void_p), ('index', ctypes.c_void_p),
                ('vertex_count', ctypes.c_uint32), ('triangle_count', ctypes.c_uint32)]


_INSTANCE = np.dtype([('transform', 'f4', 12), ('mesh', 'u4'), ('mask', 'u4')])


class _Case(ctypes.Structure):
    _fields_ = [('vertex', ctypes.POINTER(ctypes.c_float)),
                ('index', ctypes.POINTER(ctypes.c_uint32)), ('vertex_count', ctypes.c_uint32),
                ('triangle_count', ctypes.c_uint32), ('ray', ctypes.POINTER(ctypes.c_float))]


_FAILS = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(_Case))
_POINTER, _SIZE, _U32, _U64 = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint64
_TEXT = ctypes.c_char_p


def _open():
    name = 'libraydiff.so.%d' % ABI
    here = os.path.dirname(os.path.realpath(__file__))
    named = os.environ.get('RAYDIFF_LIBRARY')
    beside = [os.path.join(here, *place, name) for place in (
        ('..', '..', '..', 'lib'), ('..', '..', 'build', 'shared'))]
    path = named or next((path for path in beside if os.path.exists(path)), name)
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise ImportError('raydiff: %s; RAYDIFF_LIBRARY may name it' % error) from None
    functions = {
        'version': (_U32, ()),
        'class_name': (_TEXT, (_U32,)),
        'verdict_name': (_TEXT, (_U32,)),
        'fault_name': (_TEXT, (_U32,)),
        'rays_name': (_TEXT, (_U32,)),
        'oracle_make': (_U32, (_POINTER, _U32, _POINTER, _U32, _POINTER, _POINTER)),
        'oracle_free': (None, (_POINTER,)),
        'oracle_make_world': (_U32, (_POINTER, _U32, _POINTER, _U32, _POINTER, _POINTER)),
        'placed': (_U32, (_POINTER, _U32, _POINTER, _POINTER, _POINTER)),
        'first_of': (_U32, (_POINTER, _U32)),
        'exact': (_U32, (_POINTER, _POINTER, _POINTER, _SIZE, _U32, _POINTER, _POINTER)),
        'exact_all': (_U32, (_POINTER, _POINTER, _SIZE, _POINTER, _POINTER, _POINTER)),
        'exact_text': (_U32, (_POINTER, _POINTER, _U32, _TEXT, _SIZE, _POINTER)),
        'judge': (_U32, (_POINTER, _POINTER, _POINTER, _POINTER, _SIZE, _U32, _POINTER, _POINTER,
                         _POINTER)),
        'reason': (_U32, (_POINTER, _POINTER, _POINTER, _POINTER, _TEXT, _POINTER)),
        'check_tree': (_U32, (_POINTER, _TEXT, _SIZE, _POINTER, _POINTER)),
        'hard_rays': (_U32, (_POINTER, _TEXT, _U64, _SIZE, _POINTER, _POINTER)),
        'shrink': (_U32, (_POINTER, _FAILS, _POINTER, _U64, _POINTER, _POINTER)),
        'small_case': (_Case, (_POINTER,)),
        'small_free': (None, (_POINTER,)),
    }
    for name, (result, arguments) in functions.items():
        function = getattr(library, 'raydiff_' + name)
        function.restype, function.argtypes = result, arguments
    return library


_library = _open()


def _call(name, *arguments):
    """Calls a function that can fail. Returns the line of one that has something to add."""
    why = _Why()
    error = getattr(_library, 'raydiff_' + name)(*arguments, ctypes.byref(why))
    if error == Error.KINDS.index('memory'):
        raise MemoryError(why.line.decode())
    if error:
        raise Error(why.line.decode(), Error.KINDS[error])
    return why.line.decode()


def _names(function):
    names = []
    while (name := getattr(_library, function)(len(names))) is not None:
        names.append(name.decode())
    return tuple(names)


VERDICTS = _names('raydiff_verdict_name')
FAULTS = _names('raydiff_fault_name')
CLASSES = _names('raydiff_class_name')
RAYS = _names('raydiff_rays_name')


def version():
    """The version of the library, such as (0, 2, 0)."""
    number = _library.raydiff_version()
    return number >> 16, number >> 8 & 0xFF, number & 0xFF


def _floats(what, values, columns):
    given = np.asarray(values)
    out = np.ascontiguousarray(given, dtype=np.float32)
    if given.dtype != np.float32 and not np.array_equal(out, given, equal_nan=True):
        raise Error('%s: has numbers that float32 does not hold; round them before the tracer sees '
                    'them, too: .astype(numpy.float32)' % what)
    if out.ndim != 2 or out.shape[1] != columns:
        raise Error('%s: shape %s is not (n, %d)' % (what, given.shape, columns))
    return out


def _whole(what, values, least, most):
    given = np.asarray(values)
    if given.size and (given.dtype.kind not in 'iu' or given.min() < least or given.max() > most):
        raise Error('%s: not whole numbers from %d to %d' % (what, least, most))
    return np.ascontiguousarray(given.astype(np.uint32))


def _rays(rays):
    if isinstance(rays, (tuple, list)) and len(rays) == 2 and np.ndim(rays[0]) == 2:
        origins, directions = _floats('origins', rays[0], 3), _floats('directions', rays[1], 3)
        if len(origins) != len(directions):
            raise Error('rays: %d origins, %d directions' % (len(origins), len(directions)))
        whole = np.zeros((len(origins), 8), np.float32)
        whole[:, 0:3], whole[:, 4:7], whole[:, 7] = origins, directions, np.inf
        return whole
    return _floats('rays', rays, 8)


def _answers(hits, count):
    if isinstance(hits, np.ndarray) and hits.dtype == ANSWER:
        out = np.ascontiguousarray(hits)
    else:
        t, u, v, triangle = hits
        triangle = _whole('hits: triangles', triangle, -1, NOTHING)
        out = np.zeros(count, ANSWER)
        for name, values in zip(ANSWER.names, (t, u, v, triangle)):
            if np.shape(values) != (count,):
                raise Error('hits: %s has shape %s, for %d rays' % (name, np.shape(values), count))
            with np.errstate(over='ignore'): # too large for float32 is infinite, which is judged
                out[name] = values
    if out.shape != (count,):
        raise Error('hits: shape %s, for %d rays' % (out.shape, count))
    return out


def _masks(masks, count):
    """An array that must live during the call, and its address."""
    if masks is None:
        return None, None
    masks = _whole('masks', masks, 0, 255)
    if masks.shape != (count,):
        raise Error('masks: shape %s, for %d rays' % (masks.shape, count))
    return masks, masks.ctypes.data


def _how(query='closest', formula=None, rounding=None, displacement=0.0, open=False,
         watertight=False, unnamed=False, demand_watertight=False):
    if query not in ('closest', 'any'):
        raise Error("query: '%s' is neither closest nor any" % query)
    return _Judging(formula and formula.encode(), rounding and rounding.encode(), None, displacement,
                    query == 'any', open, watertight, unnamed, demand_watertight)


class Judged:
    """The verdicts on answers.

    records   array of dtype JUDGED, one per answer; its columns are attributes, too: verdict and fault
              (numbers of VERDICTS and FAULTS), expected, lost, t_lo, t_hi, over, displacement
    faults    how many are at fault; 0 if the tracer is right
    counts    dict: of each verdict and kind of fault that there is, and of what else `faults` has
    vacuous   no fault, but too few hits to prove anything
    """

    def __init__(self, records, counts, reason):
        self.records = records
        self.faults = counts.faults
        self.hits = counts.hits
        self.vacuous = counts.vacuous
        self.counts = {name: number for names, numbers in (
            (VERDICTS, counts.verdict), (FAULTS, counts.fault),
            (('beside_edges', 'in_fans'), (counts.beside_edges, counts.in_fans)))
            for name, number in zip(names, numbers) if number}
        self._reason = reason

    def __getattr__(self, name):
        if name not in JUDGED.names:
            raise AttributeError(name)
        return self.records[name]

    def __len__(self):
        return len(self.records)

    @property
    def wrong(self):
        """Numbers of the answers that are wrong."""
        return np.flatnonzero(self.records['verdict'] == VERDICTS.index('wrong'))

    def reason(self, number):
        """The line on one answer: verdict, ray, answer, what is expected."""
        return self._reason(number)

    def reasons(self, most=3):
        """Lines on the first wrong answers."""
        lines = ['ray %d: %s' % (i, self.reason(i)) for i in self.wrong[:most]]
        return '\n'.join(['%d faults: %s' % (self.faults, self.counts)] + lines)


class Scene:
    """Triangles, decided exactly. They are copied."""

    def __init__(self, vertices, indices):
        self._oracle = None
        vertices = _floats('vertices', vertices, 3)
        indices = _whole('indices', indices, 0, NOTHING)
        if indices.ndim != 2 or indices.shape[1] != 3:
            raise Error('indices: shape %s is not (m, 3)' % (indices.shape,))
        oracle = ctypes.c_void_p()
        _call('oracle_make', vertices.ctypes.data, len(vertices), indices.ctypes.data, len(indices),
              ctypes.byref(oracle))
        self._oracle = oracle

    def close(self):
        """Frees the memory; the scene cannot be used any more."""
        if self._oracle:
            _library.raydiff_oracle_free(self._oracle)
        self._oracle = None

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def __del__(self):
        if _library is not None: # else the interpreter is ending
            self.close()

    def exact(self, rays, threads=0, masks=None):
        """The nearest hits: an array of dtype EXACT. threads 0: all. masks: of rays in a World."""
        rays = _rays(rays)
        out, (kept, mask) = np.empty(len(rays), EXACT), _masks(masks, len(rays))
        _call('exact', self._oracle, rays.ctypes.data, mask, len(rays), threads, out.ctypes.data)
        return out

    def exact_all(self, ray):
        """Every triangle that one ray of 8 numbers meets, by t: an array of dtype CROSSING."""
        ray = _rays([ray])
        found, out = ctypes.c_size_t(0), np.empty(0, CROSSING)
        while True:
            _call('exact_all', self._oracle, ray.ctypes.data, len(out), out.ctypes.data,
                  ctypes.byref(found))
            if found.value <= len(out):
                return out
            out = np.empty(found.value, CROSSING)

    def exact_text(self, ray, triangle):
        """The exact t of a triangle that the ray hits, as a fraction: '1/3'."""
        ray, text = _rays([ray]), ctypes.create_string_buffer(2048)
        _call('exact_text', self._oracle, ray.ctypes.data, triangle, text, len(text))
        return text.value.decode()

    def judge(self, rays, hits, threads=0, masks=None, **how):
        """Judges answers: a Judged. threads 0: all. What may be stated of the tracer:
            query         'closest' or 'any'
            formula       'unknown', 'mt', 'woop', 'embree', 'embree_robust', 'pluecker',
                          'baldwin_webber', 'tri_accel'
            rounding      of a known formula: 'ieee', 'flushed', 'vulkan', 'vulkan_rte', 'embree'
            displacement  of an unknown one, see raydiff.h
            open, watertight, unnamed, demand_watertight   booleans, see raydiff.h
        masks: of rays in a World.
        """
        how, rays = _how(**how), _rays(rays)
        answers, (kept, how.mask) = _answers(hits, len(rays)), _masks(masks, len(rays))
        records, counts = np.empty(len(rays), JUDGED), _Counts()
        _call('judge', self._oracle, ctypes.byref(how), rays.ctypes.data, answers.ctypes.data,
              len(rays), threads, records.ctypes.data, ctypes.byref(counts))
        return Judged(records, counts, lambda i: self._reason(
            how, rays[i], answers[i:][:1], None if kept is None else kept[i:][:1]))

    def _reason(self, how, ray, answer, mask):
        text = ctypes.create_string_buffer(512)
        how.mask = None if mask is None else mask.ctypes.data
        _call('reason', self._oracle, ctypes.byref(how), ray.ctypes.data, answer.ctypes.data, text)
        return text.value.decode()

    def hard_rays(self, count, set='mixed', seed=1):
        """Rays that are hard for this scene, a (count, 8) array. set: one of RAYS."""
        rays = np.empty((count, 8), np.float32)
        _call('hard_rays', self._oracle, set.encode(), seed, count, rays.ctypes.data)
        return rays

    def check_tree(self, bytes):
        """Checks a packed tree of raydiff. Returns a dict of its faults, empty if it is sound."""
        faults = _Faults()
        line = _call('check_tree', self._oracle, bytes, len(bytes), ctypes.byref(faults))
        out = {name: getattr(faults, name) for name, _ in _Faults._fields_ if getattr(faults, name)}
        return dict(out, first=line) if line else out


class World(Scene):
    """Meshes, placed by instances; they are copied. Everything that a Scene has, but check_tree.
        meshes     list of (vertices, indices)
        instances  list of (mesh, transform, mask): the mesh' number in the list, 3 rows of 4 numbers that
                   float32 holds, and 8 bits; a ray meets it whose own mask has a bit in common
    Triangle k of instance i has number first[i] + k in what is answered and expected. There is no
    formula: transforms are the tracer's own."""

    def __init__(self, meshes, instances):
        self._oracle = None
        arrays = [(_floats('vertices', v, 3), _whole('indices', i, 0, NOTHING)) for v, i in meshes]
        for number, (_, indices) in enumerate(arrays):
            if indices.ndim != 2 or indices.shape[1] != 3:
                raise Error('mesh %d: indices: shape %s is not (m, 3)' % (number, indices.shape))
        mesh = (_Mesh * len(arrays))(*(
            _Mesh(v.ctypes.data, i.ctypes.data, len(v), len(i)) for v, i in arrays))
        placed = np.zeros(len(instances), _INSTANCE)
        for number, (which, transform, mask) in enumerate(instances):
            rows = _floats('instance %d: transform' % number, transform, 4)
            if rows.shape != (3, 4):
                raise Error('instance %d: transform: shape %s is not (3, 4)' % (number, rows.shape))
            placed[number] = (rows.ravel(), which, mask)
        oracle = ctypes.c_void_p()
        _call('oracle_make_world', mesh, len(arrays), placed.ctypes.data, len(placed),
              ctypes.byref(oracle))
        self._oracle = oracle
        self.first = np.array([_library.raydiff_first_of(oracle, i) for i in range(len(placed) + 1)])

    def placed(self, numbers):
        """Instances, and triangles of their meshes, of triangles of the world: two arrays."""
        numbers = np.asarray(numbers)
        instance = np.searchsorted(self.first, numbers, side='right') - 1
        return instance, numbers - self.first[instance]


def judge(vertices, indices, rays, hits, threads=0, **how):
    """Judges the answers of a tracer to rays into triangles: see Scene.judge."""
    return Scene(vertices, indices).judge(rays, hits, threads, **how)


def hard_rays(vertices, indices, count, set='mixed', seed=1):
    """Rays that are hard for these triangles: see Scene.hard_rays."""
    with Scene(vertices, indices) as scene:
        return scene.hard_rays(count, set, seed)


def _arrays(case):
    def copy(pointer, count, columns):
        if not count:
            return np.empty((0, columns), pointer._type_)
        return np.ctypeslib.as_array(pointer, (count, columns)).copy()
    return (copy(case.vertex, case.vertex_count, 3), copy(case.index, case.triangle_count, 3),
            copy(case.ray, 1, 8)[0])


def shrink(vertices, indices, ray, fails, calls=0):
    """The smallest triangles and ray for which fails(vertices, indices, ray) is still true: a tuple
    of the three. calls: the most calls, 0: 100000. An exception in `fails` ends it and is raised."""
    vertices = _floats('vertices', vertices, 3)
    indices = _whole('indices', indices, 0, NOTHING)
    ray = _rays([ray])
    raised = []

    def ask(_, case):
        try:
            return 1 if fails(*_arrays(case.contents)) else 0
        except BaseException as error: # whatever it is, it must not cross C
            raised.append(error)
            return -1

    def pointer(array, kind):
        return array.ctypes.data_as(ctypes.POINTER(kind))
    case = _Case(pointer(vertices, ctypes.c_float), pointer(indices, ctypes.c_uint32),
                 len(vertices), len(indices), pointer(ray, ctypes.c_float))
    small = ctypes.c_void_p()
    try:
        _call('shrink', ctypes.byref(case), _FAILS(ask), None, calls, ctypes.byref(small))
    except Error:
        if raised:
            raise raised[0] from None
        raise
    out = _arrays(_library.raydiff_small_case(small))
    _library.raydiff_small_free(small)
    return out
