"""Time per plan of the generators: `make bench`."""
