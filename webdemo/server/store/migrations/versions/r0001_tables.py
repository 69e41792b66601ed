"""All tables."""

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


def upgrade() -> None:
    """Makes them."""
    tables = sa.MetaData()
    sa.Table(
        "runs",
        tables,
        _id(),
        _text("owner", index=True),
        _text("kind"),
        _text("title", sa.Text),
        _text("state", index=True),
        _text("request", sa.Text),
        _text("outcome", sa.Text),
        _text("message", sa.Text),
        _number("created", index=True),
        _number("stored", index=True),
        _number("size", sa.Integer),
        _text("address", index=True),
        _number("favourite", sa.Boolean),
        _text("node"),
    )
    sa.Table(
        "notes",
        tables,
        _of("runs", "run_id", primary_key=True),
        _text("title", sa.Text),
        _text("tags", sa.Text),
        _text("text", sa.Text),
        sa.Column("frame", sa.Integer),
        _text("thumbnail", sa.Text),
        _text("kept", sa.Text),
        _text("part_of", index=True),
        sa.Column("removed", sa.Double, index=True),
    )
    sa.Table("links", tables, _id("token"), _of("runs", "run_id", index=True), _number("until"))
    sa.Table(
        "published",
        tables,
        _id("key"),
        _text("owner", index=True),
        _of("runs", "run_id", index=True),
        _number("created"),
        _number("until"),
    )
    sa.Table("sessions", tables, _id("digest"), _text("person", index=True), _text("entry"), _number("until"))
    sa.Table(
        "people", tables, _id("key"), _text("role"), _number("suspended", sa.Boolean), sa.Column("megabytes", sa.Double)
    )
    sa.Table("computed", tables, _id("person"), _number("runs", sa.Integer), _number("seconds"))
    sa.Table(
        "announcements",
        tables,
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=False),
        _text("text", sa.Text),
    )
    sa.Table(
        "studies",
        tables,
        _id(),
        _text("owner", index=True),
        _text("key", unique=True),
        _text("question", sa.Text),
        _text("runs", sa.Text),
        _text("captions", sa.Text),
        _number("created"),
        _number("size", sa.Integer),
        _text("address", index=True),
    )
    sa.Table(
        "votes",
        tables,
        _of("studies", "study_id", primary_key=True),
        _id("person"),
        sa.Column("pair", sa.Integer, primary_key=True),
        _text("answer"),
        _number("swapped", sa.Boolean),
        _number("at"),
    )
    sa.Table("places", tables, _id(), _text("person", index=True), _text("node", index=True), _number("seen"))
    sa.Table("work", tables, _id("person"), _id("node"), _number("units"), _number("seen", index=True))
    sa.Table(
        "ledger",
        tables,
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=False),
        _number("elapsed"),
        _number("wall"),
        _number("accepted"),
        sa.Column("doubted", sa.Double),
        _number("ahead"),
        _number("turn", sa.Integer),
    )
    sa.Table("processes", tables, _id("node"), _number("seen"), _text("state", sa.Text))
    sa.Table("endings", tables, _id(), _number("came"))
    tables.create_all(op.get_bind())
