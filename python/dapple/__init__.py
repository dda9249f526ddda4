"""How much of the sky and of lights gets through foliage, hair and forests.

>>> import dapple
>>> scene = dapple.Scene.from_arrays(
...     [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]], [[0, 1, 2], [0, 2, 3]], opacity=0.5)
>>> ao = scene.occlusion([[0, 0, 0], [9, 0, 9]], [0, 1, 0], rays=4096)
>>> print(ao.round(2))
[0.72 1.  ]

Examples of the docstrings begin with `import dapple` and `import numpy as np`.

World space is right-handed, +Y up, in metres, as in glTF. Directions are unit vectors. Everything
is of first order: light that scatters off a surface is not followed.
"""

from . import _drivers

_drivers.use_driver_of_pip()

from ._errors import DeviceError, Error, InputError, UsageError  # noqa: E402
from ._load import load  # noqa: E402
from ._native import devices, keep_kernels as _keep_kernels, version as _version  # noqa: E402
from ._picture import Picture  # noqa: E402
from ._results import Bake, BakedTexture, Bias, Columns, Irradiance, Mesh  # noqa: E402
from ._scene import Scene  # noqa: E402

__version__ = _version()
_drivers.at_exit(_keep_kernels)  # compiled kernels, for later processes

__all__ = [
    "Bake",
    "BakedTexture",
    "Bias",
    "Columns",
    "DeviceError",
    "Error",
    "InputError",
    "Irradiance",
    "Mesh",
    "Picture",
    "Scene",
    "UsageError",
    "__version__",
    "devices",
    "load",
]
