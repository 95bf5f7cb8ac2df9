/* No report: what the others spoil is right. */
#include "tests/reported/reported_tracer.h"
