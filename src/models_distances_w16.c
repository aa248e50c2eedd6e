#include "../lib/models/distances_w16.c"
