#include "../lib/optional/angles_q.c"
