// What procedural scenes there are and what each can be told, for `dapple scene --help` and
// for messages. The scenes themselves come from make_procedural in dapple/scene.hpp.
#pragma once

#include <string>
#include <vector>

namespace dapple {

struct ProceduralParameter {
  std::string name;
  double default_value = 0;
  double minimum = 0;
  double maximum = 0;
  bool whole = false;  ///< only integers
  std::string help;    ///< one line, unit included
};

struct ProceduralHelp {
  std::string name;  ///< NAME in "scene:NAME?key=value"
  std::string help;  ///< one line
  std::vector<ProceduralParameter> parameters;
};

/// Every scene, in the order in which to show them.
std::vector<ProceduralHelp> procedural_help();

}  // namespace dapple
