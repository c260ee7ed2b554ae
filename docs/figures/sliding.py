"""The sliding operator on its grid, as the solver gets it: read from the program's files, for make.py."""

import math
import pathlib
import tempfile
import types

import numpy

MU_S, MU_D = 1.0, 0.25


def sliding_operator(run, delta, degree):
    """The sliding operator -L of hp elements at tau = 1 and b(v) = -v.

    Returns
    -------
    grid
        `row` and `column` of each entry: rows go by velocity node, noise nodes fastest. `v`, `ends`: velocity nodes,
        and the ends of their elements. `x`: noise nodes. `groups`: first and last level of each group of noise levels.
        `nodes`: the number of noise nodes of each group.

    Raises
    ------
    ValueError
        If the program groups noise levels in another way than `noise_groups`.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "matrix"
        found = run(delta=delta, degree=degree, quantities="density", slide_ksp_view_mat=f"binary:{file}")
        row, column, value = petsc_matrix(file)
    step, v, ends = found.cost["steps"][-1], *(part[part >= 0] for part in (found.density.v, found.density.cells))
    groups, count = noise_groups(step["noise_levels"], delta, step["noise_degree"] + 1), step["noise_nodes"]
    nodes = numpy.array([min(last + 1 - first, step["noise_degree"] + 1) for first, last in groups])
    speed = -numpy.bincount(row, value * v[column // count])  # L v = dV/dt = x - mu_d - v
    x = (speed.reshape(-1, count) + MU_D + v[:, None]).mean(axis=0)
    levels = numpy.repeat(groups, nodes, axis=0) + (-0.01, 0.01)
    if len(levels) != count or (x / delta < levels[:, 0]).any() or (x / delta > levels[:, 1]).any():
        raise ValueError("the program groups noise levels in another way than noise_groups")
    return types.SimpleNamespace(row=row, column=column, v=v, ends=ends, x=x, groups=groups, nodes=nodes)


def petsc_matrix(file):
    """Rows, columns and values of the last matrix in a file of -ksp_view_mat binary:FILE."""
    data, at = file.read_bytes(), 0
    while at < len(data):
        _, rows, _, entries = numpy.frombuffer(data, ">i4", 4, at).tolist()
        lengths, columns = numpy.split(numpy.frombuffer(data, ">i4", rows + entries, at + 16), [rows])
        values = numpy.frombuffer(data, ">f8", entries, at + 16 + 4 * (rows + entries))
        at += 16 + 4 * rows + 12 * entries
    return numpy.repeat(numpy.arange(rows), lengths), columns, values


def noise_groups(levels, delta, most):
    """First and last level of each group, by the rule of noise::Nodes for -noise ou with a standard deviation of 1 and
    -noise_grading 2. Groups of at most `most` levels are single levels."""
    special = numpy.array([MU_D / delta, math.floor(MU_S / delta) + 0.5])

    def allowed(low, high):
        apart = not ((low < special) & (special < high)).any() and (high - low - 1) * delta < 4
        return apart and high - low <= 2 * abs(special[:, None] - (low, high)).min()

    found, first = [], 1
    while first <= levels:
        last = first
        while last < levels and allowed(first - 0.5, last + 1.5):
            last += 1
        found += [(first, last)] if last + 1 - first > most else [(i, i) for i in range(first, last + 1)]
        first = last + 1
    return [(-last, -first) for first, last in reversed(found)] + [(0, 0)] + found
