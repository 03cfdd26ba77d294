"""From simulation to topics: control cycle, lockstep, realtime, commands and states."""
