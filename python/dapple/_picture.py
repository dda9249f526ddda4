"""Pictures as named NumPy arrays."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any, Iterator, Mapping

import numpy as np

from . import _arguments, _native
from ._arrays import FloatArray
from ._errors import UsageError

if TYPE_CHECKING:
    import xarray


def _layer_of(channel: str) -> str:
    return channel.rpartition(".")[0] or channel


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
        self._layers: dict[str, list[str]] = {}
        for channel in self.channels:
            if "." in channel:
                self._layers.setdefault(_layer_of(channel), []).append(channel)
        colours = [c for c in "RGBA" if c in self.channels]
        if len(colours) == 4:
            self._layers["RGBA"] = colours

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

    def save(self, path: str | PathLike[str], layer: str = "") -> None:
        """Writes .exr with all layers, or .png with a preview of `layer` (empty: the picture).

        >>> picture = dapple.load("scene:demo").render(width=32, height=18, spp=4)
        >>> picture.save("demo.exr")
        >>> picture.save("demo.png", layer="ao")
        """
        text = _arguments.path("path", path)
        if text.lower().endswith(".png"):
            self._native.write_png(text, _arguments.text("layer", layer))
        elif text.lower().endswith(".exr"):
            self._native.write_exr(text)
        else:
            raise UsageError(f"{text}: pictures are saved as .exr or .png")

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
