#include "../../include/edmlift/fixed.h"
