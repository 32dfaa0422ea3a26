"""Reading logs of CAN frames that other tools wrote, frame by frame."""
