"""Robot, controller and operator on three hosts, over a bad network: `make hosts`."""
