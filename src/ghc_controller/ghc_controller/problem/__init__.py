"""The control problem of one tick, what contacts take from it, and its bounded QP."""
