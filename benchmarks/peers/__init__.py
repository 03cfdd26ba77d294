"""Compares control steps with tsid and placo, on the same recorded states, in turn in one run.

The two have weights or two levels where this project has exact levels, and wrenches at a contact
where it has point forces: they solve an easier problem. What else differs stands in `document.py`.
"""
