// One edit of a sound document of one triangle that makes it malformed.
#pragma once

#include <span>

#include "corpus/corpus.hpp"

namespace dapple::test {

/// The message must hold `says`.
struct Damage {
  const char* name;
  std::function<void(json&)> edit;
  const char* says;
};

inline void add_damages(MalformedCases& cases, const std::string& prefix,
                        std::span<const Damage> damages) {
  for (const Damage& damage : damages) {
    GltfBuilder builder = one_triangle();
    damage.edit(builder.doc);
    cases.push_back({prefix + damage.name, as_glb(builder), damage.says});
  }
}

}  // namespace dapple::test
