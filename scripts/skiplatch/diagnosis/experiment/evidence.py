"""How much played touches tell about which of several models played them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.experiment.channels import MISSED

Samples = Mapping[str, FloatArray]
"""By channel, what m models play in n touches, r times; arrays of shape (m, r, n)."""

EDGES = 16
EDGES_PER_MODEL = 8
WIDTH = 3.0  # of the kernel, in cells
INDEPENDENT = 2.0 * np.sqrt(np.pi) * WIDTH  # cells that such a kernel makes one
PRIOR = 0.5  # touches, over all cells


@dataclass(frozen=True, slots=True, eq=False)
class Densities:
    """What m models are likely to show in a channel of n touches.

    Values are sorted into cells between the quantiles of all models together, so that neither
    units nor tails matter. A quantile is a cell of its own: rounded values sit on them.

    Attributes:
        edges: The quantiles, rising; shape (n, e).
        share: Of each of c = 2·e + 1 cells, summing to 1; shape (m, n, c).
        known: How often there is a value at all; shape (m, n).
    """

    edges: FloatArray
    share: FloatArray
    known: FloatArray

    @classmethod
    def of(cls, name: str, values: FloatArray) -> "Densities":
        """Estimate them from played values; shape (m, r, n)."""
        edges = np.full((values.shape[2], 1), 0.5) if name == MISSED else _quantiles(values)
        cells = _cells(edges, values)
        counts = np.stack([_counts(model, 2 * edges.shape[1] + 1) for model in cells])
        known = counts.sum(axis=2)
        if name != MISSED:
            counts = scipy.ndimage.gaussian_filter1d(counts, WIDTH, axis=2, mode="reflect")
        share = (counts + PRIOR / counts.shape[2]) / (known + PRIOR)[:, :, None]
        return cls(edges, share, known / values.shape[1])

    def log_likelihood(self, values: FloatArray) -> FloatArray:
        """Give that of values, shape (..., n), under each model; shape (m, ..., n)."""
        cells = _cells(self.edges, values)
        touch = np.arange(values.shape[-1])
        padded = np.pad(np.log(self.share), ((0, 0), (0, 0), (0, 1)))  # no value says nothing
        found: FloatArray = padded[:, touch, cells]
        return found

    def exponents(self, replicates: int) -> FloatArray:
        """Bhattacharyya's exponent of each pair of models; shape (m, m, n).

        The chance of mistaking one for the other falls at least by exp(-exponent) with each
        touch, so exponents of independent touches add. What equal models differ by in so many
        replicates is taken off.
        """
        root = np.sqrt(self.share)
        overlap = np.einsum("anc,bnc->abn", root, root)
        both = np.minimum(self.known[:, None], self.known[None, :])
        by_chance = self.share.shape[2] / INDEPENDENT / (4.0 * replicates)
        excess = -np.log(np.minimum(overlap, 1.0)) - by_chance
        return np.asarray(np.maximum(excess, 0.0) * both)


def _quantiles(values: FloatArray) -> FloatArray:
    """Give evenly spread quantiles of all models together, NaN apart; shape (n, e)."""
    count = EDGES + EDGES_PER_MODEL * len(values)
    pooled = np.sort(values.reshape(-1, values.shape[2]), axis=0).T  # NaN comes last
    known = np.count_nonzero(~np.isnan(pooled), axis=1)
    levels = np.arange(1, count + 1) / (count + 1)
    return np.take_along_axis(pooled, (known[:, None] * levels).astype(np.intp), axis=1)


def _cells(edges: FloatArray, values: FloatArray) -> NDArray[np.intp]:
    """Sort values, shape (..., n), into c cells from 0; c itself stands for no value."""
    columns = values.reshape(-1, len(edges)).T.copy()
    cells = np.empty(columns.shape, dtype=np.intp)
    for row, of, column in zip(cells, edges, columns, strict=True):
        row[:] = np.searchsorted(of, column, "left") + np.searchsorted(of, column, "right")
    cells[np.isnan(columns)] = 2 * edges.shape[1] + 1
    return cells.T.reshape(values.shape)


def _counts(cells: NDArray[np.intp], count: int) -> FloatArray:
    """Count the values in each cell, those that are none left out; (r, n) gives (n, c)."""
    touches = cells.shape[1]
    flat = cells + (count + 1) * np.arange(touches)
    counts = np.bincount(flat.ravel(), minlength=touches * (count + 1))
    return counts.reshape(touches, count + 1)[:, :count].astype(float)


def exponents(samples: Samples) -> FloatArray:
    """Bhattacharyya's exponents over all channels; shape (m, m, n)."""
    parts = [Densities.of(n, values).exponents(values.shape[1]) for n, values in samples.items()]
    return np.asarray(np.sum(parts, axis=0))


def log_likelihoods(known: Samples, played: Samples) -> FloatArray:
    """Judge what each model played by what all are known to play; shape (m, m, r, n).

    The first index is the model that judges, the second the one that played.
    """
    parts = [Densities.of(n, known[n]).log_likelihood(played[n]) for n in known]
    return np.asarray(np.sum(parts, axis=0))
