"""Parameters of the controller node that change while it runs."""
