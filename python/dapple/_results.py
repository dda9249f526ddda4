"""What scenes have and what queries return: named arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Iterable, Mapping

import numpy as np

from ._arrays import FloatArray, IndexArray


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh of a scene. The arrays are read-only views of the scene's memory.

    positions: (n, 3) float32, metres, in the mesh's own space. triangles: (m, 3) uint32; (m, 2) for
    the segments of strands. instances: (k, 4, 4) float32, world = matrix @ (x, y, z, 1).

    >>> mesh = dapple.load("scene:tree?leaves=100").meshes[0]
    >>> mesh.positions.dtype, mesh.triangles.dtype, mesh.instances.shape
    (dtype('float32'), dtype('uint32'), (1, 4, 4))
    """

    name: str
    positions: FloatArray
    triangles: IndexArray
    instances: FloatArray


@dataclass(frozen=True, eq=False)
class Irradiance:
    """Irradiance of one light at points, W/m^2, linear RGB, (n, 3) float32 each.

    irradiance: with occlusion. unoccluded: without; zero where the light is below the horizon.

    >>> demo = dapple.load("scene:demo")
    >>> sky = demo.irradiance([[0, 0.01, 0.5]], [0, 1, 0])["sky"]
    >>> bool((sky.irradiance < sky.unoccluded).all())
    True
    """

    irradiance: FloatArray
    unoccluded: FloatArray


@dataclass(frozen=True)
class Bias:
    """Prefiltered less exact values, as a call found them by tracing a part of its rays exactly.

    AO and gap fractions are in [0, 1]; lights are relative to their largest unoccluded irradiance.

    >>> baked = dapple.load("scene:tree?leaves=1000").bake(rays=64)
    >>> abs(baked.bias["ao"].mean) < 0.1, baked.bias["ao"].share <= 1
    (True, True)
    """

    #: Over the values.
    mean: float
    #: Standard error of the mean.
    error: float
    #: Root mean square of the bias of tiles of neighbouring values, without noise.
    tile_rmse: float
    #: What tile_rmse is below with some certainty.
    tile_rmse_limit: float
    #: Share of the rays that were traced exactly, [0, 1].
    share: float


def biases(native: Mapping[str, tuple[float, float, float, float, float]]) -> dict[str, Bias]:
    return {layer: Bias(*fields) for layer, fields in native.items()}


class Columns(dict[str, FloatArray]):
    """What measure() returns: a dict of columns, (n,) float32 each, and what is known of them.

    >>> columns = dapple.load("scene:tree?leaves=1000").measure([[0, 0.01, 0.5], [1, 0.01, 0]])
    >>> columns["ao"].shape, sorted(columns.bias), columns.footprint
    ((2,), ['ao', 'sky_view_factor'], 1.0)
    """

    def __init__(
        self,
        columns: Iterable[tuple[str, FloatArray]] = (),
        bias: Mapping[str, Bias] | None = None,
        footprint: float = 0.0,
        notes: Iterable[str] = (),
    ) -> None:
        super().__init__(columns)
        #: By quantity, before it was corrected; tile_rmse is what the correction leaves.
        self.bias: dict[str, Bias] = dict(bias or {})
        #: As given, or what max_bias chose.
        self.footprint = footprint
        #: Lines for the user, such as how large a bias was corrected.
        self.notes: list[str] = list(notes)

    def copy(self) -> Columns:
        """A copy that has the bias and the notes, too.

        >>> columns = dapple.load("scene:tree?leaves=1000").measure([[0, 0.01, 0.5]])
        >>> columns.copy().bias == columns.bias
        True
        """
        return Columns(self.items(), self.bias, self.footprint, self.notes)


@dataclass(frozen=True, eq=False)
class BakedTexture:
    """A texture that all meshes share. Row 0 is the top, v = 0, as in glTF.

    >>> baked = dapple.load("scene:cube").bake(texture=True, texture_size=64, rays=16)
    >>> baked.texture.layers["ao"].shape, baked.texture.uvs[0].shape[1:]
    ((64, 64), (3, 2))
    """

    #: "ao" (s, s) in [0, 1]; "bent" (s, s, 3), unit vectors or zero, and "light.NAME" (s, s, 3),
    #: W/m^2, if baked.
    layers: dict[str, FloatArray]
    #: For each mesh the texture coordinates of its triangles' corners, (m, 3, 2) in [0, 1]; (0, 3, 2)
    #: for strands, and for meshes that are not placed.
    uvs: list[FloatArray]
    #: Share of the texels that triangles cover, without the margin.
    coverage: float
    #: Share of these in which triangles overlap: values of several places are averaged there.
    overlap: float


@dataclass(frozen=True, eq=False)
class Bake:
    """Values at vertices, of instances, and in a texture.

    meshes: for each mesh "ao" (n,) in [0, 1], "bent" (n, 3) and "light.NAME" (n, 3), W/m^2, if
    baked. instance_ao: the mean of each instance in the file's order, (k,); instance_light: by
    light, W/m^2, (k, 3) each; empty if not baked.

    >>> baked = dapple.load("scene:forest?trees=3&leaves=100").bake(rays=16, instances=True)
    >>> list(baked.meshes[0]), baked.instance_ao.shape
    (['ao'], (4,))
    """

    meshes: list[dict[str, FloatArray]] = field(default_factory=list)
    instance_ao: FloatArray = field(default_factory=lambda: np.zeros(0, np.float32))
    instance_light: dict[str, FloatArray] = field(default_factory=dict)
    #: Lines for the user, such as the footprint that max_bias chose.
    notes: list[str] = field(default_factory=list)
    #: None if not baked.
    texture: BakedTexture | None = None
    #: Of "ao", and of "light", all lights together; empty for exact rays and report_bias=0.
    bias: dict[str, Bias] = field(default_factory=dict)
    #: As given, or what max_bias chose.
    footprint: float = 0.0


def bake_of(
    meshes: Iterable[Iterable[tuple[str, FloatArray]]],
    instance_ao: FloatArray,
    lights: Iterable[tuple[str, FloatArray]],
    texture: tuple[Any, ...] | None,
    notes: list[str],
    bias: Mapping[str, tuple[float, float, float, float, float]],
    footprint: float,
) -> Bake:
    """A Bake of what the engine returns."""
    baked = None if texture is None else BakedTexture(dict(texture[0]), *texture[1:])
    arrays = [dict(of) for of in meshes]
    return Bake(arrays, instance_ao, dict(lights), notes, baked, biases(bias), footprint)
