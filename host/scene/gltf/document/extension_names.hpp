// Names of the glTF extensions that dapple does more with than ignore them (extensions.cpp).
#pragma once

namespace dapple::gltf::extension {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
inline constexpr const char* kInstanceFeatures = "EXT_instance_features";
inline constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
inline constexpr const char* kLights = "KHR_lights_punctual";
inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kQuantization = "KHR_mesh_quantization";
inline constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";
inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kUnlit = "KHR_materials_unlit";
inline constexpr const char* kVariants = "KHR_materials_variants";
inline constexpr const char* kWebp = "EXT_texture_webp";

}  // namespace dapple::gltf::extension
