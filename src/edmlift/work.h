#include "../../include/edmlift/work.h"
