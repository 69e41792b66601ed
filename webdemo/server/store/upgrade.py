"""Brings the tables of an earlier version up to date: what is missing is added, and nothing is removed."""

from __future__ import annotations

from sqlalchemy import Engine, MetaData, Table, inspect
from sqlalchemy.exc import OperationalError, ProgrammingError
from sqlalchemy.schema import CreateColumn


def upgrade(engine: Engine, metadata: MetaData) -> None:
    """Adds missing tables, columns and indexes; several processes may do so at once.

    A new column of an old table needs a ``server_default``, which its old rows get, and which an earlier version of
    the program writes as well.
    """
    metadata.create_all(engine)
    for table in metadata.sorted_tables:
        for name in _missing(engine, table):
            column = CreateColumn(table.columns[name]).compile(dialect=engine.dialect)
            quoted = engine.dialect.identifier_preparer.format_table(table)
            try:
                with engine.begin() as connection:
                    connection.exec_driver_sql(f"ALTER TABLE {quoted} ADD COLUMN {column}")
            except (OperationalError, ProgrammingError):
                if name in _missing(engine, table):  # no other process has added it meanwhile
                    raise
        for index in table.indexes:
            try:
                index.create(engine, checkfirst=True)
            except (OperationalError, ProgrammingError):
                if index.name not in {found["name"] for found in inspect(engine).get_indexes(table.name)}:
                    raise


def _missing(engine: Engine, table: Table) -> list[str]:
    """The columns that a table does not have yet."""
    there = {column["name"] for column in inspect(engine).get_columns(table.name)}
    return [column.name for column in table.columns if column.name not in there]
