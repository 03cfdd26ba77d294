"""Names of earlier versions: each gives an error that says the new one."""
