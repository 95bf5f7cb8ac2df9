/* The twins of baldwin_webber (ref/primitives/tri_baldwin_webber.h) and of tri_accel
 * (ref/kd/accel.h), which has the same numbers of a triangle, but takes the ray's origin from the
 * plane's constant term by term, and multiplies by a reciprocal. For ref/twin/twin_steps.h, which
 * see.
 *
 * The transform is made of rounded numbers, and its last column is as large as the coordinates: its
 * errors are carried into the ray's height, t, the point, u and v like any others, so that the
 * bound grows with the distance from the world's origin as the error does. In truth part of it
 * cancels (vertex 0 goes to zero by the coefficients as rounded), which running errors do not see.
 *
 * Which axis c is projected along depends on computed components of the normal: where two are as
 * good as equal an evaluation may take either. In exact arithmetic t, u and v are the same by each,
 * so what is given is the widest bound among the axes that may be taken. */
#ifndef TWIN_BALDWIN_WEBBER_H
#define TWIN_BALDWIN_WEBBER_H

/* Row of u or v: from the edge that is 0 on it. */
STEP void transform_row(const struct rules *k, struct bounded by_a, struct bounded by_b,
                        struct bounded divisor, struct bounded va, struct bounded vb,
                        struct bounded row[3])
{
    row[0] = divide(k, by_a, divisor);
    row[1] = divide(k, by_b, divisor);
    row[2] = negate(add(k, mul(k, row[0], va), mul(k, row[1], vb)));
}

/* (row[0] a + row[1] b) + row[2] */
STEP struct bounded weight_of(const struct rules *k, const struct bounded row[3], struct bounded a,
                              struct bounded b)
{
    return add(k, add(k, mul(k, row[0], a), mul(k, row[1], b)), row[2]);
}

/* (p[c] + h[0] p[a]) + h[1] p[b]; *own: from the exact one of computed h. */
STEP struct bounded along_normal(const struct rules *k, const struct bounded h[2],
                                 const struct bounded p[3], int a, int b, int c, real *own)
{
    struct bounded first = mul(k, h[0], p[a]), second = mul(k, h[1], p[b]);
    struct bounded part = add(k, p[c], first), all = add(k, part, second);
    *own = own_of_product(k, h[0], p[a], first) + own_of_product(k, h[1], p[b], second) +
           own_of_sum(k, part) + own_of_sum(k, all);
    return all;
}

/* How far the plane lies above the origin: `last` less the origin's height. *own: from the exact
 * one of computed h and last. */
STEP struct bounded above_origin(const struct rules *k, const struct bounded h[2],
                                 struct bounded last, const struct bounded o[3], int a, int b,
                                 int c, bool accel, real *own)
{
    if (!accel) {
        struct bounded height = sub(k, along_normal(k, h, o, a, b, c, own), last);
        *own = *own + own_of_sum(k, height);
        return negate(height);
    }
    struct bounded first = mul(k, h[0], o[a]), second = mul(k, h[1], o[b]);
    struct bounded part = sub(k, last, o[c]), two = sub(k, part, first), all = sub(k, two, second);
    *own = own_of_product(k, h[0], o[a], first) + own_of_product(k, h[1], o[b], second) +
           own_of_sum(k, part) + own_of_sum(k, two) + own_of_sum(k, all);
    return all;
}

/* The formula if axis c is taken. det is 1 where the height changes for sure, else open: the
 * weights are positive inside, whichever way the triangle faces. */
FORMULA struct outcome along_axis(const struct rules *k, const struct input *in,
                                  const struct bounded e1[3], const struct bounded e2[3],
                                  const struct bounded n[3], int c, bool accel)
{
    int a = (c + 1) % 3, b = (c + 2) % 3;
    const struct bounded *v0 = in->v[0], *o = in->o, *d = in->d;
    struct bounded u[3], w[3], h[2], inverse = exact(EACH(1.0f));
    struct outcome out = {.band = ALL(0.0)};
    transform_row(k, e2[b], negate(e2[a]), n[c], v0[a], v0[b], u);
    transform_row(k, negate(e1[b]), e1[a], n[c], v0[a], v0[b], w);
    h[0] = divide(k, n[a], n[c]);
    h[1] = divide(k, n[b], n[c]);
    real own[3];
    struct bounded last = along_normal(k, h, v0, a, b, c, &own[0]);
    struct bounded top = above_origin(k, h, last, o, a, b, c, accel, &own[1]);
    struct bounded climb = along_normal(k, h, d, a, b, c, &own[2]);
    if (accel)
        inverse = divide(k, inverse, climb);
    out.t = accel ? mul(k, top, inverse) : divide(k, top, climb);
    struct bounded pa = add(k, o[a], mul(k, out.t, d[a]));
    struct bounded pb = add(k, o[b], mul(k, out.t, d[b]));
    out.u = out.edge[1] = weight_of(k, u, pa, pb);
    out.v = out.edge[2] = weight_of(k, w, pa, pb);
    out.edge[0] = compare(exact(EACH(1.0f)), add(k, out.u, out.v));
    /* top' - t climb' = -(h' - h) . (o + t d - v0) - h' . (o' - o + t (d' - d)), h_c being 1,
     * and own roundings. */
    real residual = own[0] + own[1] + size_of_t(out.t) * own[2] +
                    h[0].e * reach_of(sub(k, o[a], v0[a]), d[a], out.t) +
                    h[1].e * reach_of(sub(k, o[b], v0[b]), d[b], out.t);
    if (RAY_BOUNDED)
        residual = residual + most(h[0]) * point_off(o[a].e, d[a], out.t) +
                   most(h[1]) * point_off(o[b].e, d[b], out.t) + point_off(o[c].e, d[c], out.t);
    out.t_running = out.t.e;
    out.t = accel ? t_by_reciprocal(k, out.t, top, climb, inverse, residual)
                  : t_by_quotient(k, out.t, climb, residual);
    out.det = exact(EACH(1.0f));
    out.det.e = SELECT(LESS(climb.e, SIZE(climb.x)), ALL(0.0), ALL(INFINITY));
    return out;
}

/* The wider of two bounds, of lanes where `take` is true for the second; `chosen`: C's axis.
 */
STEP struct bounded wider(mask take, mask chosen, struct bounded a, struct bounded b)
{
    mask more = take & LESS(a.e, b.e);
    (void)chosen; /* of vectors */
    return (struct bounded){SELECT_EACH(chosen, b.v, a.v), SELECT(more, b.x, a.x),
                            SELECT(more, b.e, a.e)};
}

/* The largest component's axis, of C: c beats those before it and is not beaten by those after. */
STEP mask is_chosen(const struct bounded n[3], int c)
{
    real size[3];
    for (int i = 0; i < 3; i++)
        size[i] = SIZE(WIDEN(n[i].v));
    mask chosen = EQUAL(size[c], size[c]); /* also of NaN, no matter */
    for (int i = 0; i < 3; i++)
        if (i != c)
            chosen = chosen & (i < c ? LESS(size[i], size[c]) : NOT_ABOVE(size[i], size[c]));
    return chosen;
}

FORMULA struct outcome eval_baldwin_webber(const struct rules *k, const struct input *in,
                                           bool accel)
{
    struct bounded e1[3], e2[3], n[3];
    subtract(k, in->v[1], in->v[0], e1);
    subtract(k, in->v[2], in->v[0], e2);
    cross(k, e1, e2, n);
    const struct bounded none = {EACH(NAN), ALL(0.0), ALL(-1.0)};
    struct outcome out = {
        .edge = {none, none, none}, .det = none, .t = none, .u = none, .v = none, .band = ALL(0.0)};
    real least = SIZE(n[0].x) - n[0].e; /* of the largest component, whatever is computed */
    for (int c = 1; c < 3; c++)
        least = SELECT(LESS(least, SIZE(n[c].x) - n[c].e), SIZE(n[c].x) - n[c].e, least);
    for (int c = 0; c < 3; c++) {
        mask chosen = is_chosen(n, c);
        mask take = NOT_ABOVE(least, SIZE(n[c].x) + n[c].e);
        if (!ANY(take))
            continue;
        const struct outcome one = along_axis(k, in, e1, e2, n, c, accel);
        for (int i = 0; i < 3; i++)
            out.edge[i] = wider(take, chosen, out.edge[i], one.edge[i]);
        out.det = wider(take, chosen, out.det, one.det);
        out.t_running =
            SELECT(take & LESS(out.t_running, one.t_running), one.t_running, out.t_running);
        out.t = wider(take, chosen, out.t, one.t);
        out.u = wider(take, chosen, out.u, one.u);
        out.v = wider(take, chosen, out.v, one.v);
    }
    out.t.e = out.t.e + NEAR_SHARE * out.t_running; /* t.x may be of one axis and t of another */
    return out;
}

#endif
