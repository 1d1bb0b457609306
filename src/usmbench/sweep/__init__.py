"""A sweep from its plan to its last window: plan, schedule, controller, interlocks."""
