#include "../lib/optional/joint_limits_q.c"
