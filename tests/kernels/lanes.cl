/* The functions of lanes.clh with the device's own built-ins; lanes_without_*.cl force the fallbacks. */
#include "lanes_of_patterns.h"
