"""The hook that generates pages of the documentation."""

from pathlib import Path

import pytest

pytest.importorskip("mkdocs", reason="needs the extra `docs`")

from mkdocs.exceptions import PluginError

from kswarms.agents.common.columns import TABLES
from tests.helpers.scripts import load_script

ROOT = Path(__file__).parents[2]
pages = load_script(ROOT / "docs" / "build_pages.py")


@pytest.mark.parametrize(
    "tag",
    [
        '<script src="https://unpkg.com/mermaid">',
        '<link rel="stylesheet" href="//fonts.example/roboto.css">',
        '<img alt="badge" src="http://example.org/badge.svg">',
    ],
)
def test_a_page_that_loads_from_another_host_is_refused(tag: str) -> None:
    with pytest.raises(PluginError, match="another host: <"):
        pages.on_post_page(f"<html>{tag}</html>")


def test_a_page_may_link_to_another_host() -> None:
    page = '<a href="https://mesa.readthedocs.io">Mesa</a><img src="images/a.png"><script src="a"></script>'
    assert pages.on_post_page(page) == page


def test_the_reference_has_every_public_module() -> None:
    page = pages.reference("agents")
    for name in ("agents", "agents.policies.learner", "agents.conformance", "agents.conformance.rules"):
        assert f"\n::: kswarms.{name}\n" in f"{page}\n"
    assert "::: kswarms.scenarios.cli.__main__" not in pages.reference("scenarios")


def test_the_page_of_columns_has_every_table() -> None:
    page = pages.columns()
    for name in TABLES:
        assert f"### `{name}.parquet`" in page
    assert "| `pucks` | integer |" in page


@pytest.mark.slow
def test_a_notebook_page_shows_the_output_and_a_failing_notebook_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "small.py"
    path.write_text(
        "# %% [markdown]\n# # Title\n\n# %%\nprint('said')\n\n# %%\n6 * 7\n\n"
        "# %%\nimport pandas as pd\npd.DataFrame({'a': [1]})\n\n"
        "# %%\nimport matplotlib.pyplot as plt\nplt.plot([1, 2]);\n"
    )
    page, pictures = pages.notebook(path)
    for part in ("# Title", "print('said')\n```", "```text\nsaid\n", "```text\n42\n```", "<td>1</td>"):
        assert part in page
    assert 'class="dataframe"' not in page
    assert "![Output of the cell](small-1.png)" in page
    assert pictures["small-1.png"].startswith(b"\x89PNG")
    path.write_text("# %%\n1 / 0\n")
    with pytest.raises(PluginError, match=r"small\.py fails: ZeroDivisionError: division by zero"):
        pages.notebook(path)
