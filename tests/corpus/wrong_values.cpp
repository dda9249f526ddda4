// One wrong value at a time in a sound document of one triangle: each is refused by name and
// figures.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

/// The message must hold `says`.
struct Damage {
  const char* name;
  std::function<void(json&)> edit;
  const char* says;
};

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
    {"PrimitiveUnderDracoAlone",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
           {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
     },
     "mesh 0 primitive 0 exists only as KHR_draco_mesh_compression"},
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
    // What follows is wrong by the specification alone.
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
    {"ExtensionDracoRequired",
     [](json& d) {
       d["extensionsUsed"] = d["extensionsRequired"] = {"KHR_draco_mesh_compression"};
     },
     "requires the extension KHR_draco_mesh_compression"},
    {"ExtensionMeshoptRequired",
     [](json& d) { d["extensionsUsed"] = d["extensionsRequired"] = {"EXT_meshopt_compression"}; },
     "requires the extension EXT_meshopt_compression"},
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
     "light 0 has cone angles 1.2 and 0.4"},
    {"LightOfNegativeRange",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", -5}}};
     },
     "light 0: range is -5"},
};

}  // namespace

void add_wrong_values(MalformedCases& cases) {
  for (const Damage& damage : kDamages) {
    GltfBuilder builder = one_triangle();
    damage.edit(builder.doc);
    cases.push_back({std::string("value_") + damage.name, as_glb(builder), damage.says});
  }
}

}  // namespace dapple::test
