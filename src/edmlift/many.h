#include "../../include/edmlift/many.h"
