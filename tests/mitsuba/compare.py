"""Compares dapple's exact mode with Mitsuba 3: compare.py DAPPLE [SCENE...]

Renders each scene twice with either program, by different seeds, which are fixed. What must hold:

- The means over what is seen differ by at most LIMIT.
- The standard error of that difference, from the two seeds, is small enough to tell.
- What pixels differ by beyond their noise is small, so that differences which cancel in the mean are
  found.

Coverage (mean alpha) and AO are absolute. Irradiances are relative to the 99th percentile of
Mitsuba's pixels of that light: at most the largest irradiance without occlusion, the unit of
docs/accuracy.md.
Exit code 1: something differs.
"""

import shutil
import signal
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

from dapple_renderer import Dapple  # noqa: E402  (after the variant is set)
from layers import Layer  # noqa: E402
from lights import check_dome  # noqa: E402
from mitsuba_renderer import Mitsuba  # noqa: E402
from scenes import SCENES  # noqa: E402

LIMIT = 0.002
LARGEST_STANDARD_ERROR = LIMIT / 3
LARGEST_DEVIATION = 5 * LIMIT
SEEDS = (1, 2)


@dataclass
class Comparison:
    """Means over what is seen, in the quantity's unit; RMSE over pixels, and the part of it that is
    noise."""

    scene: str
    quantity: str
    dapple: float
    mitsuba: float
    standard_error: float
    rmse: float
    noise: float

    @property
    def difference(self):
        return self.dapple - self.mitsuba

    @property
    def deviation(self):
        """RMSE beyond the noise."""
        return np.sqrt(max(0.0, self.rmse**2 - self.noise**2))

    def failure(self):
        if not abs(self.difference) <= LIMIT:
            return f"means differ by {self.difference:+.4f}, more than {LIMIT}"
        if not self.standard_error <= LARGEST_STANDARD_ERROR:
            return f"the standard error {self.standard_error:.4f} is too large to tell"
        if not self.deviation <= LARGEST_DEVIATION:
            return f"pixels differ by {self.deviation:.4f} beyond noise, above {LARGEST_DEVIATION}"
        return None

    def line(self):
        return (
            f"{self.scene:8} {self.quantity:8} {self.dapple:8.4f} {self.mitsuba:8.4f}"
            f" {self.difference:+10.5f} +- {self.standard_error:.5f}"
            f" {self.rmse:8.4f} {self.noise:8.4f}"
        )


HEADER = "scene    value      dapple  Mitsuba  difference +- std. err.    RMSE    noise"


def mean_layer(layers):
    values = np.mean([layer.values for layer in layers], axis=0)
    return Layer(values, np.mean([layer.alpha for layer in layers], axis=0))


def ratio_and_variance(layers):
    """The mean of `values` over what `alpha` shows, from layers of two seeds, and its variance."""
    mean = mean_layer(layers)
    ratio = mean.values.sum() / mean.alpha.sum()
    # Errors of values and alphas go together. Half of the difference between two seeds has the
    # standard error of their mean.
    residuals = [layer.values - ratio * layer.alpha for layer in layers]
    variance = ((residuals[0] - residuals[1]) / 2) ** 2
    return ratio, variance.sum() / mean.alpha.sum() ** 2


def compare(scene, quantity, dapple, mitsuba):
    """`dapple` and `mitsuba`: a layer for each of two seeds."""
    ours, theirs = mean_layer(dapple).values, mean_layer(mitsuba).values
    unit = 1.0 if quantity in ("coverage", "ao") else np.percentile(theirs, 99)
    our_mean, our_variance = ratio_and_variance(dapple)
    their_mean, their_variance = ratio_and_variance(mitsuba)
    noise = sum(((a.values - b.values) / 2) ** 2 for a, b in (dapple, mitsuba))
    return Comparison(
        scene,
        quantity,
        our_mean / unit,
        their_mean / unit,
        np.sqrt(our_variance + their_variance) / unit,
        np.sqrt(((ours - theirs) ** 2).mean()) / unit,
        np.sqrt(noise.mean()) / unit,
    )


def with_coverage(quantities):
    """Alpha itself, whose mean is over all pixels."""
    alpha = quantities["ao"].alpha
    return {"coverage": Layer(alpha, np.ones_like(alpha)), **quantities}


def compare_scene(name, dapple, folder):
    scene = SCENES[name](folder, dapple)
    mitsuba = Mitsuba(scene, folder)
    ours = [with_coverage(dapple.render(scene, folder, seed)) for seed in SEEDS]
    theirs = [with_coverage(mitsuba.render(seed)) for seed in SEEDS]
    comparisons = []
    for quantity in ours[0]:
        pair = [[image[quantity] for image in images] for images in (ours, theirs)]
        comparison = compare(name, quantity, *pair)
        print(comparison.line(), flush=True)
        if comparison.failure():
            write_difference(folder / f"{name}_{quantity}_difference.exr", *pair)
        comparisons.append(comparison)
    return comparisons


def write_difference(path, ours, theirs):
    """dapple minus Mitsuba, for whoever looks for the cause."""
    difference = mean_layer(ours).values - mean_layer(theirs).values
    mi.Bitmap(difference.astype(np.float32)[:, :, np.newaxis]).write(str(path))


def report(comparisons, folder):
    """Returns the line to exit with, or None when everything agrees."""
    failed = [comparison for comparison in comparisons if comparison.failure()]
    if not failed:
        worst = max(comparisons, key=lambda c: abs(c.difference))
        print(
            f"mitsuba: {len(comparisons)} means agree within {LIMIT};"
            f" the largest difference is {worst.difference:+.5f} ({worst.scene}, {worst.quantity})"
        )
        return None
    for comparison in failed:
        print(
            f"mitsuba: {comparison.scene}, {comparison.quantity}: {comparison.failure()}",
            file=sys.stderr,
        )
    return (
        f"mitsuba: scenes, dapple's images and differences (dapple minus Mitsuba) are in {folder};"
        " see where NAME_QUANTITY_difference.exr is not mere noise"
    )


def main(program, names):
    unknown = set(names) - set(SCENES)
    if unknown:
        raise SystemExit(f"mitsuba: no scene is called {sorted(unknown)}; there are {list(SCENES)}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    folder = Path(tempfile.mkdtemp(prefix="dapple-mitsuba-"))
    problem = None
    try:
        check_dome()
        dapple = Dapple(program)
        print(HEADER)
        comparisons = [c for name in names or SCENES for c in compare_scene(name, dapple, folder)]
        problem = report(comparisons, folder)
    finally:
        if not problem:
            shutil.rmtree(folder)
    sys.exit(problem)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
