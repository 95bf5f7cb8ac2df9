/* A tracer for `--engine pipe:` that refuses: refuser MOST answers scenes of at most MOST
 * triangles, every ray with a miss, and refuses all others; -1 refuses even the first request, of
 * no triangles. refuser rays takes every scene and refuses every request with rays. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    char magic[4];
    uint32_t version, query, vertices, triangles, rays, same, zero;
};
struct answer {
    char magic[4];
    uint32_t version, refused, count, formula, rounding, flags, zero;
};

static int skip(uint64_t bytes)
{
    for (; bytes > 0; bytes--)
        if (getchar() == EOF)
            return 0;
    return 1;
}

int main(int argc, char **argv)
{
    static const char why[] = "only teapots";
    const int rays = argc > 1 && strcmp(argv[1], "rays") == 0;
    const long most = argc > 1 && !rays ? strtol(argv[1], NULL, 10) : -1;
    struct request q;
    while (fread(&q, sizeof q, 1, stdin) == 1) {
        uint64_t scene = 12 * ((uint64_t)q.vertices + q.triangles);
        int refuse = rays ? q.rays > 0 : (long)q.triangles > most;
        if (!skip((q.same ? 0 : scene) + 32 * (uint64_t)q.rays))
            return 1;
        struct answer head = {"RDRA", 1, (uint32_t)refuse, q.rays, 1, 0, 0, 0};
        const uint32_t miss[4] = {0, 0, 0, 0xFFFFFFFFu};
        if (refuse)
            head.count = sizeof why - 1;
        fwrite(&head, sizeof head, 1, stdout);
        if (refuse)
            fwrite(why, 1, sizeof why - 1, stdout);
        for (uint32_t i = 0; i < q.rays && !refuse; i++)
            fwrite(miss, sizeof miss, 1, stdout);
        fflush(stdout);
    }
    return 0;
}
