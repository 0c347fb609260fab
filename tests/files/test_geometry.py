"""Impossible sizes are refused with the reason, and hardly meant ones are told."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import krhpr
from krhpr import RobotFileError, RobotFileWarning
from krhpr.derivations.requirements import CHECKS, Requirement, end_points_never_collinear
from tests.files.support import FIVEBAR, PLANAR, Write, facts_of, the_problem

# -- end points on a line -----------------------------------------------------------------------------------


def sizes(
    lengths: list[float], radii: list[float], azimuths: list[float]
) -> dict[str, tuple[float, float, float]]:
    return {"l_r": tuple(lengths), "R_p": tuple(radii), "platform_azimuth": tuple(azimuths)}  # type: ignore[dict-item]


def least_area(given: dict[str, tuple[float, float, float]]) -> float:
    """The least of det J_n = twice the area of S_1 S_2 S_3 over all redundant angles, by a search."""
    from scipy.optimize import minimize

    l, R, a = (np.array(given[name]) for name in ("l_r", "R_p", "platform_azimuth"))

    def det(beta: np.ndarray) -> np.ndarray:
        x = R * np.cos(a) - l * np.cos(a - beta)
        y = R * np.sin(a) - l * np.sin(a - beta)
        return sum(x[..., i] * y[..., (i + 1) % 3] - x[..., (i + 1) % 3] * y[..., i] for i in range(3))  # type: ignore[return-value]

    grid = np.stack(np.meshgrid(*[np.linspace(-np.pi, np.pi, 25)] * 3), axis=-1).reshape(-1, 3)
    starts = grid[np.argsort(det(grid))[:3]]
    return min(float(minimize(lambda beta: float(det(beta)), start).fun) for start in starts)


@pytest.mark.parametrize(
    ("factor", "free"), [(0.5, True), (0.7499999, True), (0.75, False), (0.8, False), (2.0, False)]
)
def test_equal_legs_are_free_below_three_quarters_of_the_radius(factor: float, free: bool) -> None:
    thirds = [0.1, 0.1 + 2 * math.pi / 3, 0.1 + 4 * math.pi / 3]
    why = end_points_never_collinear(sizes([0.125 * factor] * 3, [0.125] * 3, thirds))
    assert (why is None) == free
    assert free or (why is not None and "3 R_p / 4 = 0.09375 m, (1.35)" in why)


@settings(max_examples=40)
@given(
    st.lists(st.floats(0.01, 0.2), min_size=3, max_size=3),
    st.lists(st.floats(0.08, 0.2), min_size=3, max_size=3),
    st.lists(st.floats(-0.4, 0.4), min_size=3, max_size=3),
)
def test_unequal_legs_are_judged_as_a_search_over_all_angles_does(
    lengths: list[float], radii: list[float], turns: list[float]
) -> None:
    azimuths = [turn + leg * 2 * math.pi / 3 for leg, turn in enumerate(turns)]
    given = sizes(lengths, radii, azimuths)
    area = least_area(given)
    if abs(area) > 1e-6:
        assert (end_points_never_collinear(given) is None) == (area > 0), area


def test_a_spatial_robot_with_long_redundant_links_is_refused(write: Write) -> None:
    problem = the_problem(write(FIVEBAR + "geometry:\n  R_p: 125 mm\n  l_r: 100 mm\n"))
    assert (problem.line, problem.field) == (6, "geometry")
    assert "must be less than 3 R_p / 4 = 0.09375 m" in problem.message
    problem = the_problem(write(FIVEBAR + "geometry: {l_r: [50 mm, 50 mm, 150 mm]}\n"))
    assert "a line meets all three circles of radius l_r about B_i" in problem.message
    assert krhpr.load(write(FIVEBAR + "geometry: {l_r: [50 mm, 50 mm, 120 mm]}\n")).name == "arm"


def test_a_planar_robot_may_have_them(write: Write) -> None:
    assert krhpr.load(write(PLANAR + "geometry: {R_p: 125 mm, l_r: 100 mm}\n")).geometry.l_r[0] == 0.1


def test_every_requirement_has_a_check_and_the_catalogue_meets_it() -> None:
    assert set(CHECKS) == set(Requirement)
    for identifier in krhpr.catalogue():
        facts = facts_of(identifier)
        for name in facts.requirements:
            assert CHECKS[Requirement(name)]({field.name: field.default for field in facts.fields}) is None


# -- closing ------------------------------------------------------------------------------------------------

HOME = "home: {p: [0, 0, 350 mm], redundant: 97 deg}\n"


def test_a_five_bar_that_does_not_close_at_home_is_refused_with_the_distance(write: Write) -> None:
    assert krhpr.load(write(FIVEBAR + HOME)).name == "arm"
    path = write(FIVEBAR + HOME + "geometry: {l_3: [300 mm, 20 mm, 300 mm]}\n")
    with pytest.raises(RobotFileError) as caught:
        krhpr.load(path)
    (problem,) = caught.value.problems
    assert (problem.line, problem.field) == (4, "home")
    assert "does not close there in any working mode: leg 2 misses by 0.2" in problem.message
    # by so much longer a rod, it just closes
    missing = float(problem.message.split("misses by ")[1].split(" m")[0])
    for factor, closes in ((0.98, False), (1.02, True)):
        path = write(FIVEBAR + HOME + f"geometry: {{l_3: [0.3, {0.02 + factor * missing:.6f}, 0.3]}}\n")
        if closes:
            assert krhpr.load(path).name == "arm"
        else:
            with pytest.raises(RobotFileError):
                krhpr.load(path)


def test_a_leg_that_is_too_short_is_named(write: Write) -> None:
    with pytest.raises(RobotFileError, match=r"leg 1 misses by 1\.\d+ m, leg 2 .*, leg 3"):
        krhpr.load(write(FIVEBAR + "home: {p: [0, 0, 2], redundant: 97 deg}\n"))
    with pytest.raises(RobotFileError, match="home: the robot does not close"):
        krhpr.load(write(PLANAR + "home: {p: [5, 0], redundant: 1.5}\n"))


@pytest.mark.parametrize("identifier", krhpr.catalogue())
def test_the_catalogues_robots_close_somewhere(identifier: str, write: Write) -> None:
    facts = facts_of(identifier)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        krhpr.load(write(f"space: {facts.space}\nsubleg: {facts.subleg}\narrangement: {facts.arrangement}\n"))


def test_without_a_home_pose_a_robot_that_closes_nowhere_is_told(write: Write) -> None:
    with pytest.warns(
        RobotFileWarning, match=r"arm.yaml, line 4: geometry: no pose was found in which all three"
    ):
        krhpr.load(write(PLANAR + "geometry: {R_b: 5, l_1: 0.1, l_2: 0.1}\n"))


def test_a_degenerate_leg_is_refused(write: Write) -> None:
    with pytest.raises(
        RobotFileError, match=r"line 4: geometry: with the sizes of leg 3 .* quotient by zero"
    ):
        krhpr.load(write(FIVEBAR + "geometry: {l_5: [0.4, 0.4, 0.3]}\n"))


@pytest.mark.parametrize(
    ("text", "field", "words"),
    [
        ("home: {p: [0, 0], redundant: 1}", "home.p", "found a list of 2, expected the 3 coordinates of O'"),
        ("home: {p: [0, 0, x], redundant: 1}", "home.p", "found x, expected a length"),
        ("home: {p: [0, 0, 0.3]}", "home", "redundant is missing"),
        ("home: {p: [0, 0, 0.3], redundant: 3 mm}", "home.redundant", "expected an angle"),
        ("home: {p: [0, 0, 0.3], redundant: 1, phi: 1}", "home", "unknown field 'phi' of home; "),
    ],
)
def test_mistakes_of_the_home_pose(text: str, field: str, words: str, write: Write) -> None:
    problem = the_problem(write(FIVEBAR + text + "\n"))
    assert (problem.line, problem.field) == (4, field) and words in problem.message


def test_slides_are_lengths(write: Write) -> None:
    text = "space: spatial\nsubleg: rrr\narrangement: c\nhome: {p: [0, 0, 350 mm], redundant: 100 mm}\n"
    assert krhpr.load(write(text)).name == "arm"
    assert "expected a length" in the_problem(write(text.replace("100 mm", "100 deg"))).message


# -- units --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("l_2: 150", "geometry.l_2: 150 m is very long; with millimetres in mind write `150 mm`"),
        ("l_2: [0.15, 150, 0.15]", "geometry.l_2[1]: 150 m is very long"),
        ("l_1: -50", "geometry.l_1: -50 m is very long; with millimetres in mind write `-50 mm`"),
        ("l_2: 150 m", "geometry.l_2: 150 m is very long"),
        ("l_2: 0.00015", "geometry.l_2: 0.00015 m is very short; with 0.00015 km in mind write `0.15 m`"),
        ("alpha: 120", "geometry.alpha: 120 rad is more than a turn; with degrees in mind write `120 deg`"),
    ],
)
def test_wrong_units_are_told_with_the_line(text: str, words: str, write: Write) -> None:
    from tests.files.support import read

    with pytest.warns(RobotFileWarning) as caught:
        read(write(FIVEBAR + f"geometry:\n  {text}\n"))
    assert str(caught[0].message).startswith(f"{write(FIVEBAR).parent / 'arm.yaml'}, line 5: {words}")


@pytest.mark.parametrize("text", ["l_2: 2", "l_2: 1 mm", "l_1: 0", "azimuth: 6.2", "azimuth: -400 deg"])
def test_usual_sizes_are_not_worth_a_word(text: str, write: Write, recwarn: pytest.WarningsRecorder) -> None:
    from tests.files.support import read

    read(write(FIVEBAR + f"geometry:\n  {text}\n"))
    assert not list(recwarn)


def test_a_suspicion_is_told_along_with_a_mistake_that_it_may_explain(write: Write) -> None:
    path = write(FIVEBAR + "geometry:\n  R_p: 0.000125\n")
    with pytest.raises(RobotFileError) as caught:
        krhpr.load(path)
    assert "very short" in str(caught.value) and "3 R_p / 4" in str(caught.value)


def test_a_warning_names_the_callers_line(write: Write) -> None:
    with pytest.warns(RobotFileWarning) as caught:
        krhpr.load(write(FIVEBAR + "geometry: {alpha: 7}\n"))
    assert Path(caught[0].filename) == Path(__file__)
