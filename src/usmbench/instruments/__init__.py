"""What stands on the bench: the signal generator, the encoder, the data acquisition card."""
