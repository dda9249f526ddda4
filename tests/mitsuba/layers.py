"""What both renderers return: a Layer for each quantity.

Quantities are "ao", in [0,1], and the irradiances "rect", "disk", "sphere", "dome.R", "dome.G" and
"dome.B".
"""

from dataclasses import dataclass

import numpy as np

SIZE = 64  # of images, pixels square


@dataclass
class Layer:
    """Images (height, width); `values` are premultiplied by the `alpha` of the same samples."""

    values: np.ndarray
    alpha: np.ndarray


def channels_of(kind):
    """The colour channels of a light that are compared, and the names of the quantities."""
    if kind == "dome":
        return [(0, "dome.R"), (1, "dome.G"), (2, "dome.B")]
    return [(1, kind)]
