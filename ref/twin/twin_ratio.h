/* t = T / D once more, by what its numerator and its denominator have in common. For
 * ref/twin/twin_steps.h, which see.
 *
 * Running errors take T and D for unrelated: from afar each is off by far more than their quotient,
 * since most of what is off in T is off in t D as well. Exactly T - t D = 0, so that for computed
 * T' and D' with the exact t T'/D' - t = (T' - t D') / D' and what is common cancels in the
 * residual T' - t D' before anything is estimated. Each formula says how large its residual may be;
 * own roundings are those of the operations that make T' and D' of what both share. Proofs:
 * docs/numerics.md, "The error of t again". */
#ifndef TWIN_RATIO_H
#define TWIN_RATIO_H

/* By what share of their bounds near values may be off, several of them together: 2^-28 each, the
 * roundings of two doubles, and twice that. */
#define NEAR_SHARE 0x1p-26

/* |a'| of every evaluation is at most this. */
STEP real most(struct bounded a)
{
    return SIZE(a.x) + a.e;
}

/* |fl(a' b') - a' b'| of any operands; r is mul(a, b). */
STEP real own_of_product(const struct rules *k, struct bounded a, struct bounded b,
                         struct bounded r)
{
    return k->mul * most(r) + k->tiny + k->flush * (most(a) + most(b) + k->flush);
}

/* |fl(a' + b') - (a' + b')| of any operands; r is add(a, b). */
STEP real own_of_sum(const struct rules *k, struct bounded r)
{
    return k->add * most(r) + 3.0 * k->flush;
}

/* As dot and dot_embree; *own is how far a computed one is from the exact one of computed a and b,
 * at most. */
STEP struct bounded dot_from(const struct rules *k, const struct bounded a[3],
                             const struct bounded b[3], bool back, real *own)
{
    struct bounded p[3];
    real sum = ALL(0.0);
    for (int i = 0; i < 3; i++) {
        p[i] = mul(k, a[i], b[i]);
        sum = sum + own_of_product(k, a[i], b[i], p[i]);
    }
    struct bounded part = back ? add(k, p[1], p[2]) : add(k, p[0], p[1]);
    struct bounded all = back ? add(k, p[0], part) : add(k, part, p[2]);
    *own = sum + own_of_sum(k, part) + own_of_sum(k, all);
    return all;
}

/* As cross; own[i] likewise. */
STEP void cross_from(const struct rules *k, const struct bounded a[3], const struct bounded b[3],
                     struct bounded out[3], real own[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        struct bounded p = mul(k, a[j], b[l]), q = mul(k, a[l], b[j]);
        out[i] = sub(k, p, q);
        own[i] = own_of_product(k, a[j], b[l], p) + own_of_product(k, a[l], b[j], q) +
                 own_of_sum(k, out[i]);
    }
}

/* |t| of the exact t, at most, given the running t. */
STEP real size_of_t(struct bounded t)
{
    return SIZE(t.x) + NEAR_SHARE * t.e;
}

/* |c + t d| of exact values, at most: how far the ray's point is from a vertex, c being the
 * difference of the origin and that. */
STEP real reach_of(struct bounded c, struct bounded d, struct bounded t)
{
    real reach = SIZE(c.x + t.x * d.x) + NEAR_SHARE * (c.e + SIZE(d.x) * t.e);
    if (RAY_BOUNDED)
        reach = reach + NEAR_SHARE * d.e * (SIZE(t.x) + t.e);
    return reach;
}

/* How far o' + t d' is from o + t d, at most, given how far o' is from o. */
STEP real point_off(real o_off, struct bounded d, struct bounded t)
{
    return RAY_BOUNDED ? o_off + size_of_t(t) * d.e : o_off;
}

/* The tighter of the running bound of t and `e`, which leaves out how far t.x is off. */
STEP struct bounded tighter(struct bounded t, real e)
{
    e = (e + NEAR_SHARE * t.e) * SLACK;
    mask better = LESS(e, t.e) & LESS(t.e, ALL(INFINITY));
    t.e = SELECT(better, e, t.e);
    return t;
}

/* |T'/D' - t| at most, of operands that may be flushed. Where that is not known the running bound
 * of the quotient is infinite. */
STEP real carried_of(const struct rules *k, struct bounded t, struct bounded bottom, real residual)
{
    real least = SIZE(bottom.x) - operand_error(k, bottom);
    return (residual + k->tiny + k->flush * (1.0 + size_of_t(t))) / least;
}

/* t is divide(T, D), bottom D. */
STEP struct bounded t_by_quotient(const struct rules *k, struct bounded t, struct bounded bottom,
                                  real residual)
{
    real carried = carried_of(k, t, bottom, residual);
    return tighter(t, carried + k->div * (size_of_t(t) + carried) + k->tiny);
}

/* t is mul(T, inverse), inverse divide(1, D). */
STEP struct bounded t_by_reciprocal(const struct rules *k, struct bounded t, struct bounded top,
                                    struct bounded bottom, struct bounded inverse, real residual)
{
    real carried = carried_of(k, t, bottom, residual), size = size_of_t(t);
    carried = carried + k->div * (size + carried) + most(top) * (k->tiny + k->flush) +
              k->flush * (most(inverse) + k->flush);
    return tighter(t, carried + k->mul * (size + carried) + k->tiny);
}

/* The residual where T = n . c and D = n . d share the normal n: n' . (c' - t d') and own
 * roundings. c - t d lies in the plane, at right angles to n, so that n' - n counts by the size of
 * the triangle and not by its distance. */
STEP real plane_residual(const struct bounded n[3], const struct bounded c[3],
                         const struct bounded d[3], struct bounded t, real own_top, real own_bottom)
{
    real residual = own_top + size_of_t(t) * own_bottom;
    for (int i = 0; i < 3; i++) {
        real reach = reach_of(c[i], negate(d[i]), t);
        residual = residual + n[i].e * reach + most(n[i]) * point_off(c[i].e, d[i], t);
    }
    return residual;
}

/* The parts of moeller_trumbore's t: T = e2 . q, q = s x e1; D = e1 . p, p = d x e2. */
struct mt_parts {
    const struct bounded *e1, *e2, *s, *d;
    const real *own_p, *own_q;
    real own_top, own_bottom;
};

/* T' - t D' = (s' + t d') . (e1' x e2') + e2' . (own of q) - t e1' . (own of p) + own of T - t own
 * of D, and s + t d lies in the plane. */
STEP real mt_residual(const struct mt_parts *mt, struct bounded t)
{
    real size = size_of_t(t), residual = mt->own_top + size * mt->own_bottom;
    const struct bounded *e1 = mt->e1, *e2 = mt->e2;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        real n = SIZE(e1[j].x * e2[l].x - e1[l].x * e2[j].x);
        real off = SIZE(e1[j].x) * e2[l].e + most(e2[l]) * e1[j].e + SIZE(e1[l].x) * e2[j].e +
                   most(e2[j]) * e1[l].e; /* of computed edges' normal from the exact one */
        residual = residual + off * reach_of(mt->s[i], mt->d[i], t) +
                   point_off(mt->s[i].e, mt->d[i], t) * (n + off);
        residual = residual + most(e2[i]) * mt->own_q[i] + size * most(e1[i]) * mt->own_p[i];
    }
    return residual;
}

/* The parts of woop's t. own[c]: own rounding of edge c, of its computed places. */
struct woop_parts {
    const struct bounded *x, *y, *z, *depth, *edge; /* depth: along the axis, before the shear */
    struct bounded sx, sy, sz;
    real own[3], own_top, own_bottom;
};

/* With U' the exact edge functions of computed places, f = z - t and f' = z' - t:
 *     T' - t D' = sum U' f' + sum (own of edges) f' + own of T - t own of D
 * and sum U f = 0 is a determinant of the columns x, y, f: its change is, in x' - x, x . (f x y),
 * likewise in y, in f the edges themselves, and products of two changes. The depth's error moves x,
 * y and z of a vertex along the ray, and counts once. */
STEP real woop_residual(const struct woop_parts *w, struct bounded t)
{
    real size = size_of_t(t), residual = w->own_top + size * w->own_bottom;
    real f[3], far[3], off = NEAR_SHARE * t.e, edges = ALL(0.0);
    for (int c = 0; c < 3; c++) {
        f[c] = w->z[c].x - t.x;
        far[c] = SIZE(f[c]) + NEAR_SHARE * (w->z[c].e + t.e);
        off = off + NEAR_SHARE * w->z[c].e;
        edges = edges + w->edge[c].e;
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        const struct bounded *x = w->x, *y = w->y;
        real by_x = f[b] * y[a].x - f[a] * y[b].x, by_y = x[b].x * f[a] - x[a].x * f[b];
        real deep = w->depth[c].e, along = w->sz.x * w->edge[c].x - w->sx.x * by_x - w->sy.x * by_y;
        residual = residual + deep * SIZE(along) + SIZE(by_x) * (x[c].e - SIZE(w->sx.x) * deep) +
                   SIZE(by_y) * (y[c].e - SIZE(w->sy.x) * deep) +
                   (w->z[c].e - SIZE(w->sz.x) * deep) * most(w->edge[c]) +
                   SIZE(w->sz.x) * deep * w->edge[c].e + (far[c] + w->z[c].e) * w->own[c];
        residual = residual + far[c] * (x[a].e * y[b].e + y[a].e * x[b].e);
    }
    return residual + off * edges; /* what the near values above are off */
}

#endif
