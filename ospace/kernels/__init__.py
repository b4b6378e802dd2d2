"""The recursions: arrays and numbers in, arrays out."""
