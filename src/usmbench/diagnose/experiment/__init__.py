"""The next experiment: the plan that separates what is left."""
