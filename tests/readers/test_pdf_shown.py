"""A PDF is read as PDFium paints it: layers, opacity, clips, colours in their order, and strokes."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pikepdf
import pytest
from pikepdf import Array, Dictionary, Name
from support.pictures import assert_alike, painted

from foldcut.readers import Drawing, ReadOptions, read_shape

SIDE = 200
KITE = "0 g 20 180 m 180 160 l 140 30 l 60 80 l h f "
FRAME = "0 g 5 5 190 190 re f "

Change = Callable[[pikepdf.Pdf, Any], None]


def pdf(content: str, *changes: Change) -> bytes:
    """Return a PDF of one page with two layers, Off (/L0) and On (/L1), and its content."""
    made = pikepdf.new()
    made.add_blank_page(page_size=(SIDE, SIDE))
    page = made.pages[0].obj
    off, on = (made.make_indirect(Dictionary(Type=Name.OCG, Name=name)) for name in ("Off", "On"))
    made.Root.OCProperties = Dictionary(OCGs=Array([off, on]), D=Dictionary(OFF=Array([off])))
    page.Resources = Dictionary(
        Properties=Dictionary(L0=off, L1=on),
        XObject=Dictionary(),
        ExtGState=Dictionary(Clear=Dictionary(ca=0, CA=0), NoFill=Dictionary(ca=0)),
    )
    for change in changes:
        change(made, page)
    page.Contents = made.make_stream(content.encode())
    written = io.BytesIO()
    made.save(written)
    return written.getvalue()


def membership(**entries: Any) -> Change:
    """Add /M, a membership of both layers or of what is given."""

    def change(made: pikepdf.Pdf, page: Any) -> None:
        both = Array([page.Resources.Properties.L0, page.Resources.Properties.L1])
        made_of = {name: value(both) if callable(value) else value for name, value in entries.items()}
        page.Resources.Properties.M = made.make_indirect(Dictionary(Type=Name.OCMD, **({"OCGs": both} | made_of)))

    return change


def base_state_off(made: pikepdf.Pdf, page: Any) -> None:
    made.Root.OCProperties.D = Dictionary(BaseState=Name.OFF, ON=Array([page.Resources.Properties.L1]))


def off_on_screens(made: pikepdf.Pdf, page: Any) -> None:
    layers = page.Resources.Properties
    layers.L1.Usage = Dictionary(View=Dictionary(ViewState=Name.OFF))
    usage = Dictionary(Event=Name.View, OCGs=Array([layers.L1]), Category=Array([Name.View]))
    made.Root.OCProperties.D.AS = Array([usage])


def form(name: str, content: str, **entries: Any) -> Change:
    def change(made: pikepdf.Pdf, page: Any) -> None:
        stream = made.make_stream(content.encode())
        stream.Type, stream.Subtype, stream.BBox = Name.XObject, Name.Form, Array([0, 0, SIDE, SIDE])
        for key, value in entries.items():
            stream[f"/{key}"] = value(page) if callable(value) else value
        page.Resources.XObject[f"/{name}"] = made.make_indirect(stream)

    return change


SHOWN = {
    "a layer that is off": pdf(f"/OC /L0 BDC {FRAME} EMC /OC /L1 BDC {KITE} EMC"),
    "base state": pdf(f"/OC /L0 BDC {FRAME} EMC /OC /L1 BDC {KITE} EMC", base_state_off),
    "usage": pdf(f"/OC /L1 BDC {FRAME} EMC {KITE}", off_on_screens),
    "layers in layers": pdf(f"/OC /L1 BDC /OC /L0 BDC /Span BMC {FRAME} EMC {FRAME} EMC {KITE} EMC"),
    "state in a layer": pdf(f"/OC /L0 BDC {FRAME} .5 0 0 .5 20 20 cm EMC {KITE}"),
    "clip in a layer": pdf(f"/OC /L0 BDC 0 0 100 200 re W f EMC {KITE}"),
    "all of several": pdf(f"/OC /M BDC {FRAME} EMC {KITE}", membership(P=Name.AllOn)),
    "any of several": pdf(f"/OC /M BDC {KITE} EMC /OC /L0 BDC {FRAME} EMC", membership()),
    "none of several": pdf(f"/OC /M BDC {FRAME} EMC {KITE}", membership(P=Name.AllOff)),
    "an expression": pdf(
        f"/OC /M BDC {FRAME} EMC {KITE}", membership(VE=lambda both: Array([Name.Not, Array([Name.Or, *both])]))
    ),
    "a form in a layer": pdf(f"/OC /L0 BDC /F Do EMC {KITE}", form("F", FRAME)),
    "a form of a layer": pdf(f"/F Do {KITE}", form("F", FRAME, OC=lambda page: page.Resources.Properties.L0)),
    "a layer in a form": pdf(
        "/F Do",
        form(
            "F",
            f"/OC /L0 BDC {FRAME} EMC {KITE}",
            Resources=lambda page: Dictionary(Properties=page.Resources.Properties),
        ),
    ),
    "opacity": pdf(f"q /Clear gs {FRAME} Q {KITE}"),
    "opacity of fills": pdf(f"q /NoFill gs 0 G {FRAME} Q {KITE}"),
    "opacity of strokes": pdf(f"q /Clear gs 0 G 9 w 5 5 190 190 re S Q {KITE}"),
    "a clip": pdf(f"q 0 0 100 200 re W n {KITE} Q"),
    "a clip that is no rectangle": pdf(f"q 100 20 m 190 190 l 10 150 l h W n {KITE} Q"),
    "two clips": pdf(f"q 30 0 100 200 re W n 100 20 m 190 190 l 10 150 l h W n {KITE} Q"),
    "a clip of a form": pdf(
        "q .8 .1 0 .9 9 9 cm 100 20 m 190 190 l 10 150 l h W n /F Do Q", form("F", f"0 90 200 80 re W n {KITE}")
    ),
    "a matrix of a form": pdf("q .5 0 0 .5 9 9 cm /F Do Q", form("F", KITE, Matrix=Array([1, 0.2, 0, 1, 20, 9]))),
    "a part of the page": pdf(
        KITE + "0 0 30 30 re f", lambda _, page: page.__setitem__("/CropBox", Array([0, 0, 120, 200]))
    ),
    "white over black": pdf(KITE + "1 g 100 20 30 80 re f"),
    "white, then black": pdf("1 1 1 rg 100 100 90 90 re f " + KITE),
}

STROKES = {
    "round": pdf("12 w 1 J 1 j 40 40 m 160 60 l 80 170 l S"),
    "mitred": pdf("12 w 40 40 m 160 60 l 80 170 l s"),
    "square": pdf("q 2 0 0 1 0 0 cm 12 w 2 J 2 j 20 40 m 80 60 l 40 170 l S Q"),
    "filled": pdf("12 w 40 40 m 160 60 l 80 170 l b"),
}


def read(folder: Path, data: bytes, **options: Any) -> Drawing:
    pytest.importorskip("pypdfium2")
    (folder / "a.pdf").write_bytes(data)
    return read_shape(folder / "a.pdf", ReadOptions(**options))


def compare(data: bytes, drawing: Drawing) -> None:
    import pypdfium2

    with pypdfium2.PdfDocument(data) as document:
        left, _, _, top = document[0].get_cropbox()
        picture = document[0].render().to_pil().convert("L")
    seen = 1 - np.asarray(picture, dtype=np.float64) / 255
    loops = [(loop - (left, top)) * (1, -1) for loop in drawing.loops]
    assert_alike(seen, painted(loops, picture.size))


@pytest.mark.parametrize("name", SHOWN)
def test_what_pdfium_paints_is_read(tmp_path: Path, name: str) -> None:
    compare(SHOWN[name], read(tmp_path, SHOWN[name]))


@pytest.mark.parametrize("name", STROKES)
def test_strokes_cover_what_pdfium_paints(tmp_path: Path, name: str) -> None:
    compare(STROKES[name], read(tmp_path, STROKES[name], strokes="outline"))


def test_what_is_not_shown_is_told(tmp_path: Path) -> None:
    assert read(tmp_path, SHOWN["a layer that is off"]).ignored == ("1 object in a hidden layer",)
    assert read(tmp_path, SHOWN["opacity"]).ignored == ("1 path that is not painted",)
    assert read(tmp_path, SHOWN["a clip"]).notes == ("1 outline cut off by clip paths",)


@pytest.mark.parametrize("unit", [1, 2, 0.5, 72 / 25.4])
def test_a_page_has_the_unit_that_it_states(tmp_path: Path, unit: float) -> None:
    drawing = read(tmp_path, pdf(KITE, lambda _, page: page.__setitem__("/UserUnit", unit)))
    assert drawing.unit_mm == pytest.approx(unit * 25.4 / 72)
    assert drawing.size_mm == pytest.approx((160 * unit * 25.4 / 72, 150 * unit * 25.4 / 72))
