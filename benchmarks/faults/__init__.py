"""Faults injected into running nodes over DDS, judged by a process that only listens."""
