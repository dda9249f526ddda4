/* lanes_of_patterns.h as compiled for devices without x86 builtins. */
#undef __AVX512DQ__
#undef __AVX__
#include "lanes_of_patterns.h"
