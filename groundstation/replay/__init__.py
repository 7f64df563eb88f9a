"""A recorded flight once more: its inputs through today's pilot, or its hand through the simulator."""
