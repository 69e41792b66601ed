"""Invitations to make an account."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Makes the table."""
    op.create_table(
        "invitations",
        sa.Column("digest", sa.String, primary_key=True),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("megabytes", sa.Double),
        sa.Column("until", sa.Double, nullable=False),
    )


def downgrade() -> None:
    """Removes it; links that were not used yet no longer work."""
    op.drop_table("invitations")
