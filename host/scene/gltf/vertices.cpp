// Reads vertices: see vertices.hpp.
#include "scene/gltf/vertices.hpp"

#include <algorithm>
#include <cmath>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

constexpr std::initializer_list<Component> kFloatOrQuantized = {
    Component::float32, Component::int8, Component::uint8, Component::int16, Component::uint16};

AccessorReader read_positions(const Document& document, const tinygltf::Primitive& primitive,
                              const std::string& who) {
  const int accessor = attribute(primitive, "POSITION");
  require_type(document, accessor, who + " POSITION", {TINYGLTF_TYPE_VEC3}, kFloatOrQuantized);
  return {document, accessor};
}

std::optional<AccessorReader> read_normals(const Document& document,
                                           const tinygltf::Primitive& primitive,
                                           const std::string& who) {
  const int accessor = attribute(primitive, "NORMAL");
  if (accessor < 0) return {};
  require_type(document, accessor, who + " NORMAL", {TINYGLTF_TYPE_VEC3},
               {Component::float32, Component::int8, Component::int16});
  return AccessorReader(document, accessor);
}

V2f finite_or_zero(V2f uv) { return std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : V2f(0, 0); }

/// Zero, which stands for the normal of the face, for a vector without a direction.
V3f unit_or_zero(const Imath::V3d& normal) {
  const double length = normal.length();
  return length > 0 && std::isfinite(length) ? V3f(normal / length) : V3f(0, 0, 0);
}

/// Clamps to [0, 1]; NaN becomes 0.
float clamp_alpha(float alpha) { return alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f; }

}  // namespace

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

std::optional<AccessorReader> read_uvs(const Document& document,
                                       const tinygltf::Primitive& primitive, std::uint32_t set,
                                       const std::string& who) {
  const std::string name = fmt::format("TEXCOORD_{}", set);
  const int accessor = attribute(primitive, name);
  if (accessor < 0) return {};
  require_type(document, accessor, who + " " + name, {TINYGLTF_TYPE_VEC2}, kFloatOrQuantized);
  return AccessorReader(document, accessor);
}

std::optional<AccessorReader> read_colors(const Document& document,
                                          const tinygltf::Primitive& primitive,
                                          const std::string& who, std::uint64_t components) {
  const int accessor = attribute(primitive, "COLOR_0");
  if (accessor < 0) return {};
  require_type(document, accessor, who + " COLOR_0", {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4},
               {Component::float32, Component::uint8, Component::uint16});
  AccessorReader colors(document, accessor);
  if (colors.components() < components) return {};
  return colors;
}

Attributes read_attributes(const Document& document, const tinygltf::Primitive& primitive,
                           const AttributeNeeds& needs, const AlphaLookup& lookup,
                           const std::string& who) {
  Attributes attributes{read_positions(document, primitive, who), {}, {}, {}, {}, needs.uvs};
  if (needs.normals) attributes.normals = read_normals(document, primitive, who);
  if (needs.uvs)
    attributes.uvs =
        read_uvs(document, primitive, static_cast<std::uint32_t>(lookup.texcoord), who);
  if (needs.alphas) attributes.alphas = read_colors(document, primitive, who, 4);
  if (needs.colors) attributes.colors = read_colors(document, primitive, who, 3);
  return attributes;
}

std::optional<std::vector<std::uint32_t>> compact(std::vector<std::uint32_t>& corners,
                                                  std::uint64_t vertices) {
  std::vector<std::uint32_t> used;
  if (corners.size() < vertices) {  // memory of what is used, not of what is shared
    used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
  } else {
    std::vector<bool> is_used(vertices);
    for (const std::uint32_t corner : corners) is_used[corner] = true;
    if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return {};
    for (std::uint32_t v = 0; v < vertices; ++v)
      if (is_used[v]) used.push_back(v);
  }
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) -
                                        used.begin());
  }
  return used;
}

OddValues append_vertices(Mesh& mesh, const Attributes& attributes, const VertexDeformer& deformer,
                          const AlphaLookup& lookup,
                          const std::optional<std::vector<std::uint32_t>>& used) {
  OddValues odd;
  const std::size_t base = mesh.positions.size();
  const std::size_t count = used ? used->size() : attributes.positions.count();
  const auto source = [&](std::size_t i) -> std::uint64_t { return used ? (*used)[i] : i; };
  mesh.positions.resize(base + count);
  for (std::size_t i = 0; i < count; ++i) {
    mesh.positions[base + i] = deformer.position(attributes.positions.vec3(source(i)), source(i));
  }
  if (attributes.normals || !mesh.normals.empty()) mesh.normals.resize(base + count, V3f(0, 0, 0));
  if (attributes.normals) {
    for (std::size_t i = 0; i < count; ++i) {
      mesh.normals[base + i] =
          unit_or_zero(deformer.normal(attributes.normals->vec3(source(i)), source(i)));
    }
  }
  if (attributes.needs_uvs || !mesh.uvs.empty()) mesh.uvs.resize(base + count, V2f(0, 0));
  if (attributes.uvs) {
    for (std::size_t i = 0; i < count; ++i) {
      const V2f uv = lookup.apply(attributes.uvs->vec2(source(i)));
      mesh.uvs[base + i] = finite_or_zero(uv);
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) ++odd.texcoords;
    }
  }
  if (attributes.alphas || !mesh.vertex_alpha.empty()) mesh.vertex_alpha.resize(base + count, 1.0f);
  if (attributes.alphas) {
    for (std::size_t i = 0; i < count; ++i) {
      const float alpha = attributes.alphas->normalized(source(i), 3);
      mesh.vertex_alpha[base + i] = clamp_alpha(alpha);
      if (std::isnan(alpha)) ++odd.alphas;
    }
  }
  if (attributes.colors || !mesh.colors.empty()) mesh.colors.resize(base + count, V3f(1, 1, 1));
  if (attributes.colors) {
    for (std::size_t i = 0; i < count; ++i) {
      for (int channel = 0; channel < 3; ++channel) {
        mesh.colors[base + i][channel] = clamp_alpha(
            attributes.colors->normalized(source(i), static_cast<std::uint64_t>(channel)));
      }
    }
  }
  return odd;
}

}  // namespace dapple::gltf
