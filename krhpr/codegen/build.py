"""From the catalogue's entry to what the printers take: parts optimised once and shared by robots."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import radians

from krhpr.codegen.kernel import LEGS, GeometryField
from krhpr.codegen.part import Part, optimise
from krhpr.codegen.robot_code import RobotCode
from krhpr.derivations import algebra
from krhpr.derivations.catalogue import Entry
from krhpr.derivations.grasping.catalogue import GraspingEntry
from krhpr.derivations.grasping.jaws import Jaws
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.sublegs.base import SubLeg
from krhpr.derivations.terms import Mode, Sign, Space

WORKING_BOX = (radians(30), radians(150))
"""Where redundant angles are looked for: free of type II, with unique solutions (errata, 4)."""


JAWS_DOC = (
    "Legs 1 and 2 of arrays are the right and the left sub-leg, which are legs 1, 2 and legs 3, 4 of the "
    "thesis.  Of the statuses NO_ASSEMBLY says that the jaws do not meet in B, SINGULAR_IN_PLANE that they "
    "are aligned, UNDETERMINED that the object has no width."
)


class Parts:
    """Parts built on first use."""

    def __init__(self) -> None:
        self._built: dict[str, Part] = {}

    def __iter__(self) -> Iterator[Part]:
        return iter(self._built.values())

    def subleg(self, subleg: SubLeg) -> Part:
        """The kernels of a sub-leg."""
        geometry = subleg.geometry()
        return self._get(geometry.name) or self._keep(
            optimise(geometry.name, subleg.doc, geometry, subleg.kernels())
        )

    def platform(self, platform: Platform | Jaws) -> Part:
        """The kernels of a platform arrangement."""
        geometry = platform.geometry()
        return self._get(geometry.name) or self._keep(
            optimise(geometry.name, platform.doc, geometry, platform.kernels())
        )

    def algebra(self, space: Space) -> Part:
        """The small products of one space."""
        name = f"algebra_{space}"
        doc = f"Small products that join sub-legs and platforms of {space} robots."
        return self._get(name) or self._keep(optimise(name, doc, None, algebra.kernels(space)))

    def _get(self, name: str) -> Part | None:
        return self._built.get(name)

    def _keep(self, part: Part) -> Part:
        self._built[part.name] = part
        return part


def build(entry: Entry | GraspingEntry, parts: Parts) -> RobotCode:
    """One robot, ready to print."""
    return _usual(entry, parts) if isinstance(entry, Entry) else _grasping(entry, parts)


def _usual(entry: Entry, parts: Parts) -> RobotCode:
    """A sub-leg on a platform, three times."""
    robot, subleg, platform = entry.robot, entry.robot.subleg, entry.robot.platform
    return RobotCode(
        identifier=entry.identifier,
        title=entry.title,
        notation=robot.notation,
        doc=f"{subleg.doc}  {platform.doc}",
        subleg=parts.subleg(subleg),
        platform=parts.platform(platform),
        algebra=parts.algebra(robot.space),
        functions=robot.functions(),
        default_geometry=entry.sizes,
        default_mode=_signs(subleg.modes, subleg.default_mode),
        default_assembly=_signs(subleg.assemblies, subleg.default_assembly),
        mode_names=tuple(sign.name for sign in subleg.inverse_signs),
        mode_labels=tuple(mode.label for mode in subleg.modes),
        mode_signs=tuple(mode.signs for mode in subleg.modes),
        assembly_labels=tuple(mode.label for mode in subleg.assemblies),
        assembly_signs=tuple(mode.signs for mode in subleg.assemblies),
        angular=tuple(joint.kind == "revolute" for joint in subleg.actuators),
        links=tuple((link.name, str(link.kind), link.start, link.end) for link in subleg.links),
        redundant_link=platform.redundant_link,
        home_p=entry.home.p,
        default_box=() if platform.closed_forward else (WORKING_BOX,) * LEGS,
        home_redundant=entry.home.redundant,
        documentation={
            **_leg_documentation(subleg, _fields(entry)),
            "swivel": () if subleg.swivel is None else ((subleg.swivel.name, subleg.swivel.doc),),
            "redundant": ((platform.redundant_joint.name, platform.redundant_joint.doc),),
            "singular factors": tuple(subleg.factor_names()),
            "type II": (("margins", platform.margins_doc), ("singular set", platform.type_2_doc)),
            "requirements": tuple(
                (str(required), required.doc) for required in (*subleg.requirements, *platform.requirements)
            ),
            "freedom": (
                ("platform", str(robot.space.degrees_of_freedom)),
                ("redundancy", str(3 * subleg.n - robot.space.degrees_of_freedom)),
            ),
            "assemblies": (
                ("count", str(subleg.assembly_count)),
                ("chosen by", _assembly_choice(subleg)),
            ),
            "sections": (
                ("sub-leg", subleg.section),
                ("platform", platform.section),
                ("robot", entry.thesis),
            ),
        },
    )


def _grasping(entry: GraspingEntry, parts: Parts) -> RobotCode:
    """Two sub-legs and two jaws."""
    robot, subleg, jaws = entry.robot, entry.robot.subleg, entry.robot.platform
    return RobotCode(
        identifier=entry.identifier,
        title=entry.title,
        notation=robot.notation,
        doc=f"{subleg.doc}  {jaws.doc}  {JAWS_DOC}",
        subleg=parts.subleg(subleg),
        platform=parts.platform(jaws),
        algebra=parts.algebra(robot.space),
        functions=robot.functions(),
        default_geometry=entry.sizes,
        default_mode=_signs(subleg.modes, subleg.default_mode),
        default_assembly=_signs(subleg.assemblies, subleg.default_assembly),
        mode_names=tuple(sign.name for sign in subleg.inverse_signs),
        mode_labels=tuple(mode.label for mode in subleg.modes),
        mode_signs=tuple(mode.signs for mode in subleg.modes),
        assembly_labels=tuple(mode.label for mode in subleg.assemblies),
        assembly_signs=tuple(mode.signs for mode in subleg.assemblies),
        angular=tuple(joint.kind == "revolute" for joint in subleg.actuators),
        links=tuple((link.name, str(link.kind), link.start, link.end) for link in subleg.links),
        redundant_link="l_j",
        home_p=entry.home.p,
        home_redundant=entry.home.redundant,
        documentation={
            **_leg_documentation(subleg, _fields(entry)),
            "redundant": ((jaws.redundant_joint.name, jaws.redundant_joint.doc),),
            "singular factors": tuple(subleg.factor_names()),
            "freedom": (("platform", "3"), ("redundancy", "1")),
            "sections": (("robot", entry.thesis),),
        },
    )


def _leg_documentation(
    subleg: SubLeg, fields: tuple[GeometryField, ...]
) -> dict[str, tuple[tuple[str, str], ...]]:
    """What there is to say of a sub-leg's geometry, branches and joints."""
    return {
        "geometry": tuple((field.name, field.doc) for field in fields),
        "units": tuple((field.name, str(field.unit)) for field in fields),
        "working mode": tuple((sign.name, _choice(sign)) for sign in subleg.inverse_signs),
        "assembly mode": tuple((sign.name, _choice(sign)) for sign in subleg.forward_signs),
        "actuators": tuple((joint.name, joint.doc) for joint in subleg.actuators),
        "actuated at": tuple(
            (joint.name, place)
            for joint, place in zip(subleg.actuators, subleg.actuated_at, strict=bool(subleg.actuated_at))
        ),
        "joint kinds": tuple(
            (joint.name, str(joint.kind)) for joint in (*subleg.actuators, *subleg.passive_joints)
        ),
        "passive": tuple((joint.name, joint.doc) for joint in subleg.passive_joints),
    }


def _fields(entry: Entry | GraspingEntry) -> tuple[GeometryField, ...]:
    return (*entry.robot.subleg.geometry().fields, *entry.robot.platform.geometry().fields)


def _assembly_choice(subleg: SubLeg) -> str:
    if subleg.assembly_by_point:
        return "point"
    return "sign" if subleg.forward_signs else ""


def _choice(sign: Sign) -> str:
    return f"{sign.plus} (+1) or {sign.minus} (-1): {sign.doc}"


def _signs(modes: Iterable[Mode], label: str) -> tuple[float, ...]:
    for mode in modes:
        if mode.label == label:
            return tuple(float(sign) for sign in mode.signs)
    raise ValueError(f"no branch is called {label!r}; there are {', '.join(mode.label for mode in modes)}")
