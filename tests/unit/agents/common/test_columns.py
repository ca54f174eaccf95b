"""The schema of the tables of results."""

from kswarms.agents.common.columns import ARM, TABLES, column_names, data_dictionary


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
    assert "\n| `mates_t_a_met` | real | robot-seconds | T(a) of its mates in conflicts with it |\n" in text
