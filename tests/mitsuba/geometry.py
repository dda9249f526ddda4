"""What both renderers are given: meshes with a material, and strands. Units are metres.

Mitsuba's side of a scene is made of these alone; dapple reads the file that they come from.
"""

from dataclasses import dataclass

import numpy as np


@dataclass
class Texture:
    """Alphas in [0,1], rows from the top, as glTF's texture coordinates count them."""

    alpha: np.ndarray
    nearest: bool = False
    wrap: str = "repeat"


@dataclass
class Material:
    """Opacity as glTF defines it: `factor` times the texture's alpha, thresholded by `cutoff`."""

    factor: float = 1.0
    cutoff: float | None = None
    texture: Texture | None = None


@dataclass
class Mesh:
    """Triangles in world space: (n, 3) positions, (n, 2) texture coordinates, (m, 3) indices."""

    positions: np.ndarray
    triangles: np.ndarray
    material: Material
    uv: np.ndarray | None = None


@dataclass
class Strands:
    """Strands of equally many points: (strands, points, 3) positions, (strands, points) radii."""

    points: np.ndarray
    radii: np.ndarray
    opacity: float
