"""What a package outside the repository brings to the control stack."""
