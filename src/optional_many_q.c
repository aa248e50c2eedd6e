#include "../lib/optional/many_q.c"
