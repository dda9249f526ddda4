// Lists the procedural scenes and their parameters, for `dapple scene --help` and for messages.
// make_procedural() in dapple/scene.hpp makes the scenes.
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

/// Returns every scene, in the order of the help text.
std::vector<ProceduralHelp> procedural_help();

}  // namespace dapple
