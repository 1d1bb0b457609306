"""What stands on the bench: the signal generator, the encoder, the data acquisition card."""

import os

# gRPC reads this once, when it is first imported, and would write remarks of its own on a lost
# device server beside our message.
os.environ.setdefault("GRPC_VERBOSITY", "NONE")
