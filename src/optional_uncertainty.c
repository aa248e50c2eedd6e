#include "../lib/optional/uncertainty.c"
