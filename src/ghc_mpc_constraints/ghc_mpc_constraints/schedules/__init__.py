"""What planners say ahead: bounds that hold from given times on."""
