#include "../lib/number/multiply_v6m.c"
