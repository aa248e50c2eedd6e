#include "../lib/number/fixed.c"
