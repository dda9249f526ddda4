// Edits that each make the valid document of one triangle malformed. In: a table of edits and
// messages; out: one malformed case for each edit.
#pragma once

#include <span>

#include "corpus/corpus.hpp"

namespace dapple::test {

/// An edit of the document. The message of the Error must contain `says`.
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
