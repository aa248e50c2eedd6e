#include "../lib/joints/status.c"
