/* lanes_of_patterns.h as the device's compiler sees it. */
#include "lanes_of_patterns.h"
