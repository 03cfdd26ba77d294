"""The extension that CMakeLists.txt builds; the headers beside it say what each part does.

n accelerations, d reduced ones, a joints, c contact forces, m rows of tasks. Arrays are float64
and C-contiguous; others are copied. ValueError: sizes that do not fit together.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array, Starts

class Model:
    """A tree of joints and the frames in use; every array is a view that `update` overwrites."""

    def __init__(
        self,
        parents: Sequence[int],
        table: Array,
        floating: bool,
        gravity: Array,
        armature: Array,
    ) -> None:
        """See `model/tree.py`; one row of (joints, 27): rotation and position in the parent, turn
        and slide of one unit of q, mass, center of mass, inertia about it.
        """

    def update(self, q: Array, v: Array) -> None:
        """Everything at a state."""

    def add_frame(self, joint: int, rotation: Array, position: Array) -> int:
        """Number of a new frame on a joint (-1: the world), current after `update_frames`."""

    def update_frames(self) -> None:
        """All frames at the state of the last update."""

    def frame(self, number: int) -> tuple[Array, Array, Array]:
        """Rotation above position (4, 3), Jacobian (6, n), velocity above drift (2, 6)."""

    def axes(self, out: Array) -> None:
        """Write the angular velocity (3, n) of one unit of each coordinate."""

    @property
    def mass(self) -> float: ...
    @property
    def q(self) -> Array: ...
    @property
    def v(self) -> Array: ...
    @property
    def mass_matrix(self) -> Array: ...
    @property
    def bias(self) -> Array: ...
    @property
    def gravity_torque(self) -> Array: ...
    @property
    def center(self) -> Array:
        """Position, velocity and drift of the center of mass, (3, 3)."""
    @property
    def center_jacobian(self) -> Array: ...

class Measure:
    """What a task measures at the last update of a model: error, Jacobian and drift of m rows."""

    @property
    def reference_size(self) -> int: ...
    def write(
        self,
        model: Model,
        reference: Array,
        error: Array,
        drift: Array,
        velocity: Array,
        acceleration: Array,
        jacobian: Array,
        /,
    ) -> None:
        """Write vectors (m,) and the Jacobian (m, n)."""

class FrameMeasure(Measure):
    def __init__(self, rows: Sequence[int], frame: int, base: int, /) -> None:
        """Rows of x, y, z, rx, ry, rz (0 to 5) of a frame as seen from another; -1: the world."""

class CenterMeasure(Measure):
    def __init__(self, axes: Sequence[int], /) -> None:
        """Axes 0 to 2 of the center of mass."""

class JointMeasure(Measure):
    def __init__(self, joints: Sequence[int], /) -> None:
        """Positions of actuated joints."""

class EdgeMeasure(Measure):
    def __init__(self, lower: Array, upper: Array, /) -> None:
        """Joints beyond edges (a,), to come to rest there."""

class TaskStack:
    """Rows of several measures in one Jacobian (m, n) and vectors (7, m) of TaskRows."""

    def __init__(
        self,
        model: Model,
        measures: list[Measure],
        firsts: Sequence[int],
        jacobian: Array,
        vectors: Array,
        references: Array,
        /,
    ) -> None:
        """First row of each measure; references are read at every call, one behind the other."""

    def measure(self) -> None:
        """Measure at the last update of the model."""

    def measure_and_track(self) -> None:
        """Measure, then `track` with the velocity of the model, on all rows."""

class SeenFrame:
    """A frame as seen from another one, in its axes."""

    def __init__(self, n: int, /) -> None: ...
    def update(self, model: Model, base: int, frame: int, /) -> None:
        """Terms at the last update of the model."""

    def arrays(self) -> tuple[Array, Array, Array]:
        """As `Model.frame`."""

def track(jacobian: Array, velocity: Array, vectors: Array, /) -> None:
    """The control law of rows J (m, n) at v (n,), of the vectors (7, m) of TaskRows."""

class JointBox:
    """A lower and an upper bound of each of a joints, at the last update of a model.

    The array (a,) that a kind is made of is kept: changed numbers count from the next write on.
    """

    def write(
        self,
        model: Model,
        previous_torque: Array | None,
        dt: float,
        jerk: Array | None,
        lower: Array,
        upper: Array,
        /,
    ) -> None:
        """Write the last a entries of lower and upper; arguments as in Tick."""

class TorqueBox(JointBox):
    def __init__(self, limit: Array, around_gravity: bool, /) -> None: ...
    def set_range(self, lower: Array, upper: Array, /) -> None:
        """Bounds (a,) instead of the limit; empty ones: the limit again."""

class RateBox(JointBox):
    def __init__(self, rate: Array, /) -> None: ...

class VelocityBox(JointBox):
    horizon: float
    def __init__(self, limit: Array, horizon: float, /) -> None: ...

class PositionBox(JointBox):
    def __init__(self, brake: Array, approach_rate: float, /) -> None: ...
    def set_limits(
        self, lower: Array, upper: Array, rates: Array, accelerations: Array, /
    ) -> None:
        """As in MovingLimits."""

class BodyPairs:
    """Distances of pairs of e shapes on the frames of a model (`constraints/body_pairs.hpp`)."""

    def __init__(
        self,
        frames: NDArray[np.int64],
        centers: Array,
        axes: Array,
        radii: Array,
        pairs: NDArray[np.int64],
    ) -> None:
        """Frames (e,) by number, -1 = the world; centers (e, 3) and axes (e, 9) [m], three half
        axes as the columns of a matrix; radii (e,) [m]; pairs (p, 2) of shapes.
        """

    def near(self, model: Model, within: float) -> tuple[NDArray[np.int64], Array, Array]:
        """Pairs nearer than `within` [m], nearest first: numbers (k,), distances (k,) [m] and
        places of their closest points (k, 6), of the second shape and of the first.
        """

    def motion(
        self, model: Model, pairs: NDArray[np.int64], distances: Array, places: Array
    ) -> tuple[Array, Array, Array]:
        """Rates (k,) [m/s], Jacobian (k, n) and drift (k,) of pairs of the last `near`."""

class BoxMerge:
    """Boxes of one space, hardest first, and their intersection."""

    def __init__(
        self,
        boxes: list[JointBox | None],
        hard: int,
        lowers: Array,
        uppers: Array,
        merged: Array,
        sources: NDArray[np.int64],
        slack: Array,
        /,
    ) -> None:
        """Keep the arrays: boxes (c, r) each with its rows, merged (4, r), sources (2, r).

        A box that is None is written by others. Merged: lower, upper, and both of the first `hard`
        boxes alone. Sources: numbers of the boxes behind lower and upper, -1 for none.
        """

    def update(
        self, model: Model, previous_torque: Array | None, dt: float, jerk: Array | None, /
    ) -> bool:
        """Write all; where the next box misses what is left it gives way to the nearest point.

        Returns:
            Whether any box gave way; by how much is in the slack (c, r).
        """

class JerkPlan:
    """See PlannedJerk; the rate (a,) is kept, the others are views that `update` overwrites."""

    def __init__(self, rate: Array, n: int, /) -> None: ...
    def update(
        self,
        mass: Array,
        bias: Array,
        velocity: Array,
        contacts: Array | None,
        time: float,
        dt: float,
        /,
    ) -> None: ...
    def reset(self) -> None: ...
    @property
    def share(self) -> float: ...
    @property
    def jerk(self) -> Array: ...
    @property
    def drift(self) -> Array: ...
    @property
    def carried(self) -> Array: ...

# Bounds on the acceleration of one joint near a limit: core/joint_bounds.hpp.
def stopping_distance(v: float, a: float, jerk: float, brake: float, /) -> float: ...
def velocity_bound(margin: float, jerk: float, dt: float, /) -> float: ...
def position_bound(
    distance: float, v: float, jerk: float, brake: float, dt: float, cap: float, /
) -> float: ...
def viable_acceleration(distance: float, v: float, brake: float, dt: float, /) -> float: ...
def moving_approach(
    distance: float, v: float, w: float, a: float, brake: float, rate: float, dt: float, /
) -> float: ...

class ContactMotion:
    """Rows of the contacts that are on: Contact.write_motion and write_forces of all in one."""

    def __init__(self, rate: float, /) -> None:
        """Rate [1/s] at which one that slides is brought to rest."""

    def add(
        self, frame: int, points: Array, axes: Array, whole: bool, force: int, motion: int, /
    ) -> None:
        """Points (p, 3) of a frame, forces along axes (a, 3), kept still along them or whole.

        Its rows begin at `force` of c and `motion` of q.
        """

    def write(
        self, model: Model, jacobian: Array, target: Array, force_jacobian: Array, /
    ) -> None:
        """Write J_c (q, n), J_c x (q,) and J_f (c, n) at the last update of a model."""

def write_force_map(
    rotation: Array, jacobian: Array, points: Array, axes: Array, out: Array, /
) -> None:
    """Write J_f (p * a, n), point by point: axis . (J_lin + J_ang x (R point)).

    rotation (3, 3) frame to world; jacobian (6, n) of its origin, world axes; points (p, 3) in the
    frame, axes (a, 3) in the world.
    """

def write_point_motion(
    rotation: Array,
    jacobian: Array,
    velocity: Array,
    drift: Array,
    points: Array,
    axes: Array,
    rate: float,
    target: Array,
    /,
) -> None:
    """Write the accelerations (p * a,) that keep points still, -dJ/dt v - rate * velocity."""

class NullSpace:
    """P = I - S^T (S S^T + e^2 I)^-1 S of rows S that are appended level by level."""

    def __init__(self, d: int, capacity: int) -> None: ...
    def append(self, rows: Array, e: float) -> None:
        """Append rows (m, d)."""

    def projector(self) -> Array:
        """P (d, d)."""

class Cascade:
    """Workspace and active sets of one order."""

    def __init__(self, rows: Sequence[int], ends: Sequence[int]) -> None:
        """Rows (m,) of the augmented Jacobian in the order of the levels; l ends at ends[l]."""

    def forget(self) -> None:
        """Forget the active sets."""

class Mixture:
    """Workspace of the orders of a mixture; holds the arrays of the last problem."""

    def __init__(self, w: float, e: float, kd: float, /) -> None: ...
    def solve(
        self,
        orders: tuple[Cascade | None, ...],
        shares: tuple[float, ...],
        jacobian: Array,
        target: Array,
        mass_matrix: Array,
        bias: Array,
        velocity: Array,
        x_lower: Array,
        x_upper: Array,
        tau_lower: Array,
        tau_upper: Array,
        limit_lower: Array,
        limit_upper: Array,
        rows: tuple[Any, ...] | None,
        contacts: tuple[Any, ...] | None,
        unactuated: int,
        bounded: bool,
        of_qp: int,
        of_step: int,
        clock: Clock | None = None,
        end: float = 0.0,
        costs: tuple[tuple[Array, Array], ...] = (),
    ) -> tuple[int, int, int, tuple[Any, ...]]:
        """Answer the orders one after the other, up to one that is None or is left open.

        Args:
            orders: and the shares of the mixture; the other arrays are those of ControlProblem.
            bounded: whether levels that meet a bound are solved too; else they are left open.
            of_qp: most pivots of a level.
            of_step: most pivots of all orders and of the torque rate limit; -1: each order has
                those of a level.
            clock: no level begins after `end` [s] of it, or after its share of what was left where
                several orders are answered; None: whatever the time.
            costs: center (c,) and factor (c, c) of the cost on forces of each order; (): that of
                the contacts.

        Returns:
            How many orders have an answer, -1 where the problem is not finite; where all have,
            pivots and QPs of them, and of the blend x (n,), forces (c,), torques (a,), largest
            violation, pivots, whether a QP was solved, and whether it meets the torque rate.
        """

    def answer(
        self,
        index: int,
        bounded: bool,
        of_qp: int,
        of_order: int,
        clock: Clock | None = None,
        end: float = 0.0,
    ) -> tuple[int, int, int, float, Array, Array, Array]:
        """Answer of one order of the last problem, which is solved unless it was already.

        Returns:
            Levels that have an answer, pivots, levels that met a bound, largest violation, and of
            the last answered level x (n,), forces (c,) and torques (a,); None where none is.
        """

    def retune(self, w: float, e: float, kd: float, /) -> None:
        """Other numbers from the next problem on."""

    def forces(self) -> tuple[Array, ...]:
        """Forces (c,) [N] of each order of the last problem, where all have an answer."""

    def reduced(self, index: int | None = None) -> tuple[Any, ...]:
        """Arrays of the last problem as `reduced_arrays` of problem/reduction.py names them.

        Args:
            index: order whose cost on forces counts, if each has its own; None: that of all.
        """

class Gate:
    """Torque limits (a,) and largest changes (a,) per control period; inf where there is none."""

    def __init__(self, limit: Array, step: Array, /) -> None: ...
    def clip(
        self, torque: Array, previous: Array | None, out: Array
    ) -> tuple[bool, bool, float, float, float]:
        """Write the torque that may follow `previous` to `out` (a,), all [Nm].

        Returns:
            Whether `torque` is finite and `previous` is; the largest excess over limit and over
            rate, and over the rate of what was written.
        """

class Clock:
    """Monotonic time; with a step, one that moves by it at each look, for tests."""

    def __init__(self, step: float = 0.0) -> None:
        """`step` [s]."""

    def now(self) -> float:
        """[s] since some moment in the past."""

class Anchor:
    """The torque sent last, and the one from which the rate of the next one counts."""

    is_given: bool  # whether a torque was sent
    time: float  # [s] of the state that `sent` answers
    sent: Array | None  # (a,) [Nm], a copy
    before: Array | None  # (a,) [Nm] from which the rate of `sent` counted, a copy

    def __init__(self, hold: float, /) -> None:
        """`hold` [s] without a torque, after which the robot is held by someone else."""

    def note(self, torque: Array, time: float, /) -> None:
        """Take a torque (a,) as sent in answer to the state of `time` [s]."""

    def forget(self) -> None:
        """Nothing was sent."""

class Step:
    """One tick of a controller whose parts are all of the core, from a state to a torque."""

    def __init__(
        self,
        stack: TaskStack,
        acceleration: BoxMerge,
        torque: BoxMerge,
        jerk: JerkPlan | None,
        gate: Gate,
        mixture: Mixture,
        anchor: Anchor,
        answer: tuple[type, type, Any, Any, Array],
        /,
    ) -> None:
        """Parts of one model, which have no box that Python writes.

        Args:
            answer: the NamedTuples StepResult and Solution, their status of a step that is solved,
                and the array of no contact forces.
        """

    qps: int  # of the last `run` or `again`
    end: float  # [s] of the clock: when the last of both had to end

    def run(
        self,
        q: Array,
        v: Array,
        before: Array,
        time: float,
        dt: float,
        orders: tuple[Cascade | None, ...],
        shares: tuple[float, ...],
        bounded: bool,
        of_qp: int,
        of_step: int,
        clock: Clock | None,
        end: float,
        /,
    ) -> tuple[int, int, int, bool, bool, float, float, float, Array | None, Any]:
        """Model, rows of all tasks, boxes, the answers of the orders and their blend, the gate.

        Args:
            before: (a,) [Nm] torque from which the rate limit counts.
            time, dt: [s] of the state, and the control period.
            orders: and the rest as in `Mixture.solve`; a tuple that was given before costs less.

        Returns:
            How many orders have an answer, as `Mixture.solve` counts them; where all have, pivots
            and QPs. Whether a box gave way, whether the blend meets the torque rate, the largest
            excess [Nm] that the gate took off (inf: not finite), the time [s] of model, rows and
            boxes and that of the answers. The torque (a,) behind the gate and the Solution; None
            where an order is left open.
        """

    def again(
        self, time: float, q: Array, v: Array, shares: tuple[float, ...], allowed: float, /
    ) -> Any:
        """`run` with the orders and the rest of the last one; notes the torque as sent.

        Args:
            allowed: [s] of the clock that the step may take.

        Returns:
            The StepResult of a torque that left as it was; what `run` returns where a part of the
            step is left open; None where the state does not follow a torque, or its arrays are
            others than q (nq,) and v (n,) of float64.
        """

def force_costs(
    base: float,
    share: float,
    least: float,
    contacts: list[tuple[Array, Array, float, float]],
    center: Array,
    factor: Array,
) -> None:
    """Write center (c,) and block-diagonal factor (c, c) of the cost on contact forces.

    Args:
        base, share, least: weights and smallest load [N] (`core/force_cost.hpp`).
        contacts: normal and last forces of each, weight and force [N] of its task.
        factor: zero outside of the blocks.
    """

def reduced(
    jacobian: Array,
    target: Array,
    mass_matrix: Array,
    bias: Array,
    contacts: tuple[Any, ...] | None,
    unactuated: int,
    balance: bool,
) -> tuple[Any, ...]:
    """Arrays of a problem reduced by its contacts and, with `balance`, by what forces carry."""

def null_motion(rows: Array, target: Array, /) -> tuple[bool, Array, Array]:
    """Least x (n,) with rows x = target, a basis (n, d) of rows x = 0; whether none depends."""

def level_optimum(
    jacobian: Array, target: Array, y: Array, above: NullSpace, w: float, /
) -> tuple[Array, Array, float]:
    """c = y + P A^T (A A^T + w_l I)^-1 (b - J y), (d,), A = J P (m, d) and the damping w_l."""

def level_damping(jacobian: Array, rows: Array, residual: Array, w: float, /) -> float:
    """Damping w_l of rows J (m, d), of what the levels above leave, A (m, d), and r (m,)."""

# Projectors, and the systems that formulations make of them: k tasks with m rows, `starts`
# (k + 1,) the first row of each, `alpha` (k, k); w, rank_tolerance and damping as in the settings.

def generalized_projectors(
    jacobian: Array, starts: Starts, alpha: Array, rank_tolerance: float, damping: float, /
) -> Array:
    """P_i = I - B^T A^{r,s} B (eq. 11), (k, d, d)."""

def ghc_target(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    damping: float,
    /,
) -> tuple[Array, Array]:
    """x0 (d,) = sum_i (J_i P_i)^T (J_i J_i^T + w I)^-1 b_i, and the projectors (k, d, d)."""

def ghc_factor(
    jacobian: Array, starts: Starts, alpha: Array, projectors: Array, w: float, damping: float, /
) -> Array:
    """Cholesky factor L (d, d) of G = sum P_i P_i - (J_i P_i)^T (J_i J_i^T + w I)^-1 (J_i P_i)."""

def balanced_system(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    damping: float,
    /,
) -> tuple[Array, Array]:
    """A = sum P_i J_i^T J_i + w I (d, d), and the projectors (k, d, d)."""

def balanced_target(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    damping: float,
    guard: float,
    /,
) -> tuple[Array, float]:
    """x* (d,) of A x* = sum P_i J_i^T b_i (`balanced_system`), and a bound on sigma_min(A).

    Below `guard` a damping enters that grows from zero, so that x* stays bounded.
    """

def priority_weights(alpha: Array, ratio: float, spread: float, /) -> Array:
    """gamma_i = (1 - alpha_ii) r^(s_i), s_i = sum_j alpha_ji over active j != i; (k,).

    r is `ratio`, or less where many tasks are in: no gamma_i exceeds `spread`.
    """

def weighted_system(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    ratio: float,
    spread: float,
    damping: float,
    /,
) -> tuple[Array, Array]:
    """H = sum_i gamma_i J_i^T J_i + damping I, (d, d), and sum_i gamma_i J_i^T b_i, (d,)."""

def cholesky(matrix: Array, /) -> Array:
    """L (d, d) with L L^T = matrix; a column of a matrix singular to rounding is dropped."""

def inverse_factor(matrix: Array, /) -> Array:
    """F = L^-T (d, d) with matrix = L L^T, so that F F^T = matrix^-1."""

# QPs in the letters of QpProblem, their rows, and the checks of answers.

def qp_rows(
    basis: Array | None,
    offset: Array | None,
    parametrization: tuple[Any, ...],
    x_lower: Array,
    x_upper: Array,
    general: tuple[Any, ...] | None,
    soft: int,
    contacts: tuple[Any, ...] | None,
    torque_matrix: Array,
    torque_offset: Array,
    torque_force: Array,
    tau_lower: Array,
    tau_upper: Array,
    /,
) -> tuple[Array, Array, Array, Array]:
    """Normalized rows (r, p) on s of a Parametrization, their bounds and norms, (r,) each.

    In this order: accelerations, the first `soft` general ones, forces, torques, the other general
    ones. basis (n, d) and offset (n,) None: x = y; general and contacts: AccelerationRows,
    ContactRows; tau = torque_matrix y + torque_offset + torque_force f.
    """

def is_inside(value: Array, lower: Array, upper: Array, /) -> bool:
    """True where every entry lies between its bounds; False for NaN."""

def largest_excess(value: Array, lower: Array, upper: Array, /) -> float:
    """Largest distance of an entry from its bounds, at least 0; inf for NaN."""

def rows_inside(matrix: Array, x: Array, lower: Array, upper: Array, /) -> bool:
    """True where lower <= matrix x <= upper, of rows (r, d); False for NaN."""

def torques_inside(
    x: Array,
    matrix: Array,
    offset: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
    /,
) -> tuple[bool, Array]:
    """Whether accelerations (d,) and torques matrix x + offset lie in both boxes; torques (a,)."""

def contact_answer(
    y: Array,
    force: Array,
    offset: Array,
    basis: Array,
    torque_matrix: Array,
    torque_offset: Array,
    torque_force: Array,
    /,
) -> tuple[Array, Array]:
    """Accelerations (n,) and torques (a,) of reduced accelerations y (d,) and forces (c,)."""

def box_violation(
    mass_matrix: Array,
    bias: Array,
    x: Array,
    tau: Array,
    push: Array | None,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
    /,
) -> float:
    """Largest violation of both boxes and of M x + h = [0; tau] + push, push (n,)."""

def qp_not_finite(
    H: Array, g: Array, A: Array, b: Array, C: Array, lower: Array, upper: Array, /
) -> int:
    """Number of the first part that is not finite, -1 where all can be used."""

def kkt_residuals(
    H: Array,
    g: Array,
    A: Array,
    b: Array,
    C: Array,
    lower: Array,
    upper: Array,
    x: Array,
    y: Array,
    z: Array,
    units: Array | None,
    /,
) -> tuple[float, float, float, float, float]:
    """Primal, dual, complementarity, 1 + max |x|, 1 + the largest term of the stationarity.

    A violation of row r is multiplied by units[r]. NaN where the answer is not finite.
    """

def solve_dual(
    H: Array, g: Array, A: Array, b: Array, C: Array, lower: Array, upper: Array, limit: int, /
) -> tuple[int, int, Array, Array, Array]:
    """Dual active-set method of Goldfarb and Idnani, with at most `limit` pivots.

    Returns:
        0 solved, 1 infeasible, 2 limit, 3 failed; pivots, x (n,), multipliers (e,) and (r,) in
        the signs of QpResult.
    """

# References, previews, force control and states.

def evaluate(coefficients: Array, s: float, /) -> Array:
    """Value, first and second derivative at s of one polynomial (6, m), as rows of (3, m)."""

def turned_motion(
    start: Array, p: Array, rate: Array, change: Array, /
) -> tuple[Array, Array, Array]:
    """Quaternion, angular velocity and acceleration in world axes of start exp(p(t))."""

def integrate(state: Array, jerk: Array, step: float, /) -> Array:
    """States (N + 1, 3, 3) of three triple integrators under jerks (N, 3) held over steps."""

def state_at(state: Array, jerk: Array, step: float, elapsed: float, /) -> Array:
    """State (3, 3) `elapsed` [s] after the first one; after the last step it rests."""

def bounds_at(
    lower: Array, upper: Array, place: float, interpolate: bool, /
) -> tuple[Array, Array]:
    """Bounds (r,) at a place [points from the first] of points lower, upper (r, N + 1).

    Straight lines between points, or each point until the next one.
    """

def motion_of(points: Array, place: float, step: float, /) -> tuple[Array, Array]:
    """Rate and acceleration (r,) at a place [points from the first] of points (r, N + 1), N >= 4.

    Exact for points of a chain of three integrators whose jerk is the same over some steps;
    neither jumps inside a preview.
    """

def move_joints(
    rows: Array,
    first: int,
    goal: Array,
    rate: Array,
    lower: Array,
    upper: Array,
    velocity: Array,
    acceleration: Array,
    jerk: Array,
    brake: bool,
    /,
) -> None:
    """Fill states (s, 3, n) from `first` on towards goals (n,): `core/previews/motions.hpp`."""

def distance_row(
    jacobian: Array,
    position: Array,
    velocity: Array,
    drift: Array,
    normal: Array,
    state: Array,
    safe_distance: float,
    dt: float,
    row: Array,
    /,
) -> float:
    """Write n . J to row (n,) and return its lower bound, as in ObstacleDistance.

    jacobian (6, n), position (3,), velocity and drift (6,) of the frame; state (3, 3) of the
    obstacle: position, velocity, acceleration.
    """

def follow_force(
    under_force: NDArray[np.bool_],
    axes: NDArray[np.int64],
    step: float,
    share: float,
    reference: Array,
    wrench: Array,
    gains: tuple[float, float, float, float],
    integral: Array,
    error: Array,
    velocity: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    /,
) -> Array:
    """Write force error, gains and reference of a row at rest to the force rows; w_d (m,).

    gains: proportional, integral, damping, threshold; integral (m,) [N s] is advanced by `step`;
    share: of the reference that is commanded by now.
    """

def in_order(values: Array, index: NDArray[np.int64], /) -> tuple[Array, bool]:
    """The entries at `index` (n,), and whether all of them are finite."""

def force_limits(lower: Array, upper: Array, places: NDArray[np.intp], /) -> tuple[Array, Array]:
    """Bounds (k,) [N] on the normal forces of the contacts at `places`, of all contacts (c,).

    An upper one below zero means no force, and a lower one gives way to it.
    """

# What generators plan: the QPs of the thesis, solved by their structure.

def bounded_motion(
    step: float, state: Array, raw: Array, weights: Array, limit: Array, jerk_weight: float, /
) -> tuple[Array, bool]:
    """Jerks (N,) of eq. 4.14 with x_j <= limit_j, as in MotionQp, and whether they are optimal."""

def force_bounds(
    inverses: Array,
    pulls: Array,
    lower_now: float,
    upper_now: float,
    raw_lower: Array,
    raw_upper: Array,
    /,
) -> tuple[Array, bool]:
    """Upper above lower bound (2, N) of eq. 5.8, as in ForceBoundQp, and whether it is optimal.

    inverses (2, N, N) of both Hessians, pulls (2,): weights of the rates over T^2.
    """
