#include "../lib/lift/lift_q.c"
