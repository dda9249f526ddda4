// Documents of one triangle in which one value is wrong. The messages name the element and the
// wrong values.
#include "corpus/damage.hpp"

namespace dapple::test {
namespace {

const Damage kDamages[] = {
    {"AccessorPastItsView", [](json& d) { d["accessors"][0]["count"] = 4; },
     "accessor 0 reads past bufferView 0 (needs 48 bytes, has 36)"},
    {"AccessorOffsetPastItsView", [](json& d) { d["accessors"][0]["byteOffset"] = 4; },
     "accessor 0 reads past bufferView 0 (needs 40 bytes, has 36)"},
    {"AccessorCountThatOverflows64Bits",
     [](json& d) { d["accessors"][0]["count"] = 9007199254740991; },
     "accessor 0 reads past bufferView 0"},
    {"AccessorCountBelowZero", [](json& d) { d["accessors"][0]["count"] = -1; },
     "accessor 0: count is not an integer"},
    {"AccessorWithAnAbsurdCountOfZeros",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["accessors"][0]["count"] = 1000000000;
     },
     "accessor 0 has 1,000,000,000 elements but no bufferView"},
    {"AccessorInAnUnknownView", [](json& d) { d["accessors"][0]["bufferView"] = 7; },
     "accessor 0 names bufferView 7, but there are 1"},
    {"AccessorOfAnUnknownComponent", [](json& d) { d["accessors"][0]["componentType"] = 5124; },
     "accessor 0: componentType is 5124"},
    {"AccessorOfAnUnknownType", [](json& d) { d["accessors"][0]["type"] = "VEC5"; },
     "accessor 0: type is \"VEC5\", not one of SCALAR, VEC2"},
    {"ViewPastItsBuffer", [](json& d) { d["bufferViews"][0]["byteOffset"] = 8; },
     "bufferView 0 reads past buffer 0 (needs 44 bytes, has 36)"},
    {"ViewInAnUnknownBuffer", [](json& d) { d["bufferViews"][0]["buffer"] = 1; },
     "bufferView 0 names buffer 1, but there are 1"},
    {"StrideBelowTheElement", [](json& d) { d["bufferViews"][0]["byteStride"] = 8; },
     "accessor 0 has elements of 12 bytes in bufferView 0 of byteStride 8"},
    {"StrideThatIsOdd", [](json& d) { d["bufferViews"][0]["byteStride"] = 13; },
     "bufferView 0: byteStride is not a multiple of 4"},
    {"BufferLongerThanItsBytes",
     [](json& d) {
       d["buffers"] = {{{"byteLength", 4096}}};
     },
     "buffer 0: is too short (byteLength is 4,096, it has 36)"},
    {"BufferFarAway",
     [](json& d) {
       d["buffers"] = {{{"uri", "https://example.org/a.bin"}, {"byteLength", 36}}};
     },
     "is not a relative path"},
    {"BufferOutsideTheFolder",
     [](json& d) {
       d["buffers"] = {{{"uri", "%2e%2e/a.bin"}, {"byteLength", 36}}};
     },
     "leads out of the scene's folder"},
    {"BufferAtAnAbsolutePath",
     [](json& d) {
       d["buffers"] = {{{"uri", "/etc/passwd"}, {"byteLength", 36}}};
     },
     "leads out of the scene's folder"},
    {"BufferThatIsAbsent",
     [](json& d) {
       d["buffers"] = {{{"uri", "a.bin"}, {"byteLength", 36}}};
     },
     "buffer 0 (a.bin): no such file"},
    {"BufferOfBadBase64",
     [](json& d) {
       d["buffers"] = {{{"uri", "data:;base64,A*AA"}, {"byteLength", 3}}};
     },
     "buffer 0: its data: URI holds a character that is not base64"},
    {"PrimitiveWithoutAttributes",
     [](json& d) { d["meshes"][0]["primitives"][0].erase("attributes"); },
     "mesh 0 primitive 0: attributes is missing"},
    {"PrimitiveOfAnUnknownAccessor",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 3; },
     "mesh 0 primitive 0 POSITION names accessor 3, but there are 1"},
    {"PrimitiveOfAnUnknownMaterial",
     [](json& d) { d["meshes"][0]["primitives"][0]["material"] = 0; },
     "mesh 0 primitive 0 names material 0, but there are 0"},
    {"PrimitiveOfAnUnknownMode", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 9; },
     "mesh 0 primitive 0: mode is 9"},
    {"PrimitiveWithPositionsOfTheWrongType", [](json& d) { d["accessors"][0]["type"] = "VEC2"; },
     "mesh 0 primitive 0 POSITION is accessor 0, which is VEC2 of float"},
    {"PrimitiveThatLacksACorner", [](json& d) { d["accessors"][0]["count"] = 2; },
     "mesh 0 primitive 0: 2 indices do not make whole triangles"},
    {"PrimitiveWhoseDracoDataAreNone",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
           {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
     },
     "mesh 0 primitive 0 has data that do not begin as Draco's do"},
    {"IndexCutTo32Bits", [](json& d) { d["nodes"][0]["mesh"] = 4294967296; },
     "node 0: mesh is not an integer"},
    {"NodeOfAnUnknownMesh", [](json& d) { d["nodes"][0]["mesh"] = 1; },
     "node 0 names mesh 1, but there are 1"},
    {"NodeOfAnUnknownChild", [](json& d) { d["nodes"][0]["children"] = {5}; },
     "node 0 names node 5, but there are 1"},
    {"NodeThatIsItsOwnChild", [](json& d) { d["nodes"][0]["children"] = {0}; },
     "node 0 is its own ancestor"},
    {"NodeWithTwoParents",
     [](json& d) {
       d["nodes"].push_back({{"children", {0}}});
       d["nodes"].push_back({{"children", {0}}});
     },
     "node 0 is a child of both node 1 and node 2"},
    {"NodeMatrixOfFifteen", [](json& d) { d["nodes"][0]["matrix"] = std::vector<int>(15, 1); },
     "node 0: matrix has 15 numbers, not 16"},
    {"NodeMatrixThatProjects",
     [](json& d) { d["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0}; },
     "node 0 has a matrix that is not affine"},
    {"NodeWithoutARotation",
     [](json& d) {
       d["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "node 0 has a rotation of length zero"},
    {"NodesOfUnrepresentableScale",
     [](json& d) {
       d["nodes"][0]["scale"] = {1e38, 1, 1};
       d["nodes"].push_back({{"children", {0}}, {"scale", {1e38, 1, 1}}});
     },
     "node 0 has a world matrix that is not finite"},
    {"SceneOfAnUnknownNode",
     [](json& d) {
       d["scenes"] = {{{"nodes", {4}}}};
     },
     "scene 0 names node 4, but there are 1"},
    {"SceneThatListsANodeTwice",
     [](json& d) {
       d["scenes"] = {{{"nodes", {0, 0}}}};
     },
     "scene 0 lists node 0 twice"},
    {"UnknownDefaultScene", [](json& d) { d["scene"] = 2; }, "names scene 2, but there are 0"},
    {"NodeOfAnUnknownLight",
     [](json& d) { d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
     "node 0 names light 0, but there are 0"},
    {"MaterialOfAnUnknownMode",
     [](json& d) {
       d["materials"] = {{{"name", "leaf"}, {"alphaMode", "GLASS"}}};
     },
     "material 0: alphaMode is \"GLASS\""},
    {"CameraThatSeesNothing",
     [](json& d) {
       d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}}};
       d["nodes"][0]["camera"] = 0;
     },
     "camera 0 has yfov 0"},
    {"NameWithALineBreak",
     [](json& d) {
       d["nodes"][0]["name"] = "a\nb";
       d["nodes"][0]["mesh"] = 1;
     },
     "node 0 (\"a b\") names mesh 1"},
};

}  // namespace

void add_wrong_values(MalformedCases& cases) { add_damages(cases, "value_", kDamages); }

}  // namespace dapple::test
