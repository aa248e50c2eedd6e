#include "../lib/optional/joint_limits_f32.c"
