"""What is compared: the methods of the paper and their ablations."""

from __future__ import annotations

from ghc_controller.kinematics import KinematicSettings

_NO_REGION = 1e3  # [rad], [m] far beyond any step

# The columns of Table I. Gauss-Newton has the trust region without its adaptation, which
# reproduces the paper's figures; the box of dhqp is the same.
PAPER = {
    "gn_qn": KinematicSettings(),
    "dhqp": KinematicSettings(model="dhqp", adapts=False),
    "adls": KinematicSettings(model="adls"),
    "gn": KinematicSettings(model="gn", adapts=False),
}
ABLATIONS = {
    "newton": KinematicSettings(model="newton"),
    "lm": KinematicSettings(model="lm"),
    "gn_qn, fixed radius": KinematicSettings(adapts=False),
    "gn_qn, no region": KinematicSettings(trust_region=_NO_REGION, adapts=False),
    "newton, fixed radius": KinematicSettings(model="newton", adapts=False),
    "gn, adapted radius": KinematicSettings(model="gn"),
    "gn_qn, eps 1e-9": KinematicSettings(switch=1e-9),
}
VARIANTS = PAPER | ABLATIONS
INEQUALITIES = tuple(name for name in VARIANTS if name != "adls")  # those that can do T2, T20
REFERENCE = ("gn_qn", "dhqp", "gn")  # Xi is over the least of these: the paper leaves adls out
HUMANOID = tuple(
    name for name in INEQUALITIES if name not in ("gn_qn, no region", "gn_qn, eps 1e-9")
)
