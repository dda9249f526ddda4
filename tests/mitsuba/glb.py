"""Reads and writes the part of glTF 2.0 (GLB) that these tests need.

read_glb() follows the specification: meshes placed by matrices, alpha modes, alpha of the base colour
and of its texture. write_glb() writes meshes in world space.
"""

import io
import json
import struct

import mitsuba as mi
import numpy as np

from geometry import Material, Mesh, Texture

COMPONENTS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
WRAPS = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
NEAREST = 9728
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


class GlbFile:
    """The JSON and the binary chunk of a GLB file."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, _, json_bytes, _ = struct.unpack_from("<4sIIII", data)
        if magic != b"glTF" or version != 2:
            raise ValueError(f"{path} is no GLB file of version 2")
        self.json = json.loads(data[20 : 20 + json_bytes])
        self.binary = data[28 + json_bytes :]

    def view(self, index):
        view = self.json["bufferViews"][index]
        if "byteStride" in view:
            raise ValueError("interleaved bufferViews are not read here")
        first = view.get("byteOffset", 0)
        return self.binary[first : first + view["byteLength"]]

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        width = WIDTHS[accessor["type"]]
        values = np.frombuffer(
            self.view(accessor["bufferView"]),
            COMPONENTS[accessor["componentType"]],
            accessor["count"] * width,
            accessor.get("byteOffset", 0),
        )
        return values.reshape(-1, width)

    def texture(self, index):
        texture = self.json["textures"][index]
        sampler = self.json["samplers"][texture["sampler"]]
        if sampler["wrapS"] != sampler["wrapT"]:
            raise ValueError("Mitsuba wraps both coordinates alike")
        png = self.view(self.json["images"][texture["source"]]["bufferView"])
        stream = mi.MemoryStream()
        stream.write(png)
        stream.seek(0)
        texels = np.array(mi.Bitmap(stream))
        return Texture(
            texels[:, :, 3].astype(np.float32) / 255,
            sampler["magFilter"] == NEAREST,
            WRAPS[sampler["wrapS"]],
        )

    def material(self, index):
        material = self.json["materials"][index]
        mode = material.get("alphaMode", "OPAQUE")
        if mode == "OPAQUE":
            return Material()
        base = material["pbrMetallicRoughness"]
        texture = base.get("baseColorTexture")
        return Material(
            base.get("baseColorFactor", [1, 1, 1, 1])[3],
            material.get("alphaCutoff", 0.5) if mode == "MASK" else None,
            self.texture(texture["index"]) if texture else None,
        )


def read_glb(path):
    """Returns the meshes of all nodes, in world space. Nodes have matrices and no children."""
    file = GlbFile(path)
    meshes = []
    for node in file.json["nodes"]:
        if set(node) - {"matrix", "mesh", "name"}:
            raise ValueError(f"{path}: a node has keys that are not read here: {sorted(node)}")
        to_world = np.array(node.get("matrix", np.eye(4).ravel()), np.float64).reshape(4, 4).T
        for primitive in file.json["meshes"][node["mesh"]]["primitives"]:
            attributes = primitive["attributes"]
            positions = file.accessor(attributes["POSITION"]) @ to_world[:3, :3].T + to_world[:3, 3]
            uv = file.accessor(attributes["TEXCOORD_0"]) if "TEXCOORD_0" in attributes else None
            triangles = file.accessor(primitive["indices"]).reshape(-1, 3)
            meshes.append(Mesh(positions, triangles, file.material(primitive["material"]), uv))
    return meshes


class GlbWriter:
    """Collects bufferViews and accessors."""

    def __init__(self):
        self.binary = io.BytesIO()
        self.views, self.accessors = [], []

    def add_view(self, data, target=None):
        view = {"buffer": 0, "byteOffset": self.binary.tell(), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.binary.write(data + b"\0" * (-len(data) % 4))
        self.views.append(view)
        return len(self.views) - 1

    def add_array(self, array, kind, target):
        component = next(code for code, dtype in COMPONENTS.items() if dtype == array.dtype)
        accessor = {
            "bufferView": self.add_view(array.tobytes(), target),
            "componentType": component,
            "count": array.size // WIDTHS[kind],
            "type": kind,
        }
        if kind == "VEC3":
            accessor["min"] = array.min(axis=0).tolist()
            accessor["max"] = array.max(axis=0).tolist()
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def png_of(texture):
    """A PNG whose alpha is the texture's."""
    alpha = np.round(texture.alpha * 255).astype(np.uint8)
    texels = np.full((*alpha.shape, 4), 200, np.uint8)
    texels[:, :, 3] = alpha
    stream = mi.MemoryStream()
    mi.Bitmap(texels).write(stream, mi.Bitmap.FileFormat.PNG)
    size = stream.size()
    stream.seek(0)
    return stream.read(size)


def write_glb(path, meshes):
    """One node, material and (where there is one) texture for each mesh."""
    writer = GlbWriter()
    keys = ("meshes", "nodes", "materials", "textures", "samplers", "images")
    content = {key: [] for key in keys}
    for number, mesh in enumerate(meshes):
        attributes = {
            "POSITION": writer.add_array(mesh.positions.astype(np.float32), "VEC3", ARRAY_BUFFER)
        }
        if mesh.uv is not None:
            attributes["TEXCOORD_0"] = writer.add_array(
                mesh.uv.astype(np.float32), "VEC2", ARRAY_BUFFER
            )
        indices = writer.add_array(
            mesh.triangles.astype(np.uint32).ravel(), "SCALAR", ELEMENT_ARRAY_BUFFER
        )
        primitive = {"attributes": attributes, "indices": indices, "material": number}
        content["meshes"].append({"primitives": [primitive]})
        content["nodes"].append({"mesh": number})
        content["materials"].append(add_material(writer, content, mesh.material))
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": writer.binary.tell()}],
        "bufferViews": writer.views,
        "accessors": writer.accessors,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "scene": 0,
        **{key: values for key, values in content.items() if values},
    }
    path.write_bytes(glb_bytes(document, writer.binary.getvalue()))


def add_material(writer, content, material):
    """Returns a glTF material; its texture, sampler and image go into `content`."""
    base = {"baseColorFactor": [1, 1, 1, material.factor]}
    if material.texture:
        image = writer.add_view(png_of(material.texture))
        content["images"].append({"bufferView": image, "mimeType": "image/png"})
        wrap = next(code for code, name in WRAPS.items() if name == material.texture.wrap)
        content["samplers"].append(
            {
                "magFilter": NEAREST if material.texture.nearest else 9729,
                "minFilter": NEAREST if material.texture.nearest else 9729,
                "wrapS": wrap,
                "wrapT": wrap,
            }
        )
        number = len(content["textures"])
        content["textures"].append({"sampler": number, "source": number})
        base["baseColorTexture"] = {"index": number}
    result = {"pbrMetallicRoughness": base, "doubleSided": True}
    if material.cutoff is not None:
        return {**result, "alphaMode": "MASK", "alphaCutoff": material.cutoff}
    is_opaque = material.factor == 1 and not material.texture
    return {**result, "alphaMode": "OPAQUE" if is_opaque else "BLEND"}


def glb_bytes(document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 28 + len(text) + len(binary)
    header = struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
    return header + text + struct.pack("<II", len(binary), 0x004E4942) + binary
