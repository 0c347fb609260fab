"""Functions of the performance indices of a robot (Sections 1.8 and 4.2.2)."""

from __future__ import annotations

from krhpr.codegen.composition import SINGULAR_TOLERANCE, Call, Guard, Relation, RobotFunction, Stage
from krhpr.codegen.kernel import Frame, Port, Unit
from krhpr.codegen.status import Status
from krhpr.derivations.robot_functions import FunctionsOf


class IndexFunctions(FunctionsOf):
    """The performance indices of one robot."""

    def _indices(self) -> RobotFunction:
        condition = Port("condition", (3,), Unit.NONE, Frame.NONE, "condition numbers of M_1, M_2, M_3")
        return self._index_function(
            "indices",
            "The performance indices: 2-norms of both parts of U = J^-1 K, and condition numbers.  They have "
            "a kink where a largest singular value is a double one.",
            ("spread", "norms"),
            ("2-norm", ""),
            (condition,),
        )

    def _index_bounds(self) -> RobotFunction:
        return self._index_function(
            "index_bounds",
            "Upper bounds of the performance indices with all derivatives: Schatten norms of order 16, at "
            "most 7.2 % above eta_1 and eta_2, and 32 % above eta_3.",
            ("spread_bound", "norm_bounds"),
            ("bound of the 2-norm", "bound of the "),
        )

    def _index_function(
        self,
        name: str,
        doc: str,
        kernels: tuple[str, str],
        words: tuple[str, str],
        more: tuple[Port, ...] = (),
    ) -> RobotFunction:
        norm, before = words
        outputs = (
            Port(
                "eta_1",
                (),
                Unit.METRE,
                Frame.NONE,
                f"{norm} of the position part of U: displacement per radian, or "
                "`characteristic_length`, of the actuators",
            ),
            Port(
                "eta_2", (), Unit.NONE, Frame.NONE, f"{norm} of the rotation part of U: rotation for the same"
            ),
            Port(
                "eta_3",
                (),
                Unit.NONE,
                Frame.NONE,
                f"{before}condition number of J_1 = diag(M_1, M_2, M_3), (1.52)",
            ),
        )
        calls = (
            self._on_leg("platform", "line"),
            self._posture(),
            self._on_leg("subleg", "gram"),
            self._on_leg("algebra", kernels[0]),
            Call(Stage.PLATFORM, "platform", "sensitivity", {}, {"regularity": "det_regularity"}),
            Call(Stage.PLATFORM, "algebra", kernels[1], {}, {}),
        )
        length = (self.leg.characteristic_length,) if self.robot.subleg.slides else ()
        return self._function(
            name,
            doc,
            "1.8, 4.2.2, (1.50) to (1.52)",
            (*self.pose, self.leg.s, self.leg.theta, *length),
            (*outputs, *more),
            calls,
            (*self._parallel_guard(), self._evenness_guard(), *self._platform_guards()),
        )

    @staticmethod
    def _evenness_guard() -> Guard:
        """Without an inverse of M_i there is no condition number."""
        limit = SINGULAR_TOLERANCE**2  # the kernel gives squares
        return Guard("evenness", 0, Relation.AT_LEAST, limit, Status.SINGULAR_LEG_1)
