"""Identities: accounts, sign-in, and visitors without an account."""
