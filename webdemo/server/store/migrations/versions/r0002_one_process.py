"""One process serves a lab: the tables by which several told each other what they did are dropped."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
DROPPED = ("places", "work", "processes", "endings", "ledger", "computed", "announcements")


def upgrade() -> None:
    """Drops them."""
    there = sa.inspect(op.get_bind())
    for table in set(DROPPED) & set(there.get_table_names()):
        op.drop_table(table)
    if "node" in {column["name"] for column in there.get_columns("runs")}:
        op.drop_column("runs", "node")
