"""Scenes and what can be asked of them."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Iterable, Mapping, NoReturn, Sequence

import numpy as np
import numpy.typing as npt

from . import _arguments, _arrays, _native, _options
from ._arguments import Progress
from ._arrays import FloatArray, IndexArray
from ._errors import UsageError
from ._picture import Picture
from ._results import Bake, Columns, Irradiance, Mesh, bake_of, biases

if TYPE_CHECKING:
    from typing_extensions import Unpack

class Scene:
    """Geometry, materials, lights and cameras. Made by load() or Scene.from_arrays().

    The first call of occlusion() or irradiance() builds a BVH and keeps it until the scene is
    changed; measure(), render() and bake() build theirs each time. A scene may be used by
    several threads; dapple does one call at a time, each on all cores.

    >>> scene = dapple.load("scene:tree?leaves=100")
    >>> scene
    <dapple.Scene scene:tree?leaves=100: 1 meshes, 0 lights>
    """

    def __init__(self, native: _native.Scene) -> None:
        if not isinstance(native, _native.Scene):
            raise UsageError("scenes are made by dapple.load() or dapple.Scene.from_arrays()")
        self._native = native

    @classmethod
    def from_arrays(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        opacity: float | npt.ArrayLike = 1.0,
        materials: Sequence[str] | npt.ArrayLike | None = None,
    ) -> Scene:
        """A scene of one mesh.

        vertices: (n, 3), metres. triangles: (m, 3) indices of vertices. opacity: of all triangles
        or (m,), in [0, 1]. materials: (m,) names or whole numbers, such as those of organs, for
        set_opacity(); the opacity of each must be one. None: a material for each opacity, called
        "0", "1" and so on in the order of the triangles. Raises UsageError for other shapes,
        indices or values. Vertices become float32; a UserWarning says where these are too coarse,
        so far from the origin (map coordinates) that details are lost: take a point of the plot
        off all coordinates first.

        >>> corners = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
        >>> square = dapple.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], opacity=[0.2, 0.8])
        >>> square.occlusion([[0, 0, 0]], [0, 1, 0], rays=4096).round(2)
        array([0.72], dtype=float32)
        """
        positions = _arrays.vectors("vertices", vertices)
        _arrays.warn_of_coarse_steps("vertices", positions)
        corners = _arrays.indices("triangles", triangles, len(positions))
        known, which = _arrays.materials(opacity, materials, len(corners))
        return cls(_native.from_arrays(positions, corners.reshape(-1), known, which))

    def copy(self) -> Scene:
        """A copy that can be changed without changing this scene. It takes no memory before that.

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> lit = tree.copy()
        >>> lit.add_sun([0, 1, 0])
        >>> tree.lights, lit.lights
        ([], ['sun'])
        """
        return Scene(self._native.copy())

    __copy__ = copy

    def __deepcopy__(self, memo: object) -> Scene:
        return self.copy()

    def __reduce__(self) -> NoReturn:
        raise TypeError("a dapple.Scene cannot be pickled: load it in each process")

    def __repr__(self) -> str:
        meshes = len(self._native.mesh_names)
        lights = len(self._native.light_names)
        return f"<dapple.Scene {self._native.source}: {meshes} meshes, {lights} lights>"

    @property
    def meshes(self) -> list[Mesh]:
        """The meshes, before instancing.

        >>> mesh = dapple.load("scene:forest?trees=3&leaves=100").meshes[1]
        >>> mesh.positions.shape[1], mesh.triangles.shape[1], mesh.instances.shape[1:]
        (3, 3, (4, 4))
        """
        native = self._native
        return [
            Mesh(name, native.positions(i), native.indices(i), native.instances(i))
            for i, name in enumerate(native.mesh_names)
        ]

    @property
    def materials(self) -> list[str]:
        """Names of the materials.

        >>> dapple.load("scene:tree?leaves=100").materials
        ['leaf', 'bark']
        """
        return list(self._native.material_names)

    @property
    def lights(self) -> list[str]:
        """Names of the lights. Those of a group share a layer of the group's name, but for irradiance().

        >>> dapple.load("scene:demo").lights
        ['sun', 'sky']
        """
        return list(self._native.light_names)

    @property
    def warnings(self) -> list[str]:
        """What the reader skipped, a line each.

        >>> dapple.load("scene:tree?leaves=100").warnings
        []
        """
        return list(self._native.warnings)

    @property
    def bounds(self) -> FloatArray:
        """(2, 3): least and largest coordinates in world space, metres.

        >>> dapple.Scene.from_arrays([[0, 0, 0], [3, 0, 0], [0, 2, 0]], [[0, 1, 2]]).bounds
        array([[0., 0., 0.],
               [3., 2., 0.]], dtype=float32)
        """
        return np.array(self._native.bounds, np.float32)

    def set_opacity(self, material: str, value: float) -> None:
        """Gives a material the opacity `value`, in [0, 1], in place of textures and factors.

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> tree.set_opacity("leaf", 0.5)
        """
        self._native.override_opacity(
            _arguments.text("material", material), _arguments.number("value", value)
        )

    def add_ground(self) -> None:
        """Adds an opaque square under the lowest point, 200 times as wide as the scene.

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> tree.add_ground()
        >>> len(tree.meshes)
        2
        """
        self._native.add_ground()

    def clear_lights(self) -> None:
        """Removes all lights.

        >>> demo = dapple.load("scene:demo")
        >>> demo.clear_lights()
        >>> demo.lights
        []
        """
        self._native.clear_lights()

    def add_lights(self, path: str | PathLike[str]) -> None:
        """Adds the lights of a JSON file (docs/formats.md).

        >>> from pathlib import Path
        >>> text = '{"lights": [{"name": "noon", "type": "sun", "direction": [0, -1, 0], '
        >>> text += '"irradiance": [900, 900, 900]}]}'
        >>> _ = Path("noon.json").write_text(text)
        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> tree.add_lights("noon.json")
        >>> tree.lights
        ['noon']
        """
        self._native.add_lights(_arguments.path("path", path))

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

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> tree.add_sun([0, 1, 0], irradiance=1000)
        >>> tree.irradiance([[50, 0, 0]], [0, 1, 0])["sun"].irradiance.round()
        array([[1000., 1000., 1000.]], dtype=float32)
        """
        towards = _arguments.several("direction", direction, 3)
        strength = _arguments.number("irradiance", irradiance)
        degrees = _arguments.number("angular_diameter", angular_diameter)
        self._native.add_sun(towards, strength, degrees, _arguments.text("name", name))

    def add_sky(
        self, kind: str | PathLike[str] = "uniform", irradiance: float = 1.0, rotation: float = 0.0
    ) -> None:
        """Adds a sky as the light "sky".

        kind: "uniform", "overcast" (CIE standard overcast: Moon and Spencer, 1942) or a
        latitude-longitude image (.exr, .hdr). irradiance: on an open horizontal plane, W/m^2; for
        an image a factor. rotation: of the image about +Y, degrees, from +Z towards +X.

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> tree.add_sky("overcast", irradiance=120)
        >>> sky = tree.irradiance([[50, 0, 0]], [0, 1, 0], rays=1024)["sky"]
        >>> bool(abs(sky.unoccluded[0, 0] - 120) < 2)
        True
        """
        strength = _arguments.non_negative("irradiance", irradiance)
        turn = _arguments.finite("rotation", rotation)
        self._native.add_sky(_arguments.path("kind", kind), strength, turn)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes meshes, instances, materials without textures, and cameras as one .glb file.

        >>> dapple.load("scene:tree?leaves=100").save("tree.glb")
        >>> dapple.load("tree.glb").materials
        ['leaf', 'bark']
        """
        text = _arguments.path("path", path)
        if not text.lower().endswith(".glb"):
            raise UsageError(f"{text}: scenes are saved as .glb")
        self._native.write_glb(text)

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
        point; estimator "prefiltered" or "exact"; footprint (8): larger is faster, 0 is exact;
        distance (0: no limit), metres; falloff (0); seed (0). The same arguments give the same
        bits. progress is called with fractions in [0, 1]; an exception of it ends the call.

        Prefiltered values are biased: by some thousandths in foliage, by up to a tenth where few
        large surfaces, such as a roof, hide much of the sky. measure() corrects that and tells
        standard errors; estimator="exact" has no bias.

        >>> tree = dapple.load("scene:tree?leaves=1000")
        >>> ao = tree.occlusion([[0, 0.01, 0.5], [50, 0.01, 0]], [0, 1, 0], rays=256)
        >>> bool(ao[0] < 0.9), bool(ao[1] > 0.98)
        (True, True)
        """
        at, facing = _arrays.points_with_normals(points, normals)
        chosen = _options.apply("occlusion", _native.OcclusionOptions(), options, ("device", "progress"))
        progress = _arguments.progress_function(progress)
        name = _arguments.text("device", device)
        if len(at) == 0:
            return np.zeros(0, np.float32)
        return _native.occlusion(self._native, at, facing, chosen, name, progress)

    def irradiance(
        self,
        points: npt.ArrayLike,
        normals: npt.ArrayLike,
        *,
        device: str = "",
        progress: Progress = None,
        **options: Unpack[_options.QueryOptions],
    ) -> dict[str, Irradiance]:
        """Irradiance of each light at points, W/m^2, (n, 3) linear RGB, by the lights' names.

        Arguments as for occlusion(), without distance and falloff; rays (16) are for each point
        and light; footprint (4). Biased as occlusion() is, with as few rays by more.

        >>> corners = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
        >>> square = dapple.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], opacity=0.25)
        >>> square.add_sun([0, 1, 0], irradiance=1000)
        >>> sun = square.irradiance([[0, 0, 0]], [0, 1, 0])["sun"]
        >>> sun.irradiance.round(), sun.unoccluded.round()
        (array([[750., 750., 750.]], dtype=float32), array([[1000., 1000., 1000.]], dtype=float32))
        """
        at, facing = _arrays.points_with_normals(points, normals)
        chosen = _options.apply("irradiance", _native.IrradianceOptions(), options, ("device", "progress"))
        progress = _arguments.progress_function(progress)
        name = _arguments.text("device", device)
        found = _native.irradiance(self._native, at, facing, chosen, name, progress)
        return {light: Irradiance(*arrays) for light, arrays in found}

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
    ) -> Columns:
        """Columns of numbers at points, (n,) float32 each, as `dapple points` writes them.

        ao, sky_view_factor, gap_N (rings), bent_x and so on, NAME_r and so on of lights in W/m^2,
        and sun or sun_N; with "_error" their standard errors. suns: (s, 3) directions towards
        suns, disks of 0.533 degrees; sun_irradiance: W/m^2 across them, one or (s,). periodic: the
        scene repeats itself with these periods along X and Z, metres. The result is a dict with
        .bias (by quantity), .footprint and .notes. Raises UsageError, and InputError where nothing
        is opaque.

        Options: ao, sky_view_factor (True), bent (False), rings (0; 1 to 90), lights (True: those
        of the scene), per_sun (False), rays (256; 8 to 2**20) a point and quantity, estimator,
        footprint (0 or more), max_bias and report_bias in [0, 1], distance (metres; 0: no limit),
        falloff (0 or more), opacity by material in [0, 1], ground (False), seed, device, cache.

        >>> tree = dapple.load("scene:tree?leaves=1000")
        >>> columns = tree.measure([[0, 0.01, 0.5]], rings=2)
        >>> list(columns)[:4]
        ['ao', 'ao_error', 'sky_view_factor', 'sky_view_factor_error']
        >>> columns["gap_1"].shape
        (1,)
        """
        at, facing = _arrays.points_with_normals(points, normals)
        towards = _arrays.vectors("suns", suns)
        towards = _arrays.unit_vectors("suns", towards, len(towards))
        across = _arrays.irradiances("sun_irradiance", sun_irradiance, len(towards))
        if isinstance(suns, tuple) and not suns and (np.any(np.asarray(sun_irradiance) != 1.0) or options.get("per_sun")):
            raise UsageError("sun_irradiance and per_sun need suns")
        arguments = ("suns", "sun_irradiance", "periodic", "progress")
        chosen = _options.apply("measure", _native.PointOptions(), options, arguments)
        if periodic is not None:
            chosen.period_x, chosen.period_z = _arguments.several("periodic", periodic, 2)
            if chosen.period_x == 0 or chosen.period_z == 0:  # as float32; 0 would be no period
                raise UsageError(f"periodic is {periodic}; it must be two periods above 0, metres")
        progress = _arguments.progress_function(progress)
        columns, bias, footprint, notes = _native.measure(
            self._native, at, facing, chosen, towards, across, progress
        )
        return Columns(columns, biases(bias), footprint, notes)

    def render(self, *, progress: Progress = None, **options: Unpack[_options.RenderOptions]) -> Picture:
        """Renders a picture, float32 arrays (height, width). Options are those of `dapple render`.

        Size and samples: width (960), height (540), crop=(x0, y0, x1, y1) inclusive, pixels; spp (16),
        target_rmse, target_error in [0, 1] with max_spp; camera_splitting, ao_rays, light_rays.
        View: camera by name, or look=(from, at, up) in metres with fov_degrees; aperture, focus_distance,
        metres. Layers: ao, light, albedo (True), beauty, back with back_every, deep, visits,
        crypto_object, crypto_material (False). Rays: estimator, footprint (4), roulette, max_bias, report_bias,
        normals, packets, seed; ao_distance (metres), ao_falloff. Scene: opacity={"leaf": 0.85},
        ground with ground_height (its y, metres; None: just below the scene), ambient (radiance of a
        uniform sky in RGBA, W/(sr m^2); None: chosen); device, cache.

        >>> picture = dapple.load("scene:demo").render(width=32, height=18, spp=4)
        >>> picture["ao"].shape, picture["Z"].shape
        ((18, 32, 3), (18, 32))
        """
        chosen = _options.apply("render", _native.RenderOptions(), options, ("progress",))
        progress = _arguments.progress_function(progress)
        return Picture(_native.render(self._native, chosen, progress))

    def bake(
        self,
        *,
        occluders: Iterable[Scene] = (),
        texture_uvs: Iterable[npt.ArrayLike] = (),
        progress: Progress = None,
        **options: Unpack[_options.BakeOptions],
    ) -> Bake:
        """Bakes values at the vertices of the meshes. Options are those of `dapple bake`.

        vertices, instances, texture, bent, light: what is baked, True or False. rays (with a target_error
        at most), light_rays, target_error in [0, 1], estimator, footprint, normals, report_bias,
        max_bias, distance (m), falloff, at_vertices, sides ("auto", "front", "max", "mean"),
        placement ("together", "alone"), seed, ground, opacity (by material), device, cache. The
        texture has texture_size (1024) texels a side, and values go on beyond charts for margin (16)
        texels. texture_uvs: for each mesh texture coordinates of its vertices, (n, 2) in [0, 1]
        without overlaps; none: charts of dapple's own.

        Each mesh has "ao" (n,) in [0, 1]. bent, light and instances add values beside AO: unit
        vectors (n, 3), W/m^2 (n, 3), and means over the surface of each instance. occluders occlude
        but are not baked. The command writes all that into glTF files.

        >>> tree = dapple.load("scene:tree?leaves=100")
        >>> baked = tree.bake(rays=64)
        >>> baked.meshes[0]["ao"].shape == tree.meshes[0].positions.shape[:1]
        True
        """
        arguments = ("occluders", "texture_uvs", "progress")
        chosen = _options.apply("bake", _native.BakeOptions(), options, arguments)
        scenes = _arguments.list_of("occluders", occluders, Scene, "scenes")
        others = [scene._native for scene in scenes]
        uvs = _arrays.texture_uvs(texture_uvs)
        if uvs and not chosen.texture:
            raise UsageError("bake(): texture_uvs needs texture=True")
        progress = _arguments.progress_function(progress)
        return bake_of(*_native.bake(self._native, chosen, uvs, others, progress))
