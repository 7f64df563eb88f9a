"""The rigid body: six degrees of freedom on four rotors, flown by loops of velocity, attitude and rate."""
