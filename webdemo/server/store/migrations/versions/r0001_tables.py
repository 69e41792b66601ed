"""The first tables. A database without any gets the newest at once, so that nothing is made here."""

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Nothing."""
