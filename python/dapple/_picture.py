"""Pictures as named NumPy arrays."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Mapping, NoReturn, Sequence

import numpy as np

from . import _arguments, _native
from ._arrays import FloatArray
from ._errors import UsageError
from ._results import Bias, biases

if TYPE_CHECKING:
    from typing import Literal

    import xarray


def _layer_of(channel: str) -> str:
    return channel.rpartition(".")[0] or channel


def _color(name: str, values: Sequence[float]) -> tuple[float, ...]:
    color = _arguments.several(name, values, 3)
    if not all(0 <= channel <= 1 for channel in color):
        raise UsageError(f"{name} is {values!r}; colours are from 0 to 1")
    return color


class Picture(Mapping[str, FloatArray]):
    """What render() returns: float32 arrays by channel or layer, row 0 at the top.

    `picture["ao.R"]` is one channel, (height, width), read-only and without a copy;
    `picture["ao"]` all channels of a layer, (height, width, channels), in their order in
    `picture.channels`. Channels without a layer (R, G, B, A) are also `picture["RGBA"]`.
    Layers and their units are those of the EXR files (docs/layers.md).

    >>> picture = dapple.load("scene:demo").render(width=32, height=18, spp=4)
    >>> picture["ao.R"].shape, picture["RGBA"].shape
    ((18, 32), (18, 32, 4))
    >>> "Z" in picture, picture.metadata["scene"]
    (True, 'scene:demo')
    """

    def __reduce__(self) -> NoReturn:
        raise TypeError("a dapple.Picture cannot be pickled: its channels can, or save() it")

    def __init__(self, native: _native.Picture) -> None:
        self._native = native
        #: Names of the channels, such as "ao.R".
        self.channels: list[str] = list(native.channels)
        #: Settings that the picture was made with.
        self.metadata: dict[str, str] = dict(native.metadata)
        #: What the program would say, such as "no camera in the scene: added one".
        self.notes: list[str] = list(native.notes)
        #: With a target: estimated root mean square of the pixels' errors, by layer.
        self.rmse: dict[str, float] = dict(native.rmse)
        #: By layer, such as "ao"; empty for exact rays and report_bias=0.
        self.bias: dict[str, Bias] = biases(native.bias)
        #: What rmse and bias of lights are relative to, by layer: the largest irradiance without
        #: occlusion, W/m^2, luminance. Empty where neither is known.
        self.largest_irradiance: dict[str, float] = dict(native.largest_irradiance)
        #: As given, or a smaller one that was chosen; without effect on exact rays.
        self.footprint: float = native.footprint
        self._layers: dict[str, list[str]] = {}
        for channel in self.channels:
            if "." in channel:
                self._layers.setdefault(_layer_of(channel), []).append(channel)
        colours = [c for c in "RGBA" if c in self.channels]
        if len(colours) == 4:
            self._layers["RGBA"] = colours

    # Comparing arrays gives arrays: a picture equals itself alone.
    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def __getitem__(self, name: str) -> FloatArray:
        if not isinstance(name, str):
            raise KeyError(name)
        if name in self._layers:
            return np.stack([self[c] for c in self._layers[name]], axis=-1)
        array: FloatArray = self._native.pixels(name)
        return array

    def __iter__(self) -> Iterator[str]:
        yield from self._layers
        yield from (c for c in self.channels if "." not in c and c not in "RGBA")

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        height, width = self[self.channels[0]].shape
        return f"<dapple.Picture {width}x{height}: {', '.join(self)}>"

    def save(
        self,
        path: str | PathLike[str],
        layer: str = "",
        *,
        half: Iterable[str] = (),
        compression: Literal["zip", "zips", "piz", "dwaa", "none"] = "zip",
        multipart: bool = False,
        exposure: float | None = None,
        background: Literal["sky", "none"] | Sequence[float] = "sky",
    ) -> None:
        """Writes .exr with all layers, or .png with a preview of `layer` (empty: the picture).

        EXR: half are layers of 16 bits, such as "ao" and "light" for all lights, or ["all"];
        compression "dwaa" is lossy and needs multipart, a part for each layer. PNG: exposure in
        stops (None: automatic) and background ("none": an alpha channel; or linear R, G, B in
        [0, 1]) are of the picture, not of layers.

        >>> picture = dapple.load("scene:demo").render(width=32, height=18, spp=4)
        >>> picture.save("demo.exr", half=["ao", "albedo"])
        >>> picture.save("demo.png", layer="ao")
        """
        text = _arguments.path("path", path)
        if text.lower().endswith(".png"):
            stops = None if exposure is None else _arguments.number("exposure", exposure)
            if stops is not None and not -100 <= stops <= 100:
                raise UsageError(f"exposure is {stops:g}; it must be from -100 to 100")
            color = None if isinstance(background, str) else _color("background", background)
            if color is None and background not in ("sky", "none"):
                raise UsageError(f"background is {background!r}; it must be sky, none or a colour")
            name = _arguments.text("layer", layer)
            self._native.write_png(text, name, stops, color is None and background == "sky", color)
        elif text.lower().endswith(".exr"):
            if layer:
                raise UsageError("layer is for .png; an EXR has all layers")
            layers = _arguments.texts("half", half)
            for name in layers:
                if name != "all" and not any(f"{of}.".startswith(f"{name}.") for of in self):
                    raise UsageError(f"half: there is no layer {name}")
            name = _arguments.text("compression", compression)
            self._native.write_exr(text, layers, name, bool(multipart))
        else:
            raise UsageError(f"{text}: pictures are saved as .exr or .png")

    def save_deep(self, path: str | PathLike[str]) -> None:
        """Writes a deep EXR: A and Z of what camera rays pass through, of render(deep=True).

        >>> dapple.load("scene:demo").render(width=32, height=18, deep=True).save_deep("deep.exr")
        """
        text = _arguments.path("path", path)
        if not text.lower().endswith(".exr"):
            raise UsageError(f"{text}: deep pictures are saved as .exr")
        self._native.write_deep_exr(text)

    def to_xarray(self) -> xarray.Dataset:
        """All layers as an xarray.Dataset with the dimensions y, x and channel. Needs xarray.

        >>> picture = dapple.load("scene:demo").render(width=32, height=18, spp=4)
        >>> picture.to_xarray()["ao"].dims
        ('y', 'x', 'channel_ao')
        """
        import xarray

        variables: dict[str, Any] = {}
        for name in self:
            array = self[name]
            dimensions = ("y", "x") if array.ndim == 2 else ("y", "x", "channel_" + name)
            variables[name] = (dimensions, array)
        coordinates: dict[str, Any] = {
            "channel_" + name: [c.rpartition(".")[2] for c in channels]
            for name, channels in self._layers.items()
        }
        return xarray.Dataset(variables, coordinates, attrs=dict(self.metadata))
