#include "../lib/optional/angle_names.c"
