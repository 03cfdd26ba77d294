"""Topics and fields of messages of earlier versions -> what they are now; docs/migration.md."""

from __future__ import annotations

# ruff: noqa: E501  (a row stays on its line)

MESSAGES: tuple[tuple[str, str], ...] = (
    (
        "`joint_states`, `odom`, plans: epoch in `header.frame_id`",
        "`frame_id` is a frame or empty; runs: `sim_bridge/epoch` (`Epoch`)",
    ),
    ("`joint_commands`: `header.frame_id` = `epoch@sender`", "`header.frame_id` = sender"),
    (
        "simulated time begins at 0 after a reset",
        "it goes on; times of a run count from `Epoch.start`",
    ),
    ("`ghc/tick`: `std_msgs/Header`", "`ghc_msgs/Tick`: `start`, `epoch`"),
    (
        "`constraints/contact_force_bounds` (`ContactForceBounds`)",
        "`constraints/preview` (`ConstraintPreviews`): `kind` contact_forces; `contacts` is `rows`, `in_contact` is `active`, epoch in `header.frame_id` is `epoch`, `valid_until` is the last of `points`",
    ),
    (
        "`constraints/obstacle_motion` (`ObstacleStateArray`)",
        "`constraints/preview`: `kind` obstacle_motion, `motions`",
    ),
    (
        "`ObstacleState` with velocity, acceleration, jerk and status",
        "`PlannedMotion`; `ObstacleState` is what a sensor sees",
    ),
    (
        "`ObstacleStateArray.step`, `valid_until`",
        "of `ConstraintPreview`; raw obstacles have none",
    ),
    (
        "`wait_for_bounds`: contact_force_bounds, obstacle_motion",
        "contact_forces, obstacle_motion",
    ),
    (
        "`rejected_constraints/contact_force_bounds`, `rejected_constraints/obstacle_motion` in counts",
        "`rejected_constraints/preview/<kind>`",
    ),
    (
        "`ControllerState.active_constraints`, `slack_names`, `slack`",
        "`ControllerState.rows[]` (`RowState`: `name`, `active`, `slack`)",
    ),
    (
        "`ControllerState.bounded_contacts`, `contact_lower`, `contact_upper`, `contact_forces`",
        "`ControllerState.contacts[]` with `planned` (`ContactState`: `name`, `lower`, `upper`, `force`)",
    ),
    (
        "`ControllerState.contacts` (names), `normal_forces`, `friction_use`",
        "`ControllerState.contacts[]` with `on` (`ContactState`: `name`, `force`, `friction_use`)",
    ),
    (
        "`TaskReference` without a reply",
        "`ghc/task_reference_status` (`TaskReferenceStatus`); field `id`",
    ),
    (
        "a contact schedule holds again after a reset",
        "it is forgotten; the planner sends it again, with stamps of the run",
    ),
)
