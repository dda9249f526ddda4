"""Files that `dapple bake` writes, in other programs' readers: pygltflib, trimesh and Pillow."""

import io
import subprocess
from pathlib import Path
from typing import Any

import dapple
import numpy as np
import pytest

pygltflib = pytest.importorskip("pygltflib")
trimesh = pytest.importorskip("trimesh")
Image = pytest.importorskip("PIL.Image")

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


def elements(file: Any, index: int) -> np.ndarray:
    """The accessor as it is stored, (count, components) or (count,)."""
    accessor = file.accessors[index]
    view = file.bufferViews[accessor.bufferView]
    kind = np.dtype(TYPES[accessor.componentType])
    width = COMPONENTS[accessor.type]
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    stride = view.byteStride or width * kind.itemsize
    found = np.ndarray(
        (accessor.count, width), kind, file.binary_blob(), start, (stride, kind.itemsize)
    )
    return found[:, 0] if width == 1 else found


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A ball that touches a plate, as trimesh writes them."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    ball.apply_translation([0, 0.5, 0])
    plate = trimesh.creation.box([3, 0.2, 3]).subdivide().subdivide().subdivide()
    plate.apply_translation([0, -0.1, 0])
    path = tmp_path / "model.glb"
    trimesh.Scene({"ball": ball, "plate": plate}).export(path)
    return path


def bake(program: str, model: Path, *options: str) -> Path:
    out = model.with_name("out.glb")
    subprocess.run([program, "bake", model, "-o", out, "-q", "--rays", "64", *options], check=True)
    return out


def test_attributes_have_the_values_of_the_python_door(program: str, model: Path) -> None:
    path = bake(program, model, "--channel", "_AO", "--passes", "ao,bent")
    file = pygltflib.GLTF2().load(path)
    scene = dapple.load(str(model))
    baked = scene.bake(bent=True, rays=64, target_error=0)
    assert len(file.meshes) == len(scene.meshes) == 2
    for mesh, shape, values in zip(file.meshes, scene.meshes, baked.meshes):
        attributes = mesh.primitives[0].attributes
        np.testing.assert_array_equal(elements(file, attributes.POSITION), shape.positions)
        np.testing.assert_array_equal(elements(file, attributes._AO), values["ao"])
        bent = elements(file, attributes._BENT_NORMAL)
        np.testing.assert_allclose(bent, values["bent"], atol=1e-6)  # made unit vectors again
        assert file.accessors[attributes._AO].count == len(shape.positions)
        assert values["ao"].min() < 0.5 < 0.99 < values["ao"].max()
    read = trimesh.load(path, process=False)
    for name, values in zip(("ball", "plate"), baked.meshes):
        geometry = read.geometry[name]
        np.testing.assert_array_equal(geometry.vertex_attributes["_AO"].ravel(), values["ao"])
        assert geometry.vertex_attributes["_BENT_NORMAL"].shape == geometry.vertices.shape


def test_colours_are_the_values_in_sixteen_bits(program: str, model: Path) -> None:
    file = pygltflib.GLTF2().load(bake(program, model))
    baked = dapple.load(str(model)).bake(rays=64, target_error=0)
    for mesh, values in zip(file.meshes, baked.meshes):
        accessor = file.accessors[mesh.primitives[0].attributes.COLOR_0]
        assert (accessor.componentType, accessor.normalized, accessor.type) == (5123, True, "VEC3")
        colors = elements(file, mesh.primitives[0].attributes.COLOR_0)
        expected = np.repeat(values["ao"][:, None] * 65535.0, 3, axis=1)
        np.testing.assert_allclose(colors, expected, atol=0.51)


@pytest.mark.parametrize(("bits", "mode"), [(8, "L"), (16, "I;16")])
def test_textures_decode_and_have_the_values_of_the_vertices(
    program: str, model: Path, bits: int, mode: str
) -> None:
    path = bake(program, model, "--to", "texture", "--size", "128", "--bits", str(bits))
    file = pygltflib.GLTF2().load(path)
    used = {
        file.materials[mesh.primitives[0].material].occlusionTexture.index for mesh in file.meshes
    }
    assert len(used) == 1, "all meshes share one texture"
    view = file.bufferViews[file.images[file.textures[used.pop()].source].bufferView]
    png = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    image = Image.open(io.BytesIO(png))
    assert (image.size, image.mode, image.format) == ((128, 128), mode, "PNG")
    texels = np.asarray(image) / (2.0**bits - 1)
    of_python = dapple.load(str(model)).bake(
        vertices=False, texture=True, texture_size=128, rays=64, target_error=0
    ).texture
    assert of_python is not None
    np.testing.assert_allclose(texels, of_python.layers["ao"], atol=0.51 / (2.0**bits - 1))
    for mesh, corners in zip(file.meshes, of_python.uvs):
        primitive = mesh.primitives[0]
        uv = elements(file, primitive.attributes.TEXCOORD_0)
        np.testing.assert_array_equal(uv[elements(file, primitive.indices)], corners.reshape(-1, 2))
    baked = dapple.load(str(model)).bake(rays=1024, target_error=0)
    truth = {
        tuple(position): ao
        for shape, values in zip(dapple.load(str(model)).meshes, baked.meshes)
        for position, ao in zip(shape.positions.tolist(), values["ao"])
    }
    for mesh in file.meshes:
        primitive = mesh.primitives[0]
        uv = elements(file, primitive.attributes.TEXCOORD_0)
        positions = elements(file, primitive.attributes.POSITION).tolist()
        column, row = np.minimum(uv * 128, 127).astype(int).T
        at_vertices = np.array([truth[tuple(position)] for position in positions])
        # A vertex has the mean over its triangles, a texel that of itself: they differ where AO
        # changes within a triangle. In another order those of the ball differ by several times that.
        assert np.abs(texels[row, column] - at_vertices).mean() < 0.06
    assert texels.std() > 0.1


def test_nodes_have_their_values_as_extras(program: str, model: Path) -> None:
    file = pygltflib.GLTF2().load(bake(program, model, "--to", "instance"))
    expected = dapple.load(str(model)).bake(
        vertices=False, instances=True, rays=64, target_error=0
    ).instance_ao
    found = [node.extras["ao"] for node in file.nodes if node.mesh is not None]
    np.testing.assert_array_equal(np.float32(found), expected)


def test_gpu_instances_have_their_values_as_an_attribute(program: str, model: Path) -> None:
    file = pygltflib.GLTF2().load(model)
    places = np.float32([[0, 0, 0], [5, 0, 0], [0, 0.3, 0]])
    blob = file.binary_blob()
    view = pygltflib.BufferView(buffer=0, byteOffset=len(blob), byteLength=places.nbytes)
    file.bufferViews.append(view)
    file.accessors.append(
        pygltflib.Accessor(bufferView=len(file.bufferViews) - 1, componentType=5126, count=3, type="VEC3")
    )
    ball = next(node for node in file.nodes if node.name == "ball")
    attributes = {"TRANSLATION": len(file.accessors) - 1}
    ball.extensions = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    file.extensionsUsed.append("EXT_mesh_gpu_instancing")
    file.buffers[0].byteLength = len(blob) + places.nbytes
    file.set_binary_blob(blob + places.tobytes())
    file.save(model)

    baked = pygltflib.GLTF2().load(bake(program, model, "--to", "instance"))
    expected = dapple.load(str(model)).bake(
        vertices=False, instances=True, rays=64, target_error=0
    ).instance_ao
    ball = next(node for node in baked.nodes if node.name == "ball")
    attributes = ball.extensions["EXT_mesh_gpu_instancing"]["attributes"]
    plate = next(node for node in baked.nodes if node.name == "plate")
    np.testing.assert_array_equal(elements(baked, attributes["TRANSLATION"]), places)
    found = [*elements(baked, attributes["_AO"]), np.float32(plate.extras["ao"])]
    np.testing.assert_array_equal(found, expected)
    assert found[1] == max(found), "nothing is near the ball beside the plate"
