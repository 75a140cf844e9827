"""Take out of a PDF what is in optional content that is hidden: layers that are off (ISO 32000-1, section 8.11).

The bytes of a PDF -> the same without that, and how many operators that paint were taken out. PDFium has no call for
it. What is hidden still changes the graphics state, so only painting is taken out: a path is ended without being
painted, and objects and shadings are not drawn.
"""

from __future__ import annotations

import io
import re
from typing import Any, NamedTuple

import pikepdf

from foldcut.core.errors import FileFormatError

_PATHS = frozenset(("f", "F", "f*", "B", "B*", "b", "b*", "S", "s"))
_OTHERS = frozenset(("Do", "sh", "INLINE IMAGE"))
_DEEPEST = 50
"""Forms in forms, and memberships in memberships, are looked into no deeper than this."""


MOST_FORMS = 100_000
"""A page that draws more forms, counted as often as they are drawn, is refused."""

MOST_DRAWN = 200_000_000
"""A page is refused if its content comes to more bytes, with that of its forms as often as they are drawn."""

_DRAWS = re.compile(rb"/([^\s/<>()\[\]{}%]++)\s++Do\b")


class Shown(NamedTuple):
    """The bytes of a PDF whose first page shows only what can be seen, how much was taken out, and points to a unit."""

    data: bytes
    taken_out: int
    user_unit: float


def shown_page(data: bytes) -> Shown:
    """Return what the first page of a PDF shows; raises the errors of pikepdf."""
    with pikepdf.open(io.BytesIO(data)) as document:
        layers = _Layers(document.Root)
        page = document.pages[0]
        unit = float(page.obj.get("/UserUnit", 1))
        if not layers.hidden:
            return Shown(data, 0, unit)
        content = layers.cleaned(page.obj, page.obj.get("/Resources", page.get("/Resources", {})), 0)
        page.obj.Contents = document.make_stream(content)
        written = io.BytesIO()
        document.save(written)
    return Shown(written.getvalue(), layers.count, unit)


def require_few_forms(data: bytes) -> None:
    """Raise ``FileFormatError`` if the first page of a PDF draws too many forms; raises the errors of pikepdf, too.

    Forms in forms multiply; each is looked into once.
    """
    with pikepdf.open(io.BytesIO(data)) as document:
        page = document.pages[0].obj
        pikepdf.Page(page).contents_coalesce()
        forms, size = _drawn(page.get("/Contents"), page.get("/Resources", {}), {}, 0)
    if forms > MOST_FORMS or size > MOST_DRAWN:
        what = f"more than {MOST_FORMS:,} forms" if forms > MOST_FORMS else f"more than {MOST_DRAWN / 1e6:,.0f} MB"
        raise FileFormatError(f"the page draws {what}, counted as often as they are drawn; give a simpler drawing")


def _drawn(content: Any, resources: Any, known: dict[tuple[int, int], tuple[int, int]], depth: int) -> tuple[int, int]:
    """Return how many forms a content draws, and how many bytes all that comes to; ``known``: of forms so far."""
    if not isinstance(content, pikepdf.Stream):
        return 0, 0
    text = content.read_bytes()
    forms, size = 0, len(text)
    named = resources.get("/XObject", {})
    for name in _DRAWS.findall(text):
        form = named.get("/" + name.decode("latin-1"))
        if not isinstance(form, pikepdf.Stream) or form.get("/Subtype") != "/Form":
            continue
        if form.objgen not in known:
            known[form.objgen] = (0, 0)  # for a form that draws itself
            if depth < _DEEPEST:
                known[form.objgen] = _drawn(form, form.get("/Resources", resources), known, depth + 1)
        inner = known[form.objgen]
        forms, size = forms + 1 + inner[0], size + inner[1]
        if forms > MOST_FORMS or size > MOST_DRAWN:
            break
    return forms, size


class _Layers:
    """The layers of a document, and which of them are hidden."""

    def __init__(self, root: Any) -> None:
        self.count = 0
        self.hidden: set[tuple[int, int]] = set()
        self.seen: set[tuple[int, int]] = set()
        properties = root.get("/OCProperties", {})
        config = properties.get("/D", {})
        every = [group for group in properties.get("/OCGs", []) if isinstance(group, pikepdf.Dictionary)]
        if config.get("/BaseState") == "/OFF":
            self.hidden = {group.objgen for group in every}
        self.hidden -= {group.objgen for group in config.get("/ON", [])}
        self.hidden |= {group.objgen for group in config.get("/OFF", [])}
        for usage in config.get("/AS", []):
            if usage.get("/Event") == "/View" and "/View" in [str(one) for one in usage.get("/Category", [])]:
                for group in usage.get("/OCGs", []):
                    self._use(group)

    def _use(self, group: Any) -> None:
        """Take the state that a layer asks for on a screen."""
        state = group.get("/Usage", {}).get("/View", {}).get("/ViewState")
        if state == "/OFF":
            self.hidden.add(group.objgen)
        elif state == "/ON":
            self.hidden.discard(group.objgen)

    def hides(self, content: Any, depth: int = 0) -> bool:
        """Whether a layer, or a membership of several layers, is hidden."""
        if not isinstance(content, pikepdf.Dictionary) or depth > _DEEPEST:
            return False
        if content.get("/Type") != "/OCMD":
            return content.objgen in self.hidden
        if isinstance(content.get("/VE"), pikepdf.Array):
            return not self._holds(content["/VE"], depth)
        groups: Any = content.get("/OCGs", [])
        groups = [groups] if isinstance(groups, pikepdf.Dictionary) else list(groups)
        shown = [not self.hides(group, depth + 1) for group in groups if isinstance(group, pikepdf.Dictionary)]
        if not shown:
            return False
        policy = str(content.get("/P", "/AnyOn"))
        return not {
            "/AllOn": all(shown),
            "/AnyOff": not all(shown),
            "/AllOff": not any(shown),
        }.get(policy, any(shown))

    def _holds(self, expression: Any, depth: int) -> bool:
        """Whether an expression of layers is true."""
        if isinstance(expression, pikepdf.Dictionary) or depth > _DEEPEST or not len(expression):
            return not self.hides(expression, depth + 1)
        parts = [self._holds(part, depth + 1) for part in list(expression)[1:]]
        kind = str(expression[0])
        return not any(parts) if kind == "/Not" else any(parts) if kind == "/Or" else all(parts)

    def cleaned(self, holder: Any, resources: Any, depth: int) -> bytes:
        """Return the content of a page or a form without what is hidden; forms that it draws are changed in place."""
        kept: list[Any] = []
        nested: list[bool] = []
        for instruction in pikepdf.parse_content_stream(holder):
            operands: Any = instruction.operands
            name = str(instruction.operator)
            if name in ("BMC", "BDC"):
                nested.append(
                    name == "BDC" and str(operands[0]) == "/OC" and self.hides(_named(operands[1], resources))
                )
            elif name == "EMC" and nested:
                nested.pop()
            if name == "Do" and not any(nested):
                form = resources.get("/XObject", {}).get(str(operands[0]))
                if self._is_hidden_form(form, depth):
                    self.count += 1
                    continue
            if any(nested) and name in _PATHS:
                self.count += 1
                kept.append(([], pikepdf.Operator("n")))
            elif any(nested) and name in _OTHERS:
                self.count += 1
            else:
                kept.append(instruction)
        return bytes(pikepdf.unparse_content_stream(kept))

    def _is_hidden_form(self, form: Any, depth: int) -> bool:
        """Whether a form is hidden; if it is not, what is hidden in it is taken out."""
        if not isinstance(form, pikepdf.Stream):
            return False
        if self.hides(form.get("/OC")):
            return True
        if form.get("/Subtype") == "/Form" and form.objgen not in self.seen and depth < _DEEPEST:
            self.seen.add(form.objgen)
            form.write(self.cleaned(form, form.get("/Resources", {}), depth + 1))
        return False


def _named(operand: Any, resources: Any) -> Any:
    """Return the properties that a marked content has: its own, or those of the page by their name."""
    if isinstance(operand, pikepdf.Name):
        return resources.get("/Properties", {}).get(str(operand))
    return operand
