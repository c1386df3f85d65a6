"""Contact problems in local form from FCLIB files, and the errors of answers, by numpy alone.

An answer r obeys K* ∋ (u_N + mu |u_T|, u_T) ⟂ r ∈ K, u = W r + q, for every contact; e1, e2, e8 as in doc/theory/errors.md.
"""

from dataclasses import dataclass

import h5py
import numpy as np


@dataclass
class ContactProblem:
    """u = W r + q, normal first."""

    dimension: int
    w: object
    """A sparse matrix of scipy, or an array"""
    q: np.ndarray
    friction: np.ndarray

    @property
    def contacts(self):
        return len(self.friction)


@dataclass
class Errors:
    """Errors of an answer, and what rounding alone may make of them."""

    e1: float
    e2: float
    e8: float
    rounding: float
    """Of e1 and e2: sixteen roundings of the largest terms of u, over |q|"""


def read_problem(file):
    """The problem of the group /fclib_local of a file."""
    with h5py.File(file) as content:
        group = content["fclib_local"]
        if "V" in group:
            raise ValueError(f"{file}: constraints are not read here")
        dimension = int(group["spacedim"][0])
        vectors = group["vectors"]
        return ContactProblem(dimension, read_matrix(group["W"]), vectors["q"][:], vectors["mu"][:])


def read_matrix(group):
    """A matrix, whichever way it is stored; in triplets i is the row (as files are, not as they are described)."""
    from scipy import sparse
    nz, shape = int(group["nz"][0]), (int(group["m"][0]), int(group["n"][0]))
    p, i, x = (group[name][:] for name in "pix")
    if nz >= 0:
        return sparse.coo_matrix((x[:nz], (i[:nz], p[:nz])), shape=shape).tocsr()
    return (sparse.csc_matrix if nz == -1 else sparse.csr_matrix)((x, i, p), shape=shape).tocsr()


def read_answer(file):
    """The impulses of the group /solution of a file."""
    with h5py.File(file) as content:
        return content["solution/r"][:]


def errors(problem, r):
    """Errors of an answer."""
    d, w, q = problem.dimension, problem.w, problem.q
    product = w @ r
    u = product + q
    squares = [np.linalg.norm(natural_map(problem, r, u, rho)) for rho in (1.0, inverse_largest_eigenvalues(w, d))]
    norm = np.linalg.norm
    scale = norm(abs(w) @ abs(r)) + norm(r) + norm(q)
    return Errors(ratio(squares[0], norm(q)), ratio(squares[0], max(norm(q), norm(r), norm(u))), ratio(squares[1], norm(r)),
                  16 * np.finfo(float).eps * ratio(scale, norm(q)))


def ratio(a, b):
    """a/b; zero where both vanish, one where only b does; infinite where a is not finite."""
    if not np.isfinite(a):
        return np.inf
    if b > 0:
        return float(a / b)
    return float(a > 0)


def natural_map(problem, r, u, rho):
    """r - P(r - rho (u + (mu |u_T|, 0))), shape (contacts, dimension)."""
    r, shifted = (x.reshape(-1, problem.dimension).copy() for x in (r, u))
    shifted[:, 0] += problem.friction * np.linalg.norm(shifted[:, 1:], axis=1)
    return r - project(r - np.reshape(rho, (-1, 1)) * shifted, problem.friction)


def project(x, friction):
    """The nearest points of Coulomb's cones."""
    normal, tangent = x[:, 0], np.linalg.norm(x[:, 1:], axis=1)
    onto = np.maximum(0, (normal + friction * tangent) / (1 + friction**2))
    share = friction * onto / np.where(tangent > 0, tangent, 1)
    sides = np.column_stack([onto, share[:, None] * x[:, 1:]])
    inside = tangent <= friction * normal
    return np.where(inside[:, None], x, np.where((friction * tangent <= -normal)[:, None], 0, sides))


def inverse_largest_eigenvalues(w, d):
    """1/lambda_max of the symmetric part of each block of the diagonal."""
    blocks = np.empty((w.shape[0] // d, d, d))
    for i in range(d):
        for j in range(d):
            blocks[:, i, j] = w[np.arange(i, w.shape[0], d), np.arange(j, w.shape[0], d)]
    largest = np.linalg.eigvalsh((blocks + blocks.transpose(0, 2, 1)) / 2)[:, -1]
    return np.where(largest > 0, 1 / np.where(largest > 0, largest, 1), 0)
