"""The operator's side of the paper (section 3.1): from the handle to the setpoint and back to the hand."""
