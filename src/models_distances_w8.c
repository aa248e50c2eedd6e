#include "../lib/models/distances_w8.c"
