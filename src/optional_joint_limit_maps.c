#include "../lib/optional/joint_limit_maps.c"
