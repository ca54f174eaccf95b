"""The schema of the tables of results."""

from kswarms.agents.common.columns import ARM, KEYS, LARGEST, TABLES, Column, column_names, data_dictionary


def test_column_names_can_be_selected_by_kind() -> None:
    assert column_names("robots") == ("run", "robot", "swarm", "policy", "pucks", "t_a", "t_p", "arms")
    assert column_names("robots", "text", "real") == ("run", "policy", "t_a", "t_p")


def test_column_names_of_a_table_are_unique() -> None:
    for table in TABLES:
        assert len(set(column_names(table))) == len(TABLES[table])


def test_the_data_dictionary_has_every_table_and_column() -> None:
    text = data_dictionary()
    assert text.count("\n| `") == sum(map(len, TABLES.values())) + len(ARM)
    assert "\n### `contribution.parquet`\n" in text
    assert "\n| `mates_t_a_met` | real | ≥ 0 | robot-seconds | T(a) of its mates in conflicts" in text
    assert "\nKey, different in every row: `run`, `robot`.\n" in text


def test_every_key_consists_of_columns_without_missing_values() -> None:
    for table, columns in TABLES.items():
        required = {column.name for column in columns if not column.may_be_missing}
        assert KEYS[table]
        assert set(KEYS[table]) <= required


def test_allowed_values_are_parsed() -> None:
    def column(kind: str, allowed: str) -> Column:
        return Column("x", kind, "", "", allowed)

    assert column("real", "").bounds == (-LARGEST, LARGEST)
    assert column("integer", "≥ 1").bounds == (1.0, LARGEST)
    assert column("real", "0 to 1 or missing").bounds == (0.0, 1.0)
    assert column("real", "or missing").may_be_missing
    assert column("text", "learning, game").choices == ("learning", "game")
    assert column("text", "").choices == ()
