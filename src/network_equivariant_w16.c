#include "../lib/network/equivariant_w16.c"
