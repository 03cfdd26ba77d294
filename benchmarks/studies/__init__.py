"""Studies: each module has NAME, TITLE, run(quick, formulations) -> dict and table(result)."""
