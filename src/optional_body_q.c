#include "../lib/optional/body_q.c"
