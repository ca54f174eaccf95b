"""The page of Mesa, `SolaraViz`, with a game."""

from typing import Any

import pytest

solara = pytest.importorskip("solara")
pytest.importorskip("altair")

from mesa.visualization import SolaraViz, make_plot_component  # noqa: E402

from kswarms import ForagingModel  # noqa: E402
from tests.helpers.rendered_page import RenderedPage  # noqa: E402

MODELS: list[ForagingModel] = []
PARAMETERS = {"n": 6, "policies": "avoid,attack", "duration": 60.0, "seed": "7"}


class Watched(ForagingModel):
    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        MODELS.append(self)


@solara.component  # type: ignore[untyped-decorator]
def App() -> None:  # noqa: N802  # a component
    with solara.AppLayout():
        SolaraViz(
            solara.use_memo(lambda: Watched(**PARAMETERS), []),
            components=[make_plot_component("pucks_1")],
            model_params=PARAMETERS,
        )


class MesaPage(RenderedPage):
    def __init__(self) -> None:
        self.box, self.context = solara.render(App(), handle_error=False)


@pytest.mark.slow
def test_the_page_of_mesa_plays_a_game_and_resets_it() -> None:
    page = MesaPage()
    try:
        page.click("Step")
        assert [model.time for model in MODELS] == [10.0]
        page.click("Reset")
        assert [(model.time, model.seed) for model in MODELS] == [(10.0, 7), (0.0, 7)]
    finally:
        page.context.close()
