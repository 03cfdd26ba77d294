"""What stands between an answer and the motors: the torque gate and the braking law."""
