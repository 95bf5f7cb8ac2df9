static void print_hit(const struct hit *hit)
{
    if (hit->prim == MISS)
        printf("a miss");
    else if (UNNAMED)
        printf("a hit");
    else
        printf("triangle %" PRIu32 " at t = %a (%.9g), u = %a (%.9g), v = %a (%.9g)", hit->prim,
               (double)hit->t, (double)hit->t, (double)hit->u, (double)hit->u, (double)hit->v,
               (double)hit->v);
}

static void print_ray(uint32_t i)
{
    struct ray ray;
    memcpy(&ray, rays[i], sizeof ray);
    printf("ray %" PRIu32 ": from %.9g %.9g %.9g along %.9g %.9g %.9g, t in [%.9g, %.9g]\n", i,
           (double)ray.org[0], (double)ray.org[1], (double)ray.org[2], (double)ray.dir[0],
           (double)ray.dir[1], (double)ray.dir[2], (double)ray.tmin, (double)ray.tmax);
}

static void print_interval(const char *name, const float x[2])
{
    if (x[0] <= -FLT_MAX && x[1] >= FLT_MAX)
        printf(", any %s", name);
    else
        printf(", %s in [%.9g, %.9g]", name, (double)x[0], (double)x[1]);
}

static void print_right(uint32_t i)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < RIGHTS; k++) {
        if (rights[k].ray != i)
            continue;
        printf("  %-11s", count++ ? "or" : "right is");
        if (rights[k].prim == MISS || UNNAMED) {
            puts(rights[k].prim == MISS ? "a miss" : "a hit");
            continue;
        }
        printf("triangle %" PRIu32, rights[k].prim);
        print_interval("t", rights[k].t);
#if EXPORT_FOLLOWED
        puts(", u and v of the ray's point there");
#else
        print_interval("u", rights[k].u);
        print_interval("v", rights[k].v);
        puts("");
#endif
    }
    if (!count)
        puts("  any answer is right");
}

static int is_within(float x, const float interval[2])
{
    return x >= interval[0] && x <= interval[1];
}

#if EXPORT_FOLLOWED
/* u and v weigh a place on the ray's line, but for 2^-14 of the triangle's distance. */
static int is_there(uint32_t i, const struct hit *hit)
{
    struct ray ray;
    double most = 0, apart = 0, along = 0, squared = 0, place[3];
    memcpy(&ray, rays[i], sizeof ray);
    for (int c = 0; c < 3; c++) {
        double length = 0;
        for (int k = 0; k < 3; k++) {
            double v = (double)vertices[indices[hit->prim][c]][k] - (double)ray.org[k];
            length += v * v;
        }
        most = length > most ? length : most;
    }
    for (int k = 0; k < 3; k++) {
        double u = (double)hit->u, v = (double)hit->v, d = (double)ray.dir[k];
        place[k] = (1 - u - v) * (double)vertices[indices[hit->prim][0]][k] +
                   u * (double)vertices[indices[hit->prim][1]][k] +
                   v * (double)vertices[indices[hit->prim][2]][k] - (double)ray.org[k];
        along += place[k] * d;
        squared += d * d;
    }
    for (int k = 0; k < 3; k++) {
        double rest = place[k] - along / squared * (double)ray.dir[k];
        apart += rest * rest;
    }
    return apart <= most * 0x1p-28;
}

#endif
static int is_right(uint32_t i, const struct hit *hit)
{
    int judged = 0;
    for (uint32_t k = 0; k < RIGHTS; k++) {
        const struct right *right = &rights[k];
        if (right->ray != i)
            continue;
        judged = 1;
        if (right->prim == MISS && hit->prim == MISS)
            return 1;
        if (right->prim == hit->prim && is_within(hit->t, right->t) &&
            is_within(hit->u, right->u) && is_within(hit->v, right->v))
#if EXPORT_FOLLOWED
            return is_there(i, hit);
#else
            return 1;
#endif
    }
    return !judged;
}

/* Prints what was answered; 1 if it shows the bug. */
static int check_ray(uint32_t i, const struct hit *hit, int finished)
{
    int wrong = !finished || !is_right(i, hit);
#if EXPORT_REFERENCE
    int differs = finished && memcmp(hit, references[i], sizeof *hit) != 0;
    struct hit reference;
    memcpy(&reference, references[i], sizeof reference);
    if (BITS_MATTER && differs)
        wrong = 1;
#endif
    if (RAYS > PRINTED && !wrong)
        return 0;
    print_ray(i);
    print_right(i);
#if EXPORT_REFERENCE
    printf("  %-11s", "C answers");
    print_hit(&reference);
    puts("");
#endif
    printf("  %-11s", "here it is");
    if (finished)
        print_hit(hit);
    else
        printf("not finished");
#if EXPORT_REFERENCE
    printf(": %s%s\n", wrong ? "WRONG" : "right", differs ? ", not the bits of C" : "");
#else
    puts(wrong ? ": WRONG" : ": right");
#endif
    return wrong;
}

/* The exit code. finished[i] is 0 if ray i has no answer. */
static int check(const struct hit *hits, const unsigned char *finished)
{
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        wrong += (uint32_t)check_ray(i, &hits[i], finished[i]);
    printf("%" PRIu32 " of %u rays WRONG: %s\n", wrong, (unsigned)RAYS,
           wrong ? "the bug shows" : "every answer is right");
    return wrong ? 1 : 0;
}
