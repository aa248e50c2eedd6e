#include "../lib/network/predict_q.c"
