"""The tables of the versions before migrations: what a database of any of them lacks is made.

Those versions made missing tables when they started, and the later ones missing columns as well, so a database may
have any part of this.
"""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def _id(name: str = "id") -> sa.Column:
    return sa.Column(name, sa.String, primary_key=True)


def _text(name: str, kind: type = sa.String, **more: Any) -> sa.Column:
    return sa.Column(name, kind, nullable=False, **more)


def _number(name: str, kind: type = sa.Double, **more: Any) -> sa.Column:
    return sa.Column(name, kind, nullable=False, **more)


def _of(table: str, name: str, kind: type = sa.String, **more: Any) -> sa.Column:
    return sa.Column(name, kind, sa.ForeignKey(f"{table}.id", ondelete="CASCADE"), nullable=False, **more)


def _tables() -> sa.MetaData:
    tables = sa.MetaData()
    sa.Table(
        "runs", tables, _id(), _text("owner", index=True), _text("kind"), _text("title", sa.Text),
        _text("state", index=True), _text("request", sa.Text), _text("outcome", sa.Text), _text("message", sa.Text),
        _number("created", index=True), _number("stored", server_default="0", index=True),
        _number("size", sa.Integer), _text("address", server_default="", index=True),
        _number("favourite", sa.Boolean), _text("node"),
    )  # fmt: skip
    sa.Table(
        "notes", tables, _of("runs", "run_id", primary_key=True), _text("title", sa.Text), _text("tags", sa.Text),
        _text("text", sa.Text), sa.Column("frame", sa.Integer), _text("thumbnail", sa.Text), _text("kept", sa.Text),
        _text("part_of", index=True), sa.Column("removed", sa.Double, index=True),
    )  # fmt: skip
    sa.Table("links", tables, _id("token"), _of("runs", "run_id", index=True), _number("until"))
    sa.Table("sessions", tables, _id("digest"), _text("person", index=True), _text("entry"), _number("until"))
    sa.Table(
        "studies", tables, _id(), _text("owner", index=True), _text("key", unique=True), _text("title", sa.Text),
        _text("question", sa.Text), _text("sets", sa.Text), _text("pairs", sa.Text),
        _number("pairs_each", sa.Integer), _number("shows_sentence", sa.Boolean),
        _number("shows_result", sa.Boolean), _number("closed", sa.Boolean), _number("created"),
        _number("size", sa.Integer), _text("address", server_default="", index=True),
    )  # fmt: skip
    sa.Table(
        "raters", tables, sa.Column("id", sa.Integer, primary_key=True, autoincrement=True),
        _of("studies", "study_id", index=True), _text("person"), _text("address"), _text("plan", sa.Text),
        sa.UniqueConstraint("study_id", "person"),
    )  # fmt: skip
    sa.Table(
        "ballots", tables, _of("raters", "rater_id", sa.Integer, primary_key=True),
        sa.Column("pair", sa.Integer, primary_key=True), _text("ticket"), _number("swapped", sa.Boolean),
        _number("shown"), _text("answer"), _number("answered"),
    )  # fmt: skip
    sa.Table("places", tables, _id(), _text("person", index=True), _text("node", index=True), _number("seen"))
    sa.Table("work", tables, _id("person"), _id("node"), _number("units"), _number("seen", index=True))
    sa.Table(
        "ledger", tables, sa.Column("id", sa.Integer, primary_key=True, autoincrement=False), _number("elapsed"),
        _number("wall"), _number("accepted"), sa.Column("doubted", sa.Double), _number("ahead"),
        _number("turn", sa.Integer),
    )  # fmt: skip
    return tables


def upgrade() -> None:
    """Makes the tables, columns and indexes that are missing."""
    connection = op.get_bind()
    there = sa.inspect(connection)
    for table in _tables().sorted_tables:
        if not there.has_table(table.name):
            table.create(connection)
            continue
        columns = {column["name"] for column in there.get_columns(table.name)}
        indexes = {index["name"] for index in there.get_indexes(table.name)}
        for column in table.columns:
            if column.name not in columns:
                op.add_column(table.name, sa.Column(column.name, column.type, nullable=column.nullable,
                                                    server_default=column.server_default))  # fmt: skip
        for index in table.indexes:
            if index.name not in indexes:
                index.create(connection)
    op.execute("UPDATE runs SET stored = created WHERE stored = 0")


def downgrade() -> None:
    """Nothing: the versions before migrations read these tables as they are."""
