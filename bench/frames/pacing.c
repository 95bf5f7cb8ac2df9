#include "bench/frames/pacing.h"

struct pacing pacing_make(double fps, uint64_t now_ns)
{
    if (!(fps > 0.0))
        fps = 60.0;
    if (fps > PACING_FPS_MOST)
        fps = PACING_FPS_MOST;
    return (struct pacing){.period_ns = 1e9 / fps, .last_ns = now_ns, .stale = true};
}

double pacing_tick(struct pacing *pacing, uint64_t now_ns)
{
    if (now_ns > pacing->last_ns)
        pacing->owed_ns += (double)(now_ns - pacing->last_ns);
    pacing->last_ns = now_ns;
    if (pacing->owed_ns < pacing->period_ns)
        return 0.0;
    double given = pacing->owed_ns;
    if (given > PACING_BEHIND_MOST * pacing->period_ns)
        given = pacing->period_ns;
    pacing->owed_ns = 0.0;
    return 1e-6 * given;
}

void pacing_touch(struct pacing *pacing)
{
    pacing->stale = true;
}

bool pacing_begin(struct pacing *pacing)
{
    if (!pacing->stale || pacing->in_flight)
        return false;
    pacing->stale = false;
    pacing->in_flight = true;
    pacing->frames++;
    return true;
}

void pacing_end(struct pacing *pacing)
{
    pacing->in_flight = false;
}

uint64_t pacing_idle_ns(const struct pacing *pacing, uint64_t now_ns)
{
    double owed = pacing->owed_ns;
    if (now_ns > pacing->last_ns)
        owed += (double)(now_ns - pacing->last_ns);
    return owed < pacing->period_ns ? (uint64_t)(pacing->period_ns - owed) : 0;
}
