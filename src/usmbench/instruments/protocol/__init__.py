"""The wire between the PC and the signal generator board: frames, messages, constants."""
