"""Meshes and strands as shapes of Mitsuba, white on both sides, with opacities as masks."""

import mitsuba as mi
import numpy as np

from geometry import Strands
from strands import write_curves

CUTOUT_TEXELS = 16  # into which a texel of a bilinear cut-out is divided, along both axes


def shape_of(content, path):
    """Mitsuba's description of a mesh or of strands; its geometry goes into a file."""
    if isinstance(content, Strands):
        path = path.with_suffix(".txt")
        write_curves(path, content)
        shape = {"type": "linearcurve", "filename": str(path)}
        return {**shape, "bsdf": masked({"type": "rgb", "value": content.opacity})}
    path = path.with_suffix(".ply")
    write_ply(path, content)
    shape = {"type": "ply", "filename": str(path), "face_normals": True}
    return {**shape, "bsdf": masked(opacity_of(content.material))}


def masked(opacity):
    """White on both sides; what `opacity` leaves goes straight on."""
    white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}}
    surface = {"type": "twosided", "bsdf": white}
    if opacity is None:
        return surface
    return {"type": "mask", "opacity": opacity, "bsdf": surface}


def opacity_of(material):
    """Mitsuba's texture, or None for opaque surfaces. Of a bilinear cut-out, which Mitsuba cannot
    threshold, the thresholded texture in small nearest texels."""
    texture = material.texture
    if texture is None:
        return {"type": "rgb", "value": material.factor} if material.factor < 1 else None
    alpha, nearest = material.factor * texture.alpha, texture.nearest
    if material.cutoff is not None:
        if not nearest:
            alpha, nearest = magnified(alpha, CUTOUT_TEXELS), True
        alpha = (alpha >= material.cutoff).astype(np.float32)
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(alpha[:, :, np.newaxis], np.float32)),
        "raw": True,
        "filter_type": "nearest" if nearest else "bilinear",
        "wrap_mode": texture.wrap,
    }


def magnified(alpha, times):
    """Bilinear between the centres of texels, with the borders wrapped around."""
    for axis in (0, 1):
        at = (np.arange(alpha.shape[axis] * times) + 0.5) / times - 0.5
        first = np.floor(at).astype(int)
        weight = np.expand_dims(at - first, 1 - axis)
        count = alpha.shape[axis]
        alpha = (1 - weight) * np.take(alpha, first % count, axis) + weight * np.take(
            alpha, (first + 1) % count, axis
        )
    return alpha


def write_ply(path, mesh):
    """Binary PLY. Texture coordinates are called u and v, as Mitsuba wants them."""
    columns = [mesh.positions.astype("<f4")]
    names = ["x", "y", "z"]
    if mesh.uv is not None:
        columns.append(mesh.uv.astype("<f4"))
        names += ["u", "v"]
    faces = np.empty(len(mesh.triangles), [("count", "u1"), ("index", "<i4", 3)])
    faces["count"], faces["index"] = 3, mesh.triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.positions)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    vertices = np.ascontiguousarray(np.concatenate(columns, axis=1))
    path.write_bytes("\n".join(header).encode() + b"\n" + vertices.tobytes() + faces.tobytes())
