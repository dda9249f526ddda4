// Texts that quote files: names in these may be anything.
#include "scene/message.hpp"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Message, NamesOfElementsStayInOneLineAndMoveNoCursor) {
  EXPECT_EQ(element("material", 2, "bark"), "material 2 (\"bark\")");
  EXPECT_EQ(element("material", 2, "a\x1b[31m\nb\xc2\x9b"), "material 2 (\"a [31m b \")");
  EXPECT_EQ(element("mesh", 0, ""), "mesh 0");
}

}  // namespace
}  // namespace dapple
