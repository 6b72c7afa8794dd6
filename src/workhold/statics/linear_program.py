"""Linear programs, minimize c . x subject to l <= A x <= u, solved by HiGHS.

Of programs that differ in costs, or to which rows are added, each goes on from the basis of the last.

Reference: Q. Huangfu, J. A. J. Hall, *Parallelizing the dual revised simplex method*, Mathematical Programming
Computation 10 (2018).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

__all__ = ["LinearProgram"]

Array = NDArray[np.float64]
# One thread, so that every run takes the same steps; without presolve a program goes on from the last basis.
SETTINGS = {
    "output_flag": False,
    "threads": 1,
    "parallel": "off",
    "solver": "simplex",
    "presolve": "off",
    "random_seed": 0,
    "primal_feasibility_tolerance": 1e-9,
    "dual_feasibility_tolerance": 1e-9,
}


@frozen(eq=False)
class LinearProgram:
    """A linear program whose costs change, and to which rows are added.

    Parameters
    ----------
    solver : HiGHS, which has the program.
    """

    solver: Any

    @classmethod
    def of(
        cls, matrix: Array, costs: Array, lower: Array, upper: Array, most: float | None = None
    ) -> LinearProgram:
        """The program of a matrix (M, N), costs (N,) and bounds of rows (M,), infinite where there is none.

        ``most`` is the largest size of each x, of either sign; None where each is 0 or more.
        """
        # It takes a moment to load, and is needed where a program is solved alone.
        import highspy

        class SilentSolver(highspy.Highs):
            """HiGHS, which else prints what it is as soon as it listens to callbacks."""

            def enableCallbacks(self) -> None:  # noqa: N802
                self.setOptionValue("output_flag", False)
                super().enableCallbacks()  # type: ignore[no-untyped-call]

        model = highspy.HighsLp()
        model.num_row_, model.num_col_ = matrix.shape
        model.col_cost_ = costs
        model.col_lower_ = np.full(len(costs), 0.0 if most is None else -most)
        model.col_upper_ = np.full(len(costs), highspy.kHighsInf if most is None else most)
        model.row_lower_, model.row_upper_ = lower, upper
        column, row = np.nonzero(matrix.T)
        model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        counts = np.bincount(column, minlength=len(costs))
        model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        model.a_matrix_.index_ = row.astype(np.int32)
        model.a_matrix_.value_ = matrix[row, column]
        solver: Any = SilentSolver()  # type: ignore[no-untyped-call]
        for name, value in SETTINGS.items():
            solver.setOptionValue(name, value)
        solver.passModel(model)
        return cls(solver)

    def least(self) -> float | None:
        """The least cost; None where there is none."""
        import highspy

        self.solver.run()
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        return float(self.solver.getInfo().objective_function_value)

    def bounding_rows(self) -> NDArray[np.int64] | None:
        """Return the numbers of the rows that bound the last solution from above, as many as there are columns.

        It is None where a bound of a column does instead of a row.
        """
        import highspy

        basis = self.solver.getBasis()
        at_bound = highspy.HighsBasisStatus.kUpper
        rows = [number for number, status in enumerate(basis.row_status) if status == at_bound]
        return np.array(rows) if len(rows) == len(basis.col_status) else None

    def add_rows(self, rows: Array, upper: Array) -> None:
        """Adds rows (K, N) that are at most so much (K,)."""
        import highspy

        count, columns = rows.shape
        starts = columns * np.arange(count, dtype=np.int32)
        indices = np.tile(np.arange(columns, dtype=np.int32), count)
        lower = np.full(count, -highspy.kHighsInf)
        self.solver.addRows(count, lower, upper, count * columns, starts, indices, rows.ravel())

    def with_costs(self, costs: Array) -> Array | None:
        """The x of least cost for other costs (N,); None where there is none."""
        import highspy

        columns = np.arange(len(costs), dtype=np.int32)
        self.solver.changeColsCost(len(costs), columns, costs)
        self.solver.run()
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        return self.solution()

    def solution(self) -> Array:
        """Return the x (N,) of the last run."""
        return np.array(self.solver.getSolution().col_value)
