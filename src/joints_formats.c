#include "../lib/joints/formats.c"
