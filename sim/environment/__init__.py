"""What is around the vehicle: obstacles, contact with them, wind, and what rangefinders see."""
