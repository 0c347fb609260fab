"""Fill the marked regions of README.md and docs/ from the code, so that what is shown is what is there.

    python docs/refresh.py            write what has changed (`make docs` does it)
    python docs/refresh.py --check    say what would change; exit code 1 if anything would

A region lies between `<!-- show: WHAT -->` and `<!-- end -->`.  WHAT is one of

    path/to/file.py NAME              a function, class, method (Class.method) or assignment
    path/to/file.h NAME               a C function with the comment above it
    path/to/file                      a whole file
    graph PLATFORM KERNEL             the kernel's graph as SymPy's formulas give it
    optimised graph PLATFORM KERNEL   the same after the passes
    table NAME [ARGUMENTS]            one of TABLES
"""

from __future__ import annotations

import ast
import re
import sys
import textwrap
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path

import krhpr
from krhpr.codegen.build import Parts
from krhpr.codegen.composition import RobotFunction
from krhpr.codegen.graph import InputRef
from krhpr.codegen.kernel import GeometryField, Kernel
from krhpr.codegen.pipeline import TARGETS, derive
from krhpr.codegen.status import STATUS_DOC, Status
from krhpr.derivations.catalogue import Entry, catalogue
from krhpr.derivations.platforms.base import Platform
from krhpr.derivations.sublegs.base import SubLeg

ROOT = Path(__file__).resolve().parent.parent
LANGUAGES = {".py": "python", ".h": "c", ".c": "c", ".j2": "jinja", ".sh": "sh", ".yaml": "yaml"}
REGION = re.compile(r"(<!-- show: (?P<what>.+?) -->\n).*?(<!-- end -->)", re.DOTALL)


def pages() -> list[Path]:
    """Every page that may have regions."""
    return [
        ROOT / "README.md",
        ROOT / "templates" / "README.md",
        ROOT / "examples" / "README.md",
        *sorted((ROOT / "docs").glob("*.md")),
    ]


def refreshed(text: str) -> str:
    """A page's text with its regions filled."""
    return REGION.sub(lambda match: f"{match[1]}{shown(match['what'])}{match[3]}", text)


@cache
def shown(what: str) -> str:
    """The Markdown of one region."""
    kind, *arguments = what.split()
    if kind == "table":
        name, *rest = arguments
        return "\n" + TABLES[name](*rest).strip("\n") + "\n\n"
    if kind == "graph":
        return _fenced("text", _graph(_platform(arguments[0]), arguments[1], optimised=False))
    if what.startswith("optimised graph "):
        return _fenced("text", _graph(_platform(arguments[1]), arguments[2], optimised=True))
    path = ROOT / kind
    text = path.read_text(encoding="utf-8")
    if arguments:
        text = _python_part(text, *arguments) if path.suffix == ".py" else _c_function(text, *arguments)
    return _fenced(LANGUAGES.get(path.suffix, "text"), text)


def _fenced(language: str, text: str) -> str:
    return f"\n```{language}\n{textwrap.dedent(text).strip(chr(10))}\n```\n\n"


# -- excerpts -----------------------------------------------------------------------------------------------


def _python_part(text: str, name: str) -> str:
    """The source of a definition, with its decorators and the indentation removed."""
    body: Sequence[ast.stmt] = ast.parse(text).body
    node: ast.stmt | None = None
    for part in name.split("."):
        node = next((entry for entry in body if _name(entry) == part), None)
        if node is None:
            raise SystemExit(f"nothing is called {part!r} of {name!r} there")
        body = node.body if isinstance(node, ast.ClassDef) else ()
    assert node is not None
    first = min((entry.lineno for entry in getattr(node, "decorator_list", ())), default=node.lineno)
    return textwrap.dedent("\n".join(text.splitlines()[first - 1 : node.end_lineno]))


def _name(node: ast.stmt) -> str:
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return node.name
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return node.target.id
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id
    return ""


def _c_function(text: str, name: str) -> str:
    """A C function's definition with the comment above it."""
    lines = text.splitlines()
    definition = re.compile(rf"(KRHPR_\w+ )?\w+ \*?{name}\(")
    starts = [i for i, line in enumerate(lines) if definition.match(line)]
    starts = [i for i in starts if not lines[i].rstrip().endswith(";")]
    if not starts:
        raise SystemExit(f"no function is called {name!r} there")
    first = last = starts[0]
    while lines[last] != "}":
        last += 1
    if first and lines[first - 1].rstrip().endswith("*/"):
        first -= 1
        while not lines[first].startswith("/*"):
            first -= 1
    return "\n".join(lines[first : last + 1])


# -- graphs -------------------------------------------------------------------------------------------------

_SIGNS = {"add": " + ", "sub": " - ", "mul": " * ", "div": " / "}


def _graph(platform: Platform, kernel_name: str, *, optimised: bool) -> str:
    """The needed nodes of a kernel's graph, one a line, and its results."""
    kernels = Parts().platform(platform).kernels if optimised else platform.kernels()
    kernel = next(entry for entry in kernels if entry.name == kernel_name)
    needed = kernel.graph.needed(kernel.result_nodes)
    lines = []
    for index, node in kernel.graph:
        if not needed[index]:
            continue
        if isinstance(node.value, InputRef):
            text = _input(kernel, node.value)
        elif isinstance(node.value, Fraction):
            text = str(node.value)
        elif node.op.value in _SIGNS:
            text = _SIGNS[node.op.value].join(f"n{argument}" for argument in node.args)
        else:
            text = f"{node.op.value}({', '.join(f'n{argument}' for argument in node.args)})"
        name = kernel.graph.names.get(index)
        remark = f"{name.text}{name.component}{', ' + name.note if name.note else ''}" if name else ""
        lines.append(f"n{index:<3} = {text:<12} {'# ' + remark if remark else ''}".rstrip())
    for port in kernel.outputs:
        lines.append(f"{port.name} = ({', '.join(f'n{node}' for node in kernel.results[port.name])})")
    return "\n".join(lines)


def _input(kernel: Kernel, ref: InputRef) -> str:
    scalar = any(port.name == ref.port and not port.shape for port in kernel.inputs)
    scalar |= kernel.geometry is not None and any(f"g.{f.name}" == ref.port for f in kernel.geometry.fields)
    return ref.port if scalar else f"{ref.port}[{ref.index}]"


# -- tables -------------------------------------------------------------------------------------------------


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


@cache
def _functions(identifier: str) -> tuple[RobotFunction, ...]:
    return derive([_entry(identifier)]).robots[0].functions


def _entry(identifier: str) -> Entry:
    return next(entry for entry in catalogue() if entry.identifier == identifier)


def _subleg(space: str, name: str) -> SubLeg:
    found = (entry.robot.subleg for entry in catalogue())
    return next(subleg for subleg in found if subleg.space == space and subleg.name == name)


def _platform(name: str) -> Platform:
    return next(entry.robot.platform for entry in catalogue() if entry.robot.platform.name == name)


def sublegs() -> str:
    """The catalogue, a row for each sub-leg."""
    rows = []
    for leg in dict.fromkeys(entry.robot.subleg for entry in catalogue()):
        letters = [entry.robot.platform.arrangement for entry in catalogue() if entry.robot.subleg is leg]
        kinds = " ".join(joint.kind[0].upper() for joint in leg.actuators)
        freedom = leg.space.degrees_of_freedom
        name = f"{leg.space}_{leg.name}"
        rows.append(
            (
                f"`{name}_{letters[0]}`, " + ", ".join(f"`_{letter}`" for letter in letters[1:]),
                leg.notation,
                f"{freedom}+{3 * leg.n - freedom}",
                kinds,
                str(len(leg.modes)),
                _assembly_count(leg),
                leg.section,
            )
        )
    head = ("Robots", "Sub-leg", "Dof", "Actuators of a leg", "Working modes", "Assembly modes", "Thesis")
    return _table(head, rows)


def _assembly_count(leg: SubLeg) -> str:
    at_most = "up to " if leg.assembly_count > 2 else ""
    return f"{at_most}{leg.assembly_count}" + (", by a point" if leg.assembly_by_point else "")


def statuses() -> str:
    """Status codes."""
    rows = [(str(status.value), f"`{status.name}`", STATUS_DOC[status]) for status in Status]
    return _table(("Code", "Name", "Meaning"), rows)


def functions(identifier: str) -> str:
    """All functions of a robot with their arguments."""
    signatures = krhpr.load(identifier)
    rows = []
    for name in signatures.functions:
        signature = signatures.signature(name)
        inputs = ", ".join(port.name for port in signature.inputs)
        outputs = ", ".join(f"{port.name} {_shape(port.shape)}" for port in signature.outputs)
        rows.append((f"`{name}`", f"{inputs} → {outputs}", signature.equations, _reports(identifier, name)))
    return _table(("Function", "Inputs → results", "Thesis", "May report"), rows)


def _shape(shape: Sequence[int]) -> str:
    return "(" + ", ".join(["...", *map(str, shape)]) + ")"


def _reports(identifier: str, name: str) -> str:
    """The families of status codes, INVALID_INPUT apart, that a function may give."""
    every = {function.name: function for function in _functions(identifier)}
    function = every["inverse_all"] if name == "inverse_near" else every[name]
    families = []
    for guard in function.guards:
        text = guard.status.name.removesuffix("_1")
        if text not in families:
            families.append(text)
    return ", ".join(f"`{family}`" for family in families)


def reference(identifier: str) -> str:
    """Each function with every argument."""
    robot = krhpr.load(identifier)
    parts = []
    for name in robot.functions:
        signature = robot.signature(name)
        lines = [f"### `{name}`", "", signature.doc, ""]
        for word, ports in (("in", signature.inputs), ("out", signature.outputs)):
            for port in ports:
                unit = f" {port.unit}" if port.unit != "1" else ""
                frame = f", {port.frame} frame" if port.frame in ("base", "platform") else ""
                labels = f" [{', '.join(port.labels)}]" if port.labels else ""
                lines.append(f"* {word} `{port.name}` {_shape(port.shape)}{unit}{frame}: {port.doc}{labels}")
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def subleg(space: str, name: str) -> str:
    """Facts of one sub-leg."""
    leg = _subleg(space, name)
    rows = [("notation", leg.notation), ("thesis", leg.section)]
    rows += [(f"actuated `{joint.name}`", joint.doc) for joint in leg.actuators]
    rows += [(f"passive `{joint.name}`", joint.doc) for joint in leg.passive_joints]
    rows += [(f"mode `{sign.plus}` / `{sign.minus}`", sign.doc) for sign in leg.inverse_signs]
    rows += [(f"assembly `{sign.plus}` / `{sign.minus}`", sign.doc) for sign in leg.forward_signs]
    if leg.swivel is not None:
        rows.append((f"swivel `{leg.swivel.name}`", leg.swivel.doc))
    rows.append(("working modes", f"{len(leg.modes)}, by default `{leg.default_mode}`"))
    default = f", by default `{leg.default_assembly}`" if leg.forward_signs else ""
    rows.append(("assembly modes", _assembly_count(leg) + default))
    rows += [(f"singular factor `{name}`", doc) for name, doc in leg.factor_names()]
    return _table(("", ""), rows) + "\n\n" + _geometry(leg.geometry().fields)


def platform(name: str) -> str:
    """Facts of one arrangement."""
    plate = _platform(name)
    rows = [
        ("redundant link", plate.notation),
        ("thesis", plate.section),
        (f"redundant coordinate `{plate.redundant_joint.name}`", plate.redundant_joint.doc),
        ("constraint equations", plate.equations),
        ("singular set", plate.type_2_doc),
        ("margins", plate.margins_doc),
    ]
    return _table(("", ""), rows) + "\n\n" + _geometry(plate.geometry().fields)


def _geometry(fields: Iterable[GeometryField]) -> str:
    return _table(
        ("Length or angle", "Unit", "Meaning"),
        [(f"`{field.name}`", field.unit, field.doc) for field in fields],
    )


def targets() -> str:
    """The output languages."""
    rows = []
    for target in TARGETS:
        module = type(target).__module__.rsplit(".", 1)[-1]
        rows.append(
            (f"`{target.name}`", f"[{module}.py](../krhpr/codegen/targets/{module}.py)", _first_line(target))
        )
    return _table(("Target", "Module", "What"), rows)


def cmake_options() -> str:
    """The options of the CMake project, as its head tells them."""
    head = (
        (ROOT / "generated" / "c" / "CMakeLists.txt")
        .read_text(encoding="utf-8")
        .partition("cmake_minimum")[0]
    )
    rows: list[tuple[str, str]] = []
    for name, text in re.findall(r"^#   (KRHPR_\w+|) {2,}(\S.*)$", head, re.MULTILINE):
        if name:
            rows.append((f"`{name}`", text))
        elif rows:
            rows[-1] = (rows[-1][0], f"{rows[-1][1]} {text}")
    code = re.compile(r"-march=\w+|\w*<\w+>\w*")
    return _table(
        ("Option", "What, and what it is unless given"), [(a, code.sub(r"`\g<0>`", b)) for a, b in rows]
    )


def checks() -> str:
    """The kinds of checks that `krhpr validate` makes."""
    from krhpr.validation.plan import KINDS

    return _table(("Kind", "What is compared"), [(str(kind), text) for kind, text in KINDS.items()])


def _first_line(target: object) -> str:
    return (type(target).__doc__ or "").strip().splitlines()[0]


TABLES: dict[str, Callable[..., str]] = {
    "checks": checks,
    "cmake_options": cmake_options,
    "functions": functions,
    "platform": platform,
    "reference": reference,
    "statuses": statuses,
    "subleg": subleg,
    "sublegs": sublegs,
    "targets": targets,
}


def main(arguments: Sequence[str]) -> int:
    """Refresh every page, or say which ones differ."""
    differ = []
    for page in pages():
        if page.is_file():
            old = page.read_text(encoding="utf-8")
            new = refreshed(old)
            if new != old:
                differ.append(page.relative_to(ROOT).as_posix())
                if "--check" not in arguments:
                    page.write_text(new, encoding="utf-8")
    if differ:
        print(
            ("differ from the code, run `make docs`: " if "--check" in arguments else "wrote ")
            + ", ".join(differ)
        )
    return 1 if differ and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
