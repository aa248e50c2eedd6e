#include "../lib/network/equivariant_w8.c"
