#include "../lib/network/model.c"
