#include "../../include/edmlift/angles.h"
