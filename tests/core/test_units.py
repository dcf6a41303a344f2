"""Text with units: only a number and a unit are read; nothing is computed; the last bit is that of pint."""

import math
import random
import subprocess
import sys
import time

import pytest

from eigencontact import EigencontactError, load_scene, make
from eigencontact.core.units import _factors, parse_quantity

NAMES = {"m": "a length", "Pa": "a stress", "N": "a force", "rad": "an angle", "N*m": "a moment"}


def read(text, symbol="N"):
    return parse_quantity(text, symbol, NAMES.get(symbol, "a quantity"))


@pytest.mark.parametrize(
    ("text", "symbol", "value"),
    [
        ("105 um", "m", 1.05e-4),
        ("105um", "m", 1.05e-4),
        ("105 µm", "m", 1.05e-4),
        ("105 μm", "m", 1.05e-4),
        (" -1.5e-3 m ", "m", -1.5e-3),
        ("+.5 mm", "m", 5e-4),
        ("5. mm", "m", 5e-3),
        ("0 m", "m", 0.0),
        ("0.0e5 m", "m", 0.0),
        ("1 inch", "m", 0.0254),
        ("210 GPa", "Pa", 210e9),
        ("1 N/mm^2", "Pa", 1e6),
        ("1 N/mm**2", "Pa", 1e6),
        ("1 N / mm²", "Pa", 1e6),
        ("1 N mm^-2", "Pa", 1e6),
        ("0.65 kg m/s^2", "N", 0.65),
        ("2 N*mm", "N*m", 2e-3),
        ("2 N mm", "N*m", 2e-3),
        ("2 N·mm", "N*m", 2e-3),
        ("3 uN*m", "N*m", 3e-6),
        ("2 J", "N*m", 2.0),
        ("3", "rad", 3.0),
        ("-0.25", "rad", -0.25),
        ("3 mrad", "rad", 3e-3),
        ("90 deg", "rad", math.pi / 2),
        ("90 °", "rad", math.pi / 2),
        ("1e-5 / K", "1/K", 1e-5),
        ("1e-5/K", "1/K", 1e-5),
        ("1e-5 1/K", "1/K", 1e-5),
        ("1e-3 mm^3/J", "m^3/J", 1e-12),
    ],
)
def test_a_number_and_a_unit(text, symbol, value):
    assert read(text, symbol) == value


REFUSED = [
    "0,65 N",
    "1,5 N",
    "1 000 N",
    "1,000 N",
    "1'000 N",
    "1_000 N",
    "065 N",
    "00.5 N",
    "-065 N",
    "1 ± 0.1 N",
    "1 +- 0.1 N",
    "1 +/- 0.1 N",
    "1(2) N",
    "1.5.2 N",
    "1..5 N",
    "1.5 .2 N",
    "2*3 N",
    "2 * 3 N",
    "2+3 N",
    "1/2 N",
    "1 1/2 N",
    "1 2/N",
    "2**3 N",
    "9**9**9 N",
    "(2) N",
    "2 (N)",
    "N 2",
    "N",
    "",
    " ",
    "- 5 N",
    "−5 N",
    "--5 N",
    "1e N",
    "1e3.5 N",
    "1 e3 N",
    "0x10 N",
    "٣ N",
    "nan N",
    "inf N",
    "1 N N^",
    "1 N^99",
    "1 N^0.5",
    "1 N^9^9",
    "1 N**9**9",
    "1 N 2",
    "1 N, 2 N",
    "1 N; 2",
    "1 N/",
    "1 /N",
    "1 N//m",
    "1e400 N",
    "1e308 kN",
    "1e-400 N",
    "1 __import__('os')",
    "1 N.real",
    "1 5 N",
    "1 N\x00",
]


@pytest.mark.parametrize("text", REFUSED)
def test_anything_else_is_refused(text):
    with pytest.raises(ValueError, match=r"^a force \[N\]"):
        read(text)


@pytest.mark.parametrize("text", REFUSED[:14])
def test_the_message_shows_the_text(text):
    with pytest.raises(EigencontactError) as caught:
        load_scene("hertz", [f"steps.normal-load={text!r}"])
    assert str(caught.value).startswith("steps.normal-load must be a force [N], as a number or as text like")
    assert f"(got {text!r})" in str(caught.value)
    with pytest.raises(EigencontactError, match=r"sphere.radius must be a length \[m\]"):
        make("sphere", radius=text.replace("N", "m"))


def test_arithmetic_is_not_evaluated():
    began = time.perf_counter()
    for text in ("9**9**9 N", "9**9**9**9 N", "1e9**1e9 N", "1 N**9**9**9", "1 N" + "*N" * 1000, "1" * 10000 + "x2"):
        with pytest.raises(ValueError, match="a force"):
            read(text)
    assert time.perf_counter() - began < 5.0  # pint is imported for one of them


def test_the_last_bit_is_that_of_pint():
    from pint import UnitRegistry

    registry = UnitRegistry(cache_folder=None)
    random.seed(12)
    for symbol in ("m", "Pa", "N", "rad", "N*m"):
        for unit in filter(None, _factors(symbol)):
            for number in (
                str(random.randint(1, 10**6)),
                f"{random.uniform(0, 1000):.4f}",
                repr(random.uniform(0, 1) * 10.0 ** random.randint(-9, 9)),
            ):
                expected = float(registry.Quantity(f"{number} {unit}").to(symbol).magnitude)
                expected = expected if symbol == "rad" else float(f"{expected:.15g}")
                assert read(f"{number} {unit}", symbol) == expected, (number, unit)


def test_common_units_do_not_import_pint():
    code = (
        "import sys; from eigencontact import load_scene; load_scene('hertz', ['steps.tilt-x=0.1 deg']); "
        "sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_units_of_offset_are_refused():
    with pytest.raises(ValueError, match="a temperature"):
        parse_quantity("20 degC", "K", "a temperature")
    assert parse_quantity("20 K", "K", "a temperature") == 20.0
