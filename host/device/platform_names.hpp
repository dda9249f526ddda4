// Names of OpenCL platforms, as in DeviceInfo::platform, that dapple treats in a way of their own.
#pragma once

namespace dapple {

inline constexpr const char* kPoclPlatform = "Portable Computing Language";
inline constexpr const char* kMesaPlatform = "rusticl";

}  // namespace dapple
