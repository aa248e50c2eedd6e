#include "../lib/lift/imputation.c"
