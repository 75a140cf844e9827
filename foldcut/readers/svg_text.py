"""From the bytes of an SVG file to its elements: encodings, and the entities that drawing programs declare.

A byte order mark decides on the encoding, or else the XML declaration, or else it is UTF-8 (XML 1.0, appendix F).
Entities may be declared in the file as plain text, as Illustrator does for its namespaces and styles; what they add up
to is bounded. Entities from elsewhere, or with elements or other entities in them, are refused.
"""

from __future__ import annotations

import codecs
import re
import xml.etree.ElementTree as ET
from collections import Counter
from functools import cached_property
from typing import Any

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import DefusedXMLParser

from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import Limits

LONGEST_ENTITY = 10_000
"""An entity with more letters is refused."""

MOST_ENTITY_LETTERS = 2_000_000
"""A file whose entities come to more letters, counted as often as they are used, is refused."""

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_WIDE = re.compile(r"utf[-_]?(16|32)|ucs[-_]?[24]|iso-10646-ucs-[24]", re.IGNORECASE)
_DECLARATION = re.compile(r"<\?xml\s[^<>]*?\?>")
_ENCODING = re.compile(rb"<\?xml\s[^>]*?\bencoding\s*=\s*[\"']([A-Za-z][A-Za-z0-9._-]*)[\"']")
_REFERENCE = re.compile(r"&([^&;\s#]{1,100});")
_NESTED = re.compile("<|&(?!#)")


def text_of(data: bytes) -> str:
    """Return the text of an XML file, without its XML declaration; raises ``FileFormatError`` if it has another one."""
    encoding, data = _encoding(data)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        name = {"utf-8": "UTF-8"}.get(encoding, encoding)
        raise FileFormatError(f"byte {error.start} is not {name}; save the file as UTF-8 text") from None
    except LookupError:
        raise FileFormatError(f"its encoding {encoding!r} is not known; save the file as UTF-8 text") from None
    if not text.strip():
        raise FileFormatError("the file is empty; give a file with at least one closed loop")
    return _DECLARATION.sub("", text, count=1)


def _encoding(data: bytes) -> tuple[str, bytes]:
    """Return the encoding of an XML file, and its bytes without a byte order mark."""
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return encoding, data[len(mark) :]
    for start, encoding in ((b"<\0", "utf-16-le"), (b"\0<", "utf-16-be")):
        if data.startswith(start):
            return encoding, data
    declared = _ENCODING.match(data.lstrip()[:500])
    if declared is None or _WIDE.fullmatch(declared[1].decode()):  # declared as wide, and yet it was read byte by byte
        return "utf-8", data
    name = declared[1].decode().lower()
    # Browsers read Latin-1 and ASCII as Windows-1252, and files mean that where they use codes in which these differ.
    return ("cp1252" if _is_western(name, data) else name), data


def _is_western(name: str, data: bytes) -> bool:
    western = ("iso-8859-1", "latin1", "latin-1", "us-ascii", "ascii")
    return name in western and any(0x80 <= code < 0xA0 for code in data)


def root_of(text: str, limits: Limits) -> ET.Element:
    """Return the outermost element of an XML text; raises ``FileFormatError`` where it cannot be read."""
    parser = _Parser(text, limits)
    try:
        parser.feed(text)
        root: ET.Element = parser.close()
    except ET.ParseError as error:
        raise FileFormatError(f"not XML: {error}; save the drawing again as plain SVG") from None
    except DefusedXmlException:
        raise FileFormatError(
            "the file declares XML entities that are in other files; save it as plain SVG without a DOCTYPE"
        ) from None
    except ValueError as error:  # for a sign that no XML may have
        raise FileFormatError(f"not XML: {error}; save the file as UTF-8 text") from None
    return root


class _Parser(DefusedXMLParser):  # type: ignore[misc]
    """The parser of defusedxml, which opens nothing; it allows entities that are plain text, of a bounded length."""

    def __init__(self, text: str, limits: Limits) -> None:
        super().__init__(target=ET.TreeBuilder(), forbid_entities=True, forbid_external=True)
        self.text, self.letters = text, 0
        self.most = min(MOST_ENTITY_LETTERS, limits.bytes)

    @cached_property
    def used(self) -> Counter[str]:
        """How often the text names each entity."""
        return Counter(_REFERENCE.findall(self.text))

    def defused_entity_decl(
        self, name: str, is_parameter: bool, value: str | None, base: Any, sysid: Any, pubid: Any, notation: Any
    ) -> None:
        """Allow an entity, or raise ``FileFormatError``."""
        if is_parameter or value is None:
            super().defused_entity_decl(name, is_parameter, value, base, sysid, pubid, notation)
        if value is None:
            return
        if _NESTED.search(value):
            raise FileFormatError(
                f"the file declares XML entities such as {name[:40]!r}, which has elements or other entities in it; "
                "save it as plain SVG without a DOCTYPE"
            )
        self.letters += len(value) * (1 + self.used[name])
        if len(name) > 100 or len(value) > LONGEST_ENTITY or self.letters > self.most:
            raise FileFormatError(
                f"the file declares XML entities that come to more than {self.most:,} letters, or one with more than "
                f"{LONGEST_ENTITY:,}; save it as plain SVG without a DOCTYPE"
            )
