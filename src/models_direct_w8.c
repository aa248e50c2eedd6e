#include "../lib/models/direct_w8.c"
