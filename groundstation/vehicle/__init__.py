"""The channel to the vehicle: transports, the setpoint gate, MAVSDK."""
