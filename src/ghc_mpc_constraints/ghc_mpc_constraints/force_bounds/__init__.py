"""Generator of contact force bounds: schedules and smooth bounds on normal forces."""
