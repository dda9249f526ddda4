// Whether OpenEXR compresses on one thread or on several.
#pragma once

namespace dapple {

/// Threads that OpenEXR may use besides the caller's, in the whole process; 0, the default: none.
/// For programs, not for libraries in somebody else's. Files are the same whatever the number.
void use_exr_threads(int count);

}  // namespace dapple
