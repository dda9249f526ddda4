// Documents of one triangle in which one element has a value that the specification forbids.
#include "corpus/damage.hpp"

namespace dapple::test {
namespace {

const Damage kDamages[] = {
    {"CountOfZero", [](json& d) { d["accessors"][0]["count"] = 0; }, "accessor 0: count is not"},
    {"CountThatIsAFraction", [](json& d) { d["accessors"][0]["count"] = 2.5; },
     "accessor 0: count is not"},
    {"CountPastDouble", [](json& d) { d["accessors"][0]["count"] = 1e300; },
     "accessor 0: count is not"},
    {"CountOf64Bits", [](json& d) { d["accessors"][0]["count"] = 18446744073709551615u; },
     "accessor 0: count is not"},
    {"AccessorOffsetBelowZero", [](json& d) { d["accessors"][0]["byteOffset"] = -12; },
     "accessor 0: byteOffset is not"},
    {"AccessorOffsetThatIsHuge",
     [](json& d) { d["accessors"][0]["byteOffset"] = 9007199254740988; }, "accessor 0 reads past"},
    {"AccessorOffsetUnaligned",
     [](json& d) {
       d["accessors"][0]["byteOffset"] = 2;
       d["accessors"][0]["count"] = 1;
     },
     "accessor 0 begins at byte 2"},
    {"ViewOffsetUnaligned",
     [](json& d) {
       d["bufferViews"][0]["byteOffset"] = 1;
       d["bufferViews"][0]["byteLength"] = 35;
       d["accessors"][0]["count"] = 2;
     },
     "accessor 0 begins at byte 0"},
    {"ViewOfLengthZero", [](json& d) { d["bufferViews"][0]["byteLength"] = 0; },
     "bufferView 0: byteLength is not"},
    {"ViewOfNegativeLength", [](json& d) { d["bufferViews"][0]["byteLength"] = -36; },
     "bufferView 0: byteLength is not"},
    {"ViewWithoutALength", [](json& d) { d["bufferViews"][0].erase("byteLength"); },
     "bufferView 0: byteLength is missing"},
    {"ViewWithoutABuffer", [](json& d) { d["bufferViews"][0].erase("buffer"); },
     "bufferView 0: buffer is missing"},
    {"ViewsThatOverflowTogether",
     [](json& d) {
       d["bufferViews"][0]["byteOffset"] = 9007199254740988;
       d["bufferViews"][0]["byteLength"] = 9007199254740988;
     },
     "bufferView 0 reads past"},
    {"ViewOfAnUnknownTarget", [](json& d) { d["bufferViews"][0]["target"] = 3; },
     "bufferView 0: target is 3"},
    {"StrideOfZero", [](json& d) { d["bufferViews"][0]["byteStride"] = 0; },
     "bufferView 0: byteStride is not"},
    {"StrideOf256", [](json& d) { d["bufferViews"][0]["byteStride"] = 256; },
     "bufferView 0: byteStride is not"},
    {"StridePastTheView", [](json& d) { d["bufferViews"][0]["byteStride"] = 252; },
     "accessor 0 reads past bufferView 0"},
    {"BufferOfLengthZero",
     [](json& d) {
       d["buffers"] = {{{"byteLength", 0}}};
     },
     "buffer 0: byteLength is not"},
    {"BufferWithoutALength",
     [](json& d) {
       d["buffers"] = json::array({json::object({{"name", "b"}})});
     },
     "buffer 0: byteLength is missing"},
    {"BufferOfNoBytes",
     [](json& d) {
       d["buffers"] = {{{"byteLength", 36}}, {{"byteLength", 4}}};
     },
     "buffer 1: has no uri"},
    {"PositionsOfIntegers", [](json& d) { d["accessors"][0]["componentType"] = 5123; },
     "only KHR_mesh_quantization"},
    {"PositionsOf32BitIntegers",
     [](json& d) {
       d["accessors"][0]["componentType"] = 5125;
       d["extensionsUsed"] = {"KHR_mesh_quantization"};
     },
     "mesh 0 primitive 0 POSITION is accessor 0, which is VEC3 of uint32"},
    {"PositionsOfMatrices",
     [](json& d) {
       d["accessors"][0]["type"] = "MAT3";
       d["accessors"][0]["count"] = 1;
     },
     "mesh 0 primitive 0 POSITION is accessor 0, which is MAT of float"},
    {"NormalsOfTheWrongShape",
     [](json& d) {
       d["accessors"].push_back(d["accessors"][0]);
       d["accessors"][1]["type"] = "VEC2";
       d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 1;
     },
     "mesh 0 primitive 0 NORMAL is accessor 1"},
    {"MinimumOfTheWrongLength",
     [](json& d) {
       d["accessors"][0]["min"] = {0, 0};
     },
     "accessor 0: min has 2 numbers, not 3"},
    {"MaximumOfWords",
     [](json& d) {
       d["accessors"][0]["max"] = {"a", "b", "c"};
     },
     "accessor 0: max is not a number"},
    {"NoMeshes", [](json& d) { d.erase("meshes"); }, "node 0 names mesh 0, but there are 0"},
    {"NoNodes", [](json& d) { d.erase("nodes"); }, "has no triangles"},
    {"NoAccessors", [](json& d) { d.erase("accessors"); }, "names accessor 0, but there are 0"},
    {"NoViews", [](json& d) { d.erase("bufferViews"); }, "names bufferView 0, but there are 0"},
    {"NoAsset", [](json& d) { d.erase("asset"); }, "asset is missing"},
    {"NoVersion", [](json& d) { d["asset"].erase("version"); }, "asset: version is missing"},
    {"VersionOne", [](json& d) { d["asset"]["version"] = "1.0"; }, "is glTF 1.0"},
    {"VersionThree", [](json& d) { d["asset"]["version"] = "3.0"; }, "is glTF 3.0"},
    {"VersionOfWords", [](json& d) { d["asset"]["version"] = "2.x"; }, "is glTF 2.x"},
    {"VersionAsANumber", [](json& d) { d["asset"]["version"] = 2.0; }, "version is not a string"},
    {"MinimumVersion", [](json& d) { d["asset"]["minVersion"] = "2.1"; }, "needs glTF 2.1"},
    {"MeshOfNoPrimitives", [](json& d) { d["meshes"][0].erase("primitives"); },
     "mesh 0: primitives is missing"},
    {"MeshOfAnEmptyList", [](json& d) { d["meshes"][0]["primitives"] = json::array(); },
     "has no triangles"},
    {"PrimitiveWithoutPositions",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"] = json::object(); },
     "has no triangles"},
    {"PrimitiveOfPointsOnly", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 0; },
     "has no triangles"},
    {"PrimitiveOfNegativeMode", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = -1; },
     "mesh 0 primitive 0: mode is not"},
    {"TargetOfAnUnknownAccessor",
     [](json& d) {
       d["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 5}}};
     },
     "mesh 0 primitive 0 target 0 POSITION names accessor 5"},
    {"TargetThatIsANumber", [](json& d) { d["meshes"][0]["primitives"][0]["targets"] = {0}; },
     "mesh 0 primitive 0: targets is not"},
    {"IndexThatIsAFraction", [](json& d) { d["nodes"][0]["mesh"] = 0.5; },
     "node 0: mesh is not an integer"},
    {"IndexBelowZero", [](json& d) { d["nodes"][0]["mesh"] = -1; },
     "node 0: mesh is not an integer"},
    {"IndexAsText", [](json& d) { d["nodes"][0]["mesh"] = "0"; }, "node 0: mesh is not an integer"},
    {"NodeOfAnUnknownCamera", [](json& d) { d["nodes"][0]["camera"] = 0; },
     "node 0 names camera 0, but there are 0"},
    {"NodeOfAnUnknownSkin", [](json& d) { d["nodes"][0]["skin"] = 0; }, "node 0 names skin 0"},
    {"NodeWithMatrixAndTranslation",
     [](json& d) {
       d["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
       d["nodes"][0]["translation"] = {1, 0, 0};
     },
     "node 0 has both a matrix and"},
    {"NodeWithALongRotation",
     [](json& d) {
       d["nodes"][0]["rotation"] = {0, 0, 0, 2};
     },
     "node 0 has a rotation of length 2"},
    {"NodeMatrixOfZeros", [](json& d) { d["nodes"][0]["matrix"] = std::vector<int>(16, 0); },
     "node 0 has a matrix that is not affine"},
    {"NodeMatrixOfHugeNumbers",
     [](json& d) { d["nodes"][0]["matrix"] = std::vector<double>(16, 1e300); },
     "node 0: matrix is not a number that a float can hold"},
    {"NodeScaleOfTwo",
     [](json& d) {
       d["nodes"][0]["scale"] = {1, 1};
     },
     "node 0: scale has 2 numbers, not 3"},
    {"NodesInACircle",
     [](json& d) {
       d["nodes"][0]["children"] = {1};
       d["nodes"].push_back({{"children", {2}}});
       d["nodes"].push_back({{"children", {0}}});
     },
     "is its own ancestor"},
    {"NodesInACircleBesideTheScene",
     [](json& d) {
       d["nodes"].push_back({{"children", {2}}});
       d["nodes"].push_back({{"children", {1}}});
       d["scenes"] = {{{"nodes", {0}}}};
     },
     "is its own ancestor"},
    {"ChildListedTwice",
     [](json& d) {
       d["nodes"].push_back({{"children", {0, 0}}});
     },
     "node 0 is a child of both"},
    {"SceneOfAChild",
     [](json& d) {
       d["nodes"].push_back({{"children", {0}}});
       d["scenes"] = {{{"nodes", {0, 1}}}};
     },
     "scene 0 lists node 0, which is a child"},
    {"SceneOfNothing", [](json& d) { d["scenes"] = json::array({json::object()}); },
     "has no triangles"},
    {"SceneBelowZero", [](json& d) { d["scene"] = -1; }, "scene is not an integer"},
    {"ExtensionUnknownButRequired",
     [](json& d) { d["extensionsUsed"] = d["extensionsRequired"] = {"ACME_hidden_geometry"}; },
     "requires the extension ACME_hidden_geometry"},
    {"ExtensionLaterMeshoptRequired",
     [](json& d) { d["extensionsUsed"] = d["extensionsRequired"] = {"KHR_meshopt_compression"}; },
     "requires the extension KHR_meshopt_compression"},
    {"ExtensionBasisRequired",
     [](json& d) { d["extensionsUsed"] = d["extensionsRequired"] = {"KHR_texture_basisu"}; },
     "requires the extension KHR_texture_basisu"},
    {"ExtensionRequiredThatIsANumber", [](json& d) { d["extensionsRequired"] = {7}; },
     "extensionsRequired is not an array of strings"},
    {"ExtensionsThatAreAList",
     [](json& d) {
       d["nodes"][0]["extensions"] = {1, 2};
     },
     "node 0: extensions is not an object"},
    {"ExtensionThatIsANumber", [](json& d) { d["nodes"][0]["extensions"]["X"] = 1; },
     "node 0: extensions is not an object"},
    {"MaterialOfAnUnknownTexture",
     [](json& d) {
       d["materials"] = {{{"normalTexture", {{"index", 3}}}}};
     },
     "material 0 names texture 3"},
    {"MaterialOfANegativeCutoff",
     [](json& d) {
       d["materials"] = {{{"alphaMode", "MASK"}, {"alphaCutoff", -0.5}}};
     },
     "material 0: alphaCutoff is -0.5"},
    {"MaterialOfOpacityFive",
     [](json& d) {
       d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 5}}}}}};
     },
     "material 0 pbrMetallicRoughness: baseColorFactor is 5"},
    {"MaterialOfThreeFactors",
     [](json& d) {
       d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1}}}}}};
     },
     "material 0 pbrMetallicRoughness: baseColorFactor has 3 numbers, not 4"},
    {"MaterialOfNegativeEmission",
     [](json& d) {
       d["materials"] = {{{"emissiveFactor", {0, -1, 0}}}};
     },
     "material 0: emissiveFactor is -1"},
    {"TextureOfAnUnknownImage",
     [](json& d) {
       d["textures"] = {{{"source", 0}}};
     },
     "texture 0 names image 0, but there are 0"},
    {"TextureOfAnUnknownSampler",
     [](json& d) {
       d["textures"] = {{{"sampler", 4}}};
     },
     "texture 0 names sampler 4, but there are 0"},
    {"SamplerOfAnUnknownWrap",
     [](json& d) {
       d["samplers"] = {{{"wrapS", 1}}};
     },
     "sampler 0: wrapS is 1"},
    {"SamplerOfAnUnknownFilter",
     [](json& d) {
       d["samplers"] = {{{"magFilter", 9987}}};
     },
     "sampler 0: magFilter is 9987"},
    {"SkinOfAnUnknownJoint",
     [](json& d) {
       d["skins"] = {{{"joints", {9}}}};
     },
     "skin 0 names node 9"},
    {"SkinOfUnknownMatrices",
     [](json& d) {
       d["skins"] = {{{"joints", {0}}, {"inverseBindMatrices", 9}}};
     },
     "skin 0 names accessor 9"},
    {"AnimationOfAnUnknownSampler",
     [](json& d) {
       d["animations"] = {{{"samplers", json::array()},
                           {"channels", {{{"sampler", 0}, {"target", {{"path", "scale"}}}}}}}};
     },
     "animation 0 channel 0 names sampler 0"},
    {"CameraWiderThanPi",
     [](json& d) {
       d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 3.5}, {"znear", 1}}}}};
     },
     "camera 0 has yfov 3.5"},
    {"CameraOfNegativeAngle",
     [](json& d) {
       d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", -1}, {"znear", 1}}}}};
     },
     "camera 0 has yfov -1"},
    {"CameraThatEndsBeforeItBegins",
     [](json& d) {
       d["cameras"] = {
           {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 5}, {"zfar", 2}}}}};
     },
     "camera 0 has zfar 2 and znear 5"},
    {"CameraOfNoWidth",
     [](json& d) {
       d["cameras"] = {{{"type", "orthographic"},
                        {"orthographic", {{"xmag", 0}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}}};
     },
     "camera 0 has xmag 0"},
    {"CameraWithoutALens",
     [](json& d) {
       d["cameras"] = {{{"type", "perspective"}}};
     },
     "glTF"},
    {"CameraOfAnUnknownType",
     [](json& d) {
       d["cameras"] = {{{"type", "fisheye"}}};
     },
     "camera 0: type is \"fisheye\""},
    {"LightOfNegativeIntensity",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", -5}}};
     },
     "light 0: intensity is -5"},
    {"LightOfAnUnknownType",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "laser"}}};
     },
     "light 0: type is \"laser\""},
    {"LightWithoutAType",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"intensity", 1}}};
     },
     "light 0: type is missing"},
    {"LightWhoseConeIsInsideOut",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {
           {{"type", "spot"}, {"spot", {{"innerConeAngle", 1.2}, {"outerConeAngle", 0.4}}}}};
     },
     "light 0 has the inner cone angle 1.2 and the outer 0.4"},
    {"LightOfNegativeRange",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", -5}}};
     },
     "light 0: range is -5"},
};

}  // namespace

void add_wrong_elements(MalformedCases& cases) { add_damages(cases, "element_", kDamages); }

}  // namespace dapple::test
