#include "../lib/models/direct_w16.c"
