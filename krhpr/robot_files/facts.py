"""What a robot file may say about each robot: its fields, joints and links, out of the robot's own code.

The same facts come from a generated module (for reading a file; NumPy alone is needed) and from derived code
(for the JSON schema, which must not depend on what is already generated).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from krhpr.robot_files.quantities import Kind

if TYPE_CHECKING:
    from krhpr.codegen.robot_code import RobotCode

Legs = tuple[float, float, float]

PLATFORM = "platform"
"""The name of the platform's edges among bodies."""

FIRST_LINK = ("l_1", "fixed", "A", "c")
"""The link that lies on the first axis."""


@dataclass(frozen=True)
class Field:
    """A length or angle of a leg, with the catalogue's values."""

    name: str
    kind: Kind
    doc: str
    positive: bool
    default: Legs


@dataclass(frozen=True)
class JointFact:
    """A joint whose coordinate can be limited."""

    name: str
    kind: Kind
    doc: str


@dataclass(frozen=True)
class Facts:
    """A robot of the catalogue as robot files know it."""

    identifier: str
    notation: str
    title: str
    fields: tuple[Field, ...]
    actuators: tuple[JointFact, ...]
    passive: tuple[JointFact, ...]
    spherical: JointFact | None
    links: tuple[str, ...]
    type_1: tuple[str, ...]
    """Limits of type I singularities that it can have."""
    requirements: tuple[str, ...]

    @property
    def space(self) -> str:
        """`spatial` or `planar`."""
        return choice(self.identifier)[0]

    @property
    def subleg(self) -> str:
        """The sub-leg's name."""
        return choice(self.identifier)[1]

    @property
    def arrangement(self) -> str:
        """The platform arrangement."""
        return choice(self.identifier)[2]


def choice(identifier: str) -> tuple[str, str, str]:
    """Space, sub-leg and arrangement of `<space>_<sub-leg>_<arrangement>`."""
    space, _, rest = identifier.partition("_")
    subleg, _, arrangement = rest.rpartition("_")
    return space, subleg, arrangement


def facts_of_module(module: Any) -> Facts:
    """The facts of a generated NumPy module."""
    geometry = module.DEFAULT_GEOMETRY
    return _facts(
        (module.IDENTIFIER, module.NOTATION, module.TITLE),
        module.DOCUMENTATION,
        {name: tuple(map(float, values)) for name, values in geometry.fields.items()},
        geometry.positive,
        module.SIGNATURES["passive_joints"].outputs,
        module.LINKS,
        module.REDUNDANT_LINK,
    )


def facts_of_code(robot: RobotCode) -> Facts:
    """The facts of derived code."""
    types = [part.geometry for part in (robot.subleg, robot.platform) if part.geometry is not None]
    return _facts(
        (robot.identifier, robot.notation, robot.title),
        robot.documentation,
        robot.default_geometry,
        [field.name for geometry in types for field in geometry.fields if field.positive],
        robot.function("passive_joints").outputs,
        robot.links,
        robot.redundant_link,
    )


def _facts(
    title: tuple[str, str, str],
    about: Mapping[str, tuple[tuple[str, str], ...]],
    defaults: Mapping[str, Any],
    positive: Iterable[str],
    passive: Sequence[Any],
    links: Sequence[tuple[str, str, str, str]],
    redundant_link: str,
) -> Facts:
    kinds = {name: Kind.ANGLE if kind == "revolute" else Kind.LENGTH for name, kind in about["joint kinds"]}
    units, known = dict(about["units"]), {str(kind): kind for kind in Kind}
    limited, spherical = [JointFact(name, kinds[name], doc) for name, doc in about["passive"]], None
    for port in passive:
        if port.name == "passive":
            continue
        joint = JointFact(port.name, known[str(port.unit)], port.doc)
        if joint.kind is Kind.NUMBER:  # a rotation
            spherical = joint
        else:
            limited.append(joint)
    return Facts(
        *title,
        fields=tuple(
            Field(name, known[units[name]], doc, name in set(positive), defaults[name])
            for name, doc in about["geometry"]
        ),
        actuators=tuple(JointFact(name, kinds[name], doc) for name, doc in about["actuators"]),
        passive=tuple(limited),
        spherical=spherical,
        links=tuple(dict.fromkeys([*(link[0] for link in links), *_of_platform(title[0], redundant_link)])),
        type_1=_type_1(title[0], links, kinds[about["actuators"][0][0]]),
        requirements=tuple(name for name, _ in about["requirements"]),
    )


def _of_platform(identifier: str, redundant_link: str) -> tuple[str, ...]:
    """Bodies beside links of sub-legs: the redundant link, and where it turns the platform's edges."""
    if not redundant_link:
        return ()
    return (redundant_link, PLATFORM) if choice(identifier)[2] == "a" else (redundant_link,)


def _type_1(identifier: str, links: Sequence[tuple[str, str, str, str]], first: Kind) -> tuple[str, ...]:
    """What can be limited: in space the distance from a first axis along link l_1, and elbows."""
    if choice(identifier)[0] == "planar":
        return ()
    turns = first is Kind.ANGLE and FIRST_LINK in map(tuple, links)
    bends = any(kind == "proximal" for _, kind, _, _ in links)
    return (*(("axis_distance",) if turns else ()), *(("elbow",) if bends else ()))
