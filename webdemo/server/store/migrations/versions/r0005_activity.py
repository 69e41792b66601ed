"""The work of each process, and the wishes of administrators that some of it ends."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Makes the tables."""
    op.create_table(
        "processes",
        sa.Column("node", sa.String, primary_key=True),
        sa.Column("seen", sa.Double, nullable=False),
        sa.Column("state", sa.Text, nullable=False),
    )
    op.create_table(
        "endings", sa.Column("id", sa.String, primary_key=True), sa.Column("came", sa.Double, nullable=False)
    )


def downgrade() -> None:
    """Removes them; running processes write them anew."""
    op.drop_table("endings")
    op.drop_table("processes")
