"""nominal.toml: what is read, and what is said of what cannot be."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from refusals import refusal
from skiplatch.campaign import (
    KEYS,
    AxisNominal,
    BenchNominal,
    InputNominal,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    format_nominal,
    read_nominal,
    toml_text,
)

GOOD = """\
format = "skiplatch-campaign/1"
kind = "machine"

[probe]
pretravel_um = 6.6163
lobe_um = -2.5
lobe_phase_deg = -110.99
repeatability_um = 0.25
delay_us = 500

[input]
filter_us = 5.0

[skip]
latency_us = 4.0
jitter_us = 1.0
tick_us = 0.5

[plc]
scan_us = 1_000.0

[axis]
resolution_um = 0.5
accel_mm_s2 = 3e3

[report]
latency_us = 500.0
jitter_us = 50.0

[bench]
reference_jitter_us = 0.0
"""

OPTIONAL = '; with format = "skiplatch-campaign/2" any may be left out'
NEEDS_2 = 'nominal.toml:12:1: unknown key "datum.free"; it needs format = "skiplatch-campaign/2"'


def read(folder: Path, text: str | bytes) -> Nominal:
    data = text if isinstance(text, bytes) else text.encode()
    (folder / "nominal.toml").write_bytes(data)
    return read_nominal(folder / "nominal.toml")


def complaint(folder: Path, text: str | bytes) -> str:
    return refusal(read, folder, text, folder=folder)


def with_line(old: str, new: str) -> str:
    assert GOOD.count(f"\n{old}\n") == 1
    return GOOD.replace(f"\n{old}\n", f"\n{new}\n")


def test_every_key_arrives_in_its_place(tmp_path: Path) -> None:
    assert read(tmp_path, GOOD) == Nominal(
        kind=Kind.MACHINE,
        probe=ProbeNominal(6.6163, -2.5, -110.99, 0.25, 500.0),
        input=InputNominal(5.0),
        skip=SkipNominal(4.0, 1.0, 0.5),
        plc=PlcNominal(1000.0),
        axis=AxisNominal(0.5, 3000.0),
        report=ReportNominal(500.0, 50.0),
        bench=BenchNominal(0.0),
    )


def test_integers_become_floats(tmp_path: Path) -> None:
    assert isinstance(read(tmp_path, GOOD).probe.delay_us, float)


@pytest.mark.parametrize("kind", list(Kind))
def test_both_kinds_are_read(tmp_path: Path, kind: Kind) -> None:
    assert read(tmp_path, with_line('kind = "machine"', f'kind = "{kind}"')).kind is kind


@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace("\n", "\r\n"),
        "\ufeff" + GOOD,
        GOOD.replace("[plc]\nscan_us = 1_000.0", "[plc] # of the shop\n'scan_us'=0x3e8"),
        GOOD.replace("[plc]\nscan_us", "[plc]\n#" + "-" * 900 + "\nscan_us"),
        GOOD.replace("\n[plc]\nscan_us", "")
        .replace("\nkind", "\nplc.scan_us = 1000\nkind")
        .replace(" = 1_000.0\n", ""),
        GOOD.replace("\n[plc]\nscan_us = 1_000.0\n", "").replace(
            "\nkind", "\nplc = { scan_us = 1000 }\nkind"
        ),
    ],
    ids=["CRLF", "byte order mark", "quoted key", "comment", "dotted key", "inline table"],
)
def test_the_same_written_otherwise_is_the_same(tmp_path: Path, text: str) -> None:
    assert read(tmp_path, text) == read(tmp_path, GOOD)


def test_formatted_text_has_the_order_of_the_format(tmp_path: Path) -> None:
    text = format_nominal(read(tmp_path, GOOD))

    assert [line.split(" = ")[0] for line in text.split("\n")] == [
        line.split(" = ")[0] for line in GOOD.split("\n")
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "delay_us = 500",
            "  delay = 500",
            'nominal.toml:9:3: unknown key "probe.delay"; did you mean "probe.delay_us"?',
        ),
        (
            "delay_us = 500",
            "delay_us = 500\ncolour = 3",
            'nominal.toml:10:1: unknown key "probe.colour"',
        ),
        (
            "tick_us = 0.5",
            "scan_us = 0.5",
            'nominal.toml:17:1: unknown key "skip.scan_us"; did you mean "plc.scan_us"?',
        ),
        ("[plc]", "[ plcs ]", 'nominal.toml:19:3: unknown key "plcs"; did you mean "plc"?'),
        ('kind = "machine"', 'kind = "machine"\nx = 1', 'nominal.toml:3:1: unknown key "x"'),
        ("[plc]", '["p l c"]', 'nominal.toml:19:2: unknown key "p l c"; did you mean "plc"?'),
        ("[plc]", '["\\n"]', 'nominal.toml: unknown key "\\n"'),
        ("[plc]", "[plc.x]\n[plc]", 'nominal.toml:19:2: unknown key "plc.x"'),
        ("[plc]", "[a.b.c.d]\n[plc]", 'nominal.toml:19:2: unknown key "a"'),
        ("delay_us = 500", "", f'nominal.toml:4: missing key "probe.delay_us"{OPTIONAL}'),
        ("scan_us = 1_000.0", "", f'nominal.toml:19: missing key "plc.scan_us"{OPTIONAL}'),
        ('kind = "machine"', "", f'nominal.toml: missing key "kind"{OPTIONAL}'),
        ("delay_us = 500", "[notes]\nwho = 3\n[datum]\nfree = 'axis'", NEEDS_2),
        ("[plc]", "min_mm = 3\n[plc]", 'nominal.toml:19:1: unknown key "skip.min_mm"'),
    ],
)
def test_wrong_keys_are_named_with_their_place(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    assert complaint(tmp_path, with_line(old, new)) == message


def test_unknown_keys_are_told_all_at_once(tmp_path: Path) -> None:
    text = GOOD.replace("delay_us = 500", "delay_us = 500\ncolour = 3").replace("[plc]", "[plcs]")

    assert complaint(tmp_path, text) == (
        'nominal.toml:10:1: unknown key "probe.colour"\n'
        f'{tmp_path}/nominal.toml:20:2: unknown key "plcs"; did you mean "plc"?'
    )


WRONG_AT_ONCE = {
    "delay_us = 500": "delay_us = -500",
    "lobe_um = -2.5": 'lobe_um = "2.5 mm"',
    "tick_us = 0.5": "tick_us = 0",
    "scan_us = 1_000.0": "scan_ms = 1",
    "filter_us = 5.0": "filter_us = {value = true, u = -1}",
}


def test_all_that_is_wrong_is_told_at_once_by_line(tmp_path: Path) -> None:
    text = GOOD.replace("campaign/1", "campaign/2")
    for good, wrong in WRONG_AT_ONCE.items():
        text = text.replace(good, wrong)
    text += "[datum]\nfree = 3\nu_um = -1\n"
    choices = '"none", "campaign", "axis", "axis_sense", "session" or "zero"'

    assert complaint(tmp_path, text).replace(f"{tmp_path}/", "").splitlines() == [
        'nominal.toml:6:11: probe.lobe_um: expected a number in µm, got "2.5 mm"',
        "nominal.toml:9:12: probe.delay_us: expected a number >= 0 in µs, got -500",
        "nominal.toml:12:13: input.filter_us: expected a number >= 0 in µs, got true",
        "nominal.toml:12:13: input.filter_us.u: expected a number >= 0, got -1",
        "nominal.toml:17:11: skip.tick_us: expected a number > 0 in µs, got 0",
        'nominal.toml:20:1: unknown key "plc.scan_ms"; did you mean "plc.scan_us"?',
        f"nominal.toml:33:8: datum.free: expected {choices}, got 3",
        "nominal.toml:34:8: datum.u_um: expected a number >= 0 in µm, got -1",
    ]


def test_missing_section_is_told_by_its_first_key(tmp_path: Path) -> None:
    text = GOOD.replace("[plc]\nscan_us = 1_000.0\n", "")

    assert complaint(tmp_path, text) == f'nominal.toml: missing key "plc.scan_us"{OPTIONAL}'


@pytest.mark.parametrize("section_and_key", [k for k, key in KEYS.items() if key.since == 1])
def test_every_key_of_version_1_is_required_in_it(
    tmp_path: Path, section_and_key: tuple[str, str]
) -> None:
    section, key = section_and_key
    text = re.sub(rf"(\[{section}\][^\[]*?)\n{key} = [^\n]*", r"\1", GOOD)

    assert complaint(tmp_path, text).endswith(f'missing key "{section}.{key}"{OPTIONAL}')


def test_all_missing_keys_are_told_at_once(tmp_path: Path) -> None:
    text = GOOD[: GOOD.index("[axis]")].replace("tick_us = 0.5", "").replace('kind = "machine"', "")

    assert complaint(tmp_path, text) == (
        'nominal.toml: missing keys "kind", "skip.tick_us", "axis.resolution_um", '
        '"axis.accel_mm_s2", "report.latency_us", "report.jitter_us", '
        f'"bench.reference_jitter_us"{OPTIONAL}'
    )


def test_missing_format_is_told(tmp_path: Path) -> None:
    assert complaint(tmp_path, "") == 'nominal.toml: missing key "format"'


def test_other_format_is_told_before_its_keys_are_judged(tmp_path: Path) -> None:
    assert complaint(tmp_path, 'format = "skiplatch-campaign/3"\nnew = 1\n') == (
        'nominal.toml:1:10: format: expected "skiplatch-campaign/1" or "skiplatch-campaign/2", '
        'got "skiplatch-campaign/3"'
    )


@pytest.mark.parametrize(
    ("written", "got"), [('"mill"', '"mill"'), ("1", "1"), ("[]", "an array"), ("{}", "a table")]
)
def test_wrong_kind_is_told(tmp_path: Path, written: str, got: str) -> None:
    assert complaint(tmp_path, with_line('kind = "machine"', f"kind = {written}")) == (
        f'nominal.toml:2:8: kind: expected "bench" or "machine", got {got}'
    )


@pytest.mark.parametrize(
    ("written", "got"),
    [
        ('"500"', '"500"'),
        ("true", "true"),
        ("false", "false"),
        ("[500]", "an array"),
        ("2020-01-01", "2020-01-01"),
        ("nan", "nan"),
        ("-0.001", "-0.001"),
        ("-500", "-500"),
        ("-inf", "-inf"),
        ('"a\\nb"', '"a\\nb"'),
    ],
)
def test_value_that_is_no_sensible_number_is_told(tmp_path: Path, written: str, got: str) -> None:
    assert complaint(tmp_path, with_line("delay_us = 500", f"delay_us = {written}")) == (
        f"nominal.toml:9:12: probe.delay_us: expected a number >= 0 in µs, got {got}"
    )


@pytest.mark.parametrize(
    ("written", "got"),
    [
        ("inf", "inf"),
        ("1.1e15", "1100000000000000.0"),
        ("1" + "0" * 400, "a whole number of many digits"),
        ("0x" + "f" * 900, "a whole number of many digits"),
    ],
)
def test_value_of_senseless_size_is_told(tmp_path: Path, written: str, got: str) -> None:
    assert complaint(tmp_path, with_line("delay_us = 500", f"delay_us = {written}")) == (
        f"nominal.toml:9:12: probe.delay_us: expected a number <= 1e+15 in µs, got {got}"
    )


@pytest.mark.parametrize(
    ("written", "expected", "got"), [("0", "> 0", "0"), ("1e-7", ">= 1e-06", "1e-07")]
)
def test_zero_and_next_to_it_are_no_tick(
    tmp_path: Path, written: str, expected: str, got: str
) -> None:
    assert complaint(tmp_path, with_line("tick_us = 0.5", f"tick_us = {written}")) == (
        f"nominal.toml:17:11: skip.tick_us: expected a number {expected} in µs, got {got}"
    )


def test_section_that_is_no_table_is_told(tmp_path: Path) -> None:
    text = GOOD.replace("[plc]\nscan_us = 1_000.0\n", "").replace("\nkind", "\nplc = 3\nkind")

    assert complaint(tmp_path, text) == "nominal.toml:2:7: plc: expected a table, got 3"


def test_section_given_as_an_array_is_told(tmp_path: Path) -> None:
    assert complaint(tmp_path, with_line("[plc]", "[[plc]]")) == (
        "nominal.toml:19: plc: expected a table, got an array"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("delay_us = 500", "delay_us = ", "nominal.toml:9:12: not valid TOML: Invalid value"),
        (
            "delay_us = 500",
            "delay_us = 500\ndelay_us = 3",
            "nominal.toml:10:13: not valid TOML: the key stands here a second time",
        ),
        ("[plc]", "[skip]", "nominal.toml:19:6: not valid TOML: Cannot declare ('skip',) twice"),
        ("[plc]", '[plc]\nx = """', "nominal.toml:32: not valid TOML: Unterminated string"),
        ("[plc]", "[plc]\nx = " + "[" * 990, "nominal.toml: not valid TOML: nested too deeply"),
    ],
    ids=["no value", "key twice", "section twice", "open string", "nesting"],
)
def test_syntax_error_is_told_with_its_place(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    assert complaint(tmp_path, with_line(old, new)) == message


def test_integer_too_long_to_convert_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(toml_text, "MAX_LINE_CHARACTERS", 10_000)

    message = complaint(tmp_path, with_line("delay_us = 500", "delay_us = " + "9" * 5000))

    assert message.startswith("nominal.toml: not valid TOML: Exceeds the limit (4300 digits)")


def test_bytes_that_are_no_utf8_are_told_with_their_line(tmp_path: Path) -> None:
    data = GOOD.encode().replace(b"[plc]", b"[plc] # \xb5s")

    assert complaint(tmp_path, data) == "nominal.toml:19: not UTF-8 text"


def test_huge_file_is_refused(tmp_path: Path) -> None:
    assert complaint(tmp_path, GOOD + "#\n" * 2**19) == (
        "nominal.toml: larger than 65536 bytes, which is the most that is read"
    )


def test_long_line_is_refused(tmp_path: Path) -> None:
    assert complaint(tmp_path, with_line("[plc]", "a" + ".a" * 500)) == (
        "nominal.toml:19: line of more than 1000 characters"
    )


def test_missing_file_is_told(tmp_path: Path) -> None:
    said = refusal(read_nominal, tmp_path / "nominal.toml", folder=tmp_path)

    assert said == "nominal.toml: cannot read: No such file or directory"


def test_folder_in_place_of_the_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "nominal.toml").mkdir()

    said = refusal(read_nominal, tmp_path / "nominal.toml", folder=tmp_path)

    assert said == "nominal.toml: not a regular file"


def test_number_the_format_does_not_admit_is_not_written(tmp_path: Path) -> None:
    good = read(tmp_path, GOOD)
    bad = replace(good, probe=replace(good.probe, delay_us=float("nan")))

    with pytest.raises(ValueError, match="delay_us: expected a number >= 0, got nan"):
        format_nominal(bad)
