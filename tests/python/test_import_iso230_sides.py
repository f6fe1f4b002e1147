"""``skiplatch import iso230``: a list whose cells, not its heads, tell the sense."""

from pathlib import Path

import pytest

from test_import_iso230_layouts import read


@pytest.mark.parametrize("minus", ["-", "\u2212"])
def test_side_with_signs_tells_the_sense(tmp_path: Path, minus: str) -> None:
    text = f"Side,Nominal,Dev [um]\n+,0,0\n+,100,1\n{minus},100,-5\n{minus},0,-6\n"

    run = read(tmp_path / "side", text)

    assert run.campaign.touches.sign.tolist() == [1.0, 1.0, -1.0, -1.0]
    assert not any("no column tells the sense" in line for line in run.said["assumed"])


@pytest.mark.parametrize(
    "text",
    [
        "Side,Nominal,Dev [um]\nL,0,0\nL,100,1\nR,100,-5\nR,0,-6\n",
        "Side,Direction,Nominal,Dev [um]\n-,+,0,0\n-,+,100,1\n+,-,100,-5\n+,-,0,-6\n",
    ],
)
def test_side_is_no_sense_where_it_has_none_or_another_column_tells_it(
    tmp_path: Path, text: str
) -> None:
    run = read(tmp_path / "side", text)

    assert run.campaign.touches.sign.tolist() == [1.0, 1.0, -1.0, -1.0]
    assert any("not needed: Side" in line for line in run.said["could_not_be_read"])


@pytest.mark.parametrize(("plus", "minus"), [("+", "-"), ("↑", "↓"), ("→", "←")])
@pytest.mark.parametrize(
    "heads", ["Posición [mm];Sentido;Pasada;Desviación [µm]", "Position (mm);Sens;Passe;Écart (um)"]
)
def test_list_in_another_language_is_told_by_its_signs_and_its_unit(
    tmp_path: Path, heads: str, plus: str, minus: str
) -> None:
    text = f"{heads}\n0;{plus};1;0,5\n100;{plus};1;1,5\n100;{minus};1;-5\n0;{minus};1;-6\n"

    touches = read(tmp_path / "list", text).campaign.touches

    assert touches.sign.tolist() == [1.0, 1.0, -1.0, -1.0]
    assert touches.position_mm.tolist() == [0.0, 100.0, 100.0, 0.0]
