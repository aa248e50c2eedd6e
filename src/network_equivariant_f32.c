#include "../lib/network/equivariant_f32.c"
