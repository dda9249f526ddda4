"""Scenes and what can be asked of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike, fspath
from typing import TYPE_CHECKING, Callable, Iterable, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _arrays, _native, _options
from ._arrays import FloatArray, IndexArray
from ._errors import UsageError
from ._picture import Picture

if TYPE_CHECKING:
    from typing_extensions import Unpack

Progress = Optional[Callable[[float], object]]


@dataclass(frozen=True)
class Mesh:
    """A mesh of a scene. The arrays are read-only views of the scene's memory."""

    name: str
    #: (n, 3) float32, metres, in the mesh's own space.
    positions: FloatArray
    #: (m, 3) uint32; (m, 2) for the segments of strands.
    triangles: IndexArray
    #: (k, 4, 4) float32: matrices that place the mesh, world = matrix @ (x, y, z, 1).
    instances: FloatArray


@dataclass(frozen=True)
class Irradiance:
    """Irradiance of one light at points, W/m^2, linear RGB, (n, 3) float32 each."""

    #: With occlusion.
    irradiance: FloatArray
    #: Without; zero where the light is below a point's horizon.
    unoccluded: FloatArray


@dataclass(frozen=True)
class Bake:
    """Values at vertices and of instances."""

    #: For each mesh "ao" (n,), "bent" (n, 3) and "light.NAME" (n, 3), if baked.
    meshes: list[dict[str, FloatArray]] = field(default_factory=list)
    #: Mean ambient occlusion of each instance in the file's order, (k,); empty if not baked.
    instance_ao: FloatArray = field(default_factory=lambda: np.zeros(0, np.float32))


class Scene:
    """Geometry, materials, lights and cameras. Made by load() or Scene.from_arrays().

    The first query builds a BVH and keeps it until the scene is changed. A scene may be used by
    several threads; dapple does one call at a time, each on all cores.
    """

    def __init__(self, native: _native.Scene) -> None:
        self._native = native

    @classmethod
    def from_arrays(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        opacity: float | npt.ArrayLike = 1.0,
    ) -> Scene:
        """A scene of one mesh.

        vertices: (n, 3), metres. triangles: (m, 3) indices of vertices. opacity: of all triangles
        or (m,), in [0, 1]. Raises UsageError for other shapes, indices or values.
        """
        positions = _arrays.vectors("vertices", vertices)
        corners = _arrays.indices("triangles", triangles, len(positions))
        values, which = _arrays.opacities(opacity, len(corners))
        return cls(_native.from_arrays(positions, corners.reshape(-1), values, which))

    def __repr__(self) -> str:
        meshes = len(self._native.mesh_names)
        lights = len(self._native.light_names)
        return f"<dapple.Scene {self._native.source}: {meshes} meshes, {lights} lights>"

    @property
    def meshes(self) -> list[Mesh]:
        """The meshes, before instancing."""
        native = self._native
        return [
            Mesh(name, native.positions(i), native.indices(i), native.instances(i))
            for i, name in enumerate(native.mesh_names)
        ]

    @property
    def materials(self) -> list[str]:
        """Names of the materials."""
        return list(self._native.material_names)

    @property
    def lights(self) -> list[str]:
        """Names of the lights, as the results have them."""
        return list(self._native.light_names)

    @property
    def warnings(self) -> list[str]:
        """What the reader skipped, a line each."""
        return list(self._native.warnings)

    @property
    def bounds(self) -> FloatArray:
        """(2, 3): least and largest coordinates in world space, metres."""
        return np.array(self._native.bounds, np.float32)

    def set_opacity(self, material: str, value: float) -> None:
        """Gives a material the opacity `value`, in [0, 1], in place of textures and factors."""
        self._native.override_opacity(material, value)

    def add_ground(self) -> None:
        """Adds an opaque square under the lowest point, 20 times as wide as the scene."""
        self._native.add_ground()

    def clear_lights(self) -> None:
        """Removes all lights."""
        self._native.clear_lights()

    def add_lights(self, path: str | PathLike[str]) -> None:
        """Adds the lights of a JSON file (docs/formats.md)."""
        self._native.add_lights(fspath(path))

    def add_sun(
        self,
        direction: Sequence[float],
        irradiance: float = 1.0,
        angular_diameter: float = 0.533,
        name: str = "sun",
    ) -> None:
        """Adds a sun.

        direction: towards it, of any length. irradiance: on a plane across it, W/m^2.
        angular_diameter: degrees.
        """
        x, y, z = (float(v) for v in direction)
        self._native.add_sun((x, y, z), irradiance, angular_diameter, name)

    def add_sky(self, kind: str | PathLike[str] = "uniform", irradiance: float = 1.0) -> None:
        """Adds a sky as the light "sky".

        kind: "uniform", "overcast" (CIE standard overcast: Moon and Spencer, 1942) or a
        latitude-longitude image (.exr, .hdr). irradiance: on an open horizontal plane, W/m^2; for
        an image a factor.
        """
        self._native.add_sky(fspath(kind), irradiance)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes meshes, instances, materials without textures, and cameras as one GLB file."""
        self._native.write_glb(fspath(path))

    def occlusion(
        self,
        points: npt.ArrayLike,
        normals: npt.ArrayLike,
        *,
        device: str = "",
        progress: Progress = None,
        **options: Unpack[_options.OcclusionOptions],
    ) -> FloatArray:
        """Ambient occlusion at points, (n,) float32 in [0, 1]; 1: nothing occludes.

        points: (n, 3), metres. normals: (n, 3) unit vectors, or one for all. Options: rays (64) a
        point; estimator "prefiltered" or "exact"; footprint (4): larger is faster, 0 is exact;
        distance (0: no limit), metres; falloff (0); seed (0). The same arguments give the same
        bits. progress is called with fractions in [0, 1]; an exception of it ends the call.
        """
        at, facing = _points(points, normals)
        if len(at) == 0:
            return np.zeros(0, np.float32)
        chosen = _options.apply("occlusion", _native.OcclusionOptions(), options)
        return _native.occlusion(self._native, at, facing, chosen, device, progress)

    def irradiance(
        self,
        points: npt.ArrayLike,
        normals: npt.ArrayLike,
        *,
        device: str = "",
        progress: Progress = None,
        **options: Unpack[_options.QueryOptions],
    ) -> dict[str, Irradiance]:
        """Irradiance of each light at points, by the lights' names.

        Arguments as for occlusion(); rays (16) are for each point and light.
        """
        at, facing = _points(points, normals)
        chosen = _options.apply("irradiance", _native.IrradianceOptions(), options)
        found = _native.irradiance(self._native, at, facing, chosen, device, progress)
        return {name: Irradiance(*arrays) for name, arrays in found}

    def measure(
        self,
        points: npt.ArrayLike,
        normals: npt.ArrayLike = (0.0, 1.0, 0.0),
        *,
        suns: npt.ArrayLike = (),
        sun_irradiance: float | npt.ArrayLike = 1.0,
        periodic: tuple[float, float] | None = None,
        progress: Progress = None,
        **options: Unpack[_options.MeasureOptions],
    ) -> dict[str, FloatArray]:
        """Columns of numbers at points, (n,) float32 each, as `dapple points` writes them.

        ao, sky_view_factor, gap_N (rings), bent_x and so on, NAME_r and so on of lights in W/m^2,
        and sun or sun_N; with "_error" their standard errors. suns: (s, 3) directions towards
        suns; sun_irradiance: W/m^2 across them, one or (s,). periodic: the scene repeats itself
        with these periods along X and Z, metres. Options: ao, sky_view_factor, bent, rings, lights,
        per_sun, rays (256), estimator, footprint, distance, opacity by material, ground, seed,
        device, cache.
        """
        at, facing = _points(points, normals)
        towards = _arrays.vectors("suns", suns)
        towards = _arrays.unit_vectors("suns", towards, len(towards))
        strength = np.asarray(sun_irradiance, np.float32)
        if strength.shape not in ((), (len(towards),)):
            raise UsageError("sun_irradiance must be a number or one for each sun")
        chosen = _options.apply("measure", _native.PointOptions(), options)
        if periodic is not None:
            chosen.period_x, chosen.period_z = periodic
        across = np.ascontiguousarray(np.broadcast_to(strength, (len(towards),)))
        columns = _native.measure(self._native, at, facing, chosen, towards, across, progress)
        return dict(columns)

    def render(self, *, progress: Progress = None, **options: Unpack[_options.RenderOptions]) -> Picture:
        """Renders a picture. Options are those of `dapple render`.

        width (960), height (540), spp (16), target_rmse, target_error, ao, light, ao_distance,
        estimator, footprint, camera by name, look=(from, at, up) with fov_degrees,
        crop=(x0, y0, x1, y1) inclusive, opacity={"leaf": 0.85}, ground, seed and others.
        """
        chosen = _options.apply("render", _native.RenderOptions(), options)
        return Picture(_native.render(self._native, chosen, progress))

    def bake(
        self,
        *,
        occluders: Iterable[Scene] = (),
        progress: Progress = None,
        **options: Unpack[_options.BakeOptions],
    ) -> Bake:
        """Bakes values at the vertices of the meshes. Options are those of `dapple bake`.

        bent, light and instances add values beside AO. occluders occlude but are not baked. The
        command can also write glTF files and textures.
        """
        chosen = _options.apply("bake", _native.BakeOptions(), options)
        others = [scene._native for scene in occluders]
        meshes, instance_ao = _native.bake(self._native, chosen, others, progress)
        return Bake([dict(arrays) for arrays in meshes], instance_ao)


def _points(points: npt.ArrayLike, normals: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    at = _arrays.vectors("points", points)
    return at, _arrays.unit_vectors("normals", normals, len(at))


def load(
    path: str | PathLike[str],
    *,
    time: float | None = None,
    animation: str = "",
    allow_outside: bool = False,
) -> Scene:
    """Reads a scene: glTF 2.0 (.gltf, .glb), strands (.hair), or "scene:tree?leaves=50000".

    time: seconds, of the pose; None: at rest. animation: by name, "*" for all, empty: the first.
    allow_outside: buffers and images may be outside of the file's folder. Raises InputError.
    """
    return Scene(_native.load(fspath(path), time, animation, allow_outside))
