"""The interface of the challenge's package of 2023, over `airhockey`."""
