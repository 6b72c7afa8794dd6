"""Linear programs, minimize c . x subject to l <= A x <= u, solved by HiGHS.

When costs change or rows are added, the solver continues from the last basis.

Reference: Q. Huangfu, J. A. J. Hall, *Parallelizing the dual revised simplex method*, Mathematical
Programming Computation 10 (2018).
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
    """A linear program, minimize c . x subject to l <= A x <= u, whose
    costs c can change and which can get more rows.

    Parameters
    ----------
    solver : HiGHS, which holds the program.
    """

    solver: Any

    @classmethod
    def from_matrix(
        cls, matrix: Array, costs: Array, lower: Array, upper: Array, most: float | None = None
    ) -> LinearProgram:
        """Return the program with a matrix A (M, N), costs c (N,), and bounds of its rows l, u (M,).

        Bounds are -inf or inf where a row is unbounded. ``most`` bounds each x to [-most, most]; with None
        each x is 0 or more.
        """
        # Slow to import, and only needed where a program is solved.
        import highspy

        class SilentSolver(highspy.Highs):
            """HiGHS without output, which it would otherwise print when callbacks are enabled."""

            def enableCallbacks(self) -> None:  # noqa: N802
                """Enable callbacks with the output off."""
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

    def find_least_cost(self) -> float | None:
        """Solve the program; return the least cost, or None where it is infeasible or unbounded."""
        import highspy

        self.solver.run()
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        return float(self.solver.getInfo().objective_function_value)

    def find_bounding_rows(self) -> NDArray[np.int64] | None:
        """Return the indices of the rows at their upper bound in the last
        solution, if there are as many as columns.

        None if there are fewer, since bounds of columns are active as well.
        """
        import highspy

        basis = self.solver.getBasis()
        at_bound = highspy.HighsBasisStatus.kUpper
        rows = [number for number, status in enumerate(basis.row_status) if status == at_bound]
        return np.array(rows) if len(rows) == len(basis.col_status) else None

    def add_rows(self, rows: Array, upper: Array) -> None:
        """Add rows (K, N) with upper bounds (K,) and without lower bounds."""
        import highspy

        count, columns = rows.shape
        starts = columns * np.arange(count, dtype=np.int32)
        indices = np.tile(np.arange(columns, dtype=np.int32), count)
        lower = np.full(count, -highspy.kHighsInf)
        self.solver.addRows(count, lower, upper, count * columns, starts, indices, rows.ravel())

    def solve_with_costs(self, costs: Array) -> Array | None:
        """Set new costs (N,) and solve; return the optimal x (N,), or None where infeasible or unbounded."""
        import highspy

        columns = np.arange(len(costs), dtype=np.int32)
        self.solver.changeColsCost(len(costs), columns, costs)
        self.solver.run()
        if self.solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        return self.read_solution()

    def read_solution(self) -> Array:
        """Return the x (N,) of the last solution."""
        return np.array(self.solver.getSolution().col_value)
