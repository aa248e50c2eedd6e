#include "../lib/joints/adapt_q.c"
