"""A model that was identified on speeds without sign is identified anew with the loss in place."""

from tests.usmbench.diagnose.anew.counted_shaft import found_again
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect


def test_the_loss_of_sign_is_named_and_the_motor_found_again() -> None:
    values = {"knee_rad_s": 1.0, "smoothing_s": 0.04}
    found_again(Applied(find_effect("unsigned_counts", "rectified"), values))
