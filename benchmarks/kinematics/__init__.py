"""The test bench of gn_qn_2018: T1 to T19 on a planar robot, T20 on a humanoid."""
