"""Safety layer between solver and motors: modes, plausibility, torque gate, braking law."""
