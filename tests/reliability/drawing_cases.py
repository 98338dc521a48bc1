# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings that are easy to misplace, written for drawing_raster_test.py: transforms, viewports, styles, dashes, clips.

A case is a body on a page of 40 x 30 mm whose user unit is the millimetre, drawn in red lines of 0.15 mm; or a whole file. `lacking` says what a
renderer does not have, in its own words or ours: its picture is then not asked."""
import dataclasses

WIDTH_MM, HEIGHT_MM = 40, 30


@dataclasses.dataclass
class Case:
    name: str
    body: str = ""
    root: str = ""  # further attributes of the outermost element
    whole: bytes = b""  # instead of body and root
    lacking: dict = dataclasses.field(default_factory=dict)
    quick: bool = False  # in the short form
    unit: str = ""  # user_unit, for files that do not say their size

    def file(self):
        if self.whole:
            return self.whole
        return (f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="{WIDTH_MM}mm" height="{HEIGHT_MM}mm" '
                f'viewBox="0 0 {WIDTH_MM} {HEIGHT_MM}" fill="none" stroke="red" stroke-width="0.15" stroke-linejoin="round" {self.root}>'
                f'{self.body}</svg>').encode()


def whole(text):
    return text.encode()


HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="30mm" '
LOOK = 'fill="none" stroke="red" stroke-width="0.15" stroke-linejoin="round"'
FLAG = "M2 2h12l-3 4 3 4h-12z"  # no symmetry: a mirror or a turn too much is seen
CSS_2D = {"inkscape": "has no `transform` in CSS"}
UNCLIPPED = {"inkscape": "does not clip a nested svg or a symbol"}
GEOMETRY = {"inkscape": "has no geometry properties in CSS"}

CASES = [
    # --- transforms ---
    Case("nested transforms", f'<g transform="translate(20,3) scale(1.5 1)"><g transform="rotate(30 4 4)"><path d="{FLAG}"/></g></g>', quick=True),
    Case("rotate about a point", f'<path d="{FLAG}" transform="rotate(-40, 20 15) translate(10 8)"/>'),
    Case("skews", f'<path d="{FLAG}" transform="translate(4) skewX(30)"/><path d="{FLAG}" transform="translate(4 12) skewY(15)"/>'),
    Case("matrix that mirrors", f'<path d="{FLAG}" transform="matrix(-1 0.2 0.1 1 30 5)"/>'),
    Case("numbers without blanks", f'<path d="{FLAG}" transform="translate(5-1)scale(1.2-1)translate(0-20)rotate(1e1)"/>'),
    Case("css transform", f'<path d="{FLAG}" style="transform: translate(12px, 8px) rotate(25deg) scale(1.2)"/>', lacking=CSS_2D, quick=True),
    Case("css transform wins over the attribute", f'<style>path {{ transform: translate(10px, 5px) }}</style><path d="{FLAG}" transform="scale(2)"/>',
         lacking=CSS_2D),
    Case("css angles", f'<path d="{FLAG}" style="transform: translate(16px) rotate(0.5rad)"/><path d="{FLAG}" style="transform: translate(30px,15px) rotate(50grad)"/>'
         f'<path d="{FLAG}" style="transform: translate(20px,28px) rotate(-0.25turn)"/>', lacking=CSS_2D),
    Case("css translate in millimetres and per cent", f'<path d="{FLAG}" style="transform: translate(25%, 10%)"/>'
         f'<path d="{FLAG}" style="transform: translateX(2mm) translateY(4mm)"/>', lacking=CSS_2D),
    Case("css skew and matrix", f'<path d="{FLAG}" style="transform: skew(20deg, 5deg)"/><path d="{FLAG}" style="transform: matrix(0.8,0.3,-0.3,0.8,20,12)"/>',
         lacking=CSS_2D),
    Case("transform-origin", f'<path d="{FLAG}" style="transform: rotate(35deg); transform-origin: 20px 15px"/>'
         f'<path d="{FLAG}" style="transform: rotate(180deg); transform-origin: center"/>', lacking=CSS_2D, quick=True),
    Case("transform-origin at a side", f'<path d="{FLAG}" style="transform: scale(-0.8, 0.8); transform-origin: center bottom"/>', lacking=CSS_2D),
    Case("fill-box", f'<path d="{FLAG}" style="transform-box: fill-box; transform-origin: 50% 50%; transform: rotate(90deg)" transform="scale(3)"/>',
         lacking=CSS_2D, quick=True),
    Case("fill-box of a group", f'<g style="transform-box: fill-box; transform-origin: right bottom; transform: rotate(20deg)"><path d="{FLAG}"/>'
         f'<circle cx="20" cy="12" r="4"/></g>', lacking=CSS_2D),
    Case("fill-box per cent", f'<rect x="4" y="4" width="10" height="6" style="transform-box: fill-box; transform: translate(100%, 200%)"/>', lacking=CSS_2D),
    Case("single transform properties", f'<path d="{FLAG}" style="translate: 14px 6px; rotate: 20deg; scale: 1.3 0.8"/>', lacking=CSS_2D),
    Case("transform-origin as attribute", f'<path d="{FLAG}" transform="rotate(30)" transform-origin="10 10"/>', lacking=CSS_2D),
    Case("invalid transform is none", f'<path d="{FLAG}" transform="rotate(30deg)"/><path d="M20 20h10" style="transform: rotate(30)" transform="rotate(5)"/>',
         lacking={"inkscape": "reads what it can of an invalid transform"}),
    Case("transform of the outermost element", f'<path d="{FLAG}"/>', root='style="transform: rotate(10deg)"', lacking=CSS_2D),

    # --- viewports ---
    Case("nested svg clips", '<svg x="5" y="5" width="15" height="12"><path d="M-5 3H30M8-9V40"/><circle cx="12" cy="9" r="6"/></svg>',
         lacking=UNCLIPPED, quick=True),
    Case("overflow visible", '<svg x="5" y="5" width="15" height="12" overflow="visible"><path d="M-3 3H30"/><circle cx="12" cy="9" r="6"/></svg>',
         lacking={"inkscape": "clips a nested svg whatever its overflow"}),
    Case("slice", '<svg x="4" y="4" width="20" height="8" viewBox="0 0 10 10" preserveAspectRatio="xMidYMid slice" stroke-width="0.07">'
         '<circle cx="5" cy="5" r="4.5"/><path d="M0 0L10 10M0 5h10"/></svg>', lacking=UNCLIPPED, quick=True),
    Case("slice at the corner", '<svg x="4" y="4" width="10" height="20" viewBox="0 0 10 10" preserveAspectRatio="xMaxYMin slice" stroke-width="0.07">'
         '<circle cx="5" cy="5" r="4.5"/><path d="M0 0L10 10"/></svg>', lacking=UNCLIPPED),
    Case("meet", '<svg x="4" y="4" width="30" height="10" viewBox="-5 -5 10 10" preserveAspectRatio="xMaxYMid" stroke-width="0.12"><circle r="4.5"/><path d="M-5-5L5 5"/></svg>'),
    Case("no aspect ratio", '<svg x="4" y="4" width="30" height="10" viewBox="0 0 10 10" preserveAspectRatio="none" stroke-width="0.08"><circle cx="5" cy="5" r="4"/></svg>'),
    Case("per cent", '<rect x="10%" y="10%" width="50%" height="50%"/><circle cx="50%" cy="50%" r="10%"/><line x1="0" y1="100%" x2="100%" y2="0"/>'),
    Case("per cent in a nested svg", '<svg x="25%" y="20%" width="50%" height="50%" viewBox="0 0 20 10"><rect x="10%" y="10%" width="80%" height="80%"/></svg>'),
    Case("turned nested svg", '<g transform="rotate(20 20 15)"><svg x="10" y="8" width="18" height="12"><circle cx="9" cy="6" r="8"/></svg></g>', lacking=UNCLIPPED),
    Case("viewBox off the origin", whole=whole(HEAD + f'viewBox="-10 -5 20 15" {LOOK} stroke-width="0.08"><path d="M-9-4h8l-2 3 2 3h-8z"/></svg>'.replace('stroke-width="0.15" ', ''))),
    Case("page of another aspect", whole=whole(HEAD + f'viewBox="0 0 30 30" preserveAspectRatio="xMinYMin meet" {LOOK}><path d="{FLAG}"/><circle cx="25" cy="25" r="4"/></svg>')),
    Case("units", '<rect x="0.2cm" y="2mm" width="0.3in" height="12pt"/><circle cx="1pc" cy="40px" r="8Q"/>',
         lacking={}, root=''),
    Case("pixels", whole=whole('<svg xmlns="http://www.w3.org/2000/svg" width="151.181102px" height="113.385827px" fill="none" stroke="red" stroke-width="0.5"><path d="M10 10h60l-20 20 20 20h-60z"/><rect x="1cm" y="2cm" width="2cm" height="5mm"/></svg>')),
    Case("zero width shows nothing", '<svg width="0" height="10"><path d="M0 0h10"/></svg><path d="M5 5h10"/>',
         lacking={"inkscape": "shows a nested svg without width"}),
    Case("em", '<g font-size="4"><rect x="1em" y="1em" width="4em" height="2em"/></g><rect x="20" y="15" width="1em" height="0.5em" font-size="10"/>'),

    # --- use and symbol ---
    Case("use with symbol and viewBox", '<symbol id="s" viewBox="0 0 10 10"><circle cx="5" cy="5" r="4.5"/><path d="M0 0L10 10"/></symbol>'
         '<use xlink:href="#s" x="3" y="3" width="12" height="12" stroke-width="0.12"/><use xlink:href="#s" x="20" y="5" width="15" height="20" stroke-width="0.1"/>', quick=True),
    Case("symbol is clipped", '<symbol id="s" viewBox="0 0 10 10"><circle cx="5" cy="5" r="7"/></symbol><use xlink:href="#s" x="5" y="5" width="15" height="15" stroke-width="0.1"/>', lacking=UNCLIPPED),
    Case("symbol of 100 %", '<symbol id="s" viewBox="0 0 40 30"><path d="M4 4h10l-3 5z"/></symbol><use xlink:href="#s"/>'),
    Case("use of an svg", '<defs><svg id="s" width="5" height="5" viewBox="0 0 10 10"><rect x="1" y="1" width="8" height="6"/></svg></defs>'
         '<use xlink:href="#s" x="2" y="2" stroke-width="0.3"/><use xlink:href="#s" x="10" y="5" width="20" height="20" stroke-width="0.08"/>',
         lacking={"inkscape": "draws an svg in <use> at its own size"}),
    Case("use that is moved and turned", f'<defs><path id="p" d="{FLAG}"/></defs><use xlink:href="#p" x="8" y="2" transform="rotate(30)"/><use xlink:href="#p" transform="translate(22 14) scale(1 -1)" y="-5"/>'),
    Case("use of a use", f'<defs><path id="p" d="{FLAG}"/><g id="q"><use xlink:href="#p"/><use xlink:href="#p" y="9"/></g></defs><use xlink:href="#q"/><use xlink:href="#q" x="18" y="5"/>'),
    Case("use inherits, the target decides", '<defs><path id="p" d="M2 5h10"/><path id="q" d="M2 9h10" stroke="none"/></defs><g stroke="none"><use xlink:href="#p" stroke="blue"/><use xlink:href="#q" stroke="blue"/><use xlink:href="#p" y="10"/></g>'),

    # --- styles ---
    Case("classes, ids, elements", '<style>path{stroke:none} .on{stroke:red} #off{stroke:none} path.blue{stroke:#00f}</style><path class="on" d="M2 3h20"/><path class="on" id="off" d="M2 6h20"/><path class="x blue y" d="M2 9h20"/><path d="M2 12h20"/>', quick=True),
    Case("descendants and children", '<style>g path{stroke:none} g>path{stroke:blue} g g path{stroke:red} a path{stroke:none}</style>'
         '<g><path d="M2 3h20"/><g><path d="M2 6h20"/></g><a><path d="M2 9h20"/></a></g><path d="M2 12h20"/>'),
    Case("attributes in selectors", '<style>[data-k]{stroke:none} [data-k="2"]{stroke:red} [data-k^="ab"]{stroke:blue} [data-k~="z"]{stroke:blue}</style>'
         '<path data-k="1" d="M2 3h20"/><path data-k="2" d="M2 6h20"/><path data-k="abc" d="M2 9h20"/><path data-k="x z" d="M2 12h20"/>',
         lacking={"inkscape": "knows fewer selectors"}),
    Case("important", '<style>.a{stroke:none!important} .b{stroke:red !important} .b{stroke:none}</style><path class="a" style="stroke:red" d="M2 3h20"/>'
         '<path class="b" d="M2 6h20"/><path class="a" style="stroke:blue !important" d="M2 9h20"/>', lacking={"inkscape": "weighs !important by rules of its own"}),
    Case("siblings and places", '<style>path:first-child{stroke:none} path:nth-child(2n+1){stroke:none} path+rect{stroke:blue} path~circle{stroke:none} g:not(.k) line{stroke:none}</style>'
         '<g class="k"><path d="M2 3h20"/><path d="M2 6h20"/><path d="M2 9h20"/><rect x="2" y="11" width="8" height="3"/><circle cx="30" cy="10" r="3"/><line x1="2" y1="20" x2="20" y2="20"/></g>'
         '<g><line x1="2" y1="22" x2="20" y2="22"/></g>', lacking={"inkscape": "knows fewer selectors"}),
    Case("media", '<style>@media print{path{stroke:none}} @media screen{.s{stroke:none}}</style><style media="print">path{stroke:none}</style><path d="M2 3h20"/><path class="s" d="M2 6h20"/>',
         lacking={"inkscape": "does not follow media"}, quick=True),
    Case("comments and strings", '<style>/* path{stroke:none} */ .a{fill:none/*x*/;stroke:/**/blue;font-family:"};path{stroke:none}"} @charset "x"; .b{stroke:none}</style><path class="a" d="M2 3h20"/><path class="b" d="M2 6h20"/><path style="/* stroke:none; */stroke:red" d="M2 9h20"/>',
         lacking={}),
    Case("geometry in css", '<style>circle{cx:10px;cy:10px;r:6px} rect{x:20px;y:5px;width:10px;height:8px;rx:3px}</style><circle/><rect/>', lacking=GEOMETRY),
    Case("colours", "".join(f'<path d="M2 {2 + i}h30" stroke="{c}"/>' for i, c in enumerate((
        "#f00", "#ff0000ff", "#f00f", "rgb(255,0,0)", "rgb(100%,0%,0%)", "rgba(255,0,0,1)", "hsl(0,100%,50%)", "hsla(240,100%,50%,1)", "crimson", "MidnightBlue",
        "rgb(0 0 255 / 100%)", "hsl(0.6667turn 100% 50%)", "darkslategray", "currentColor", "firebrick"))), root='color="blue"',
         lacking={"inkscape": "does not know all of CSS Color 4"}),
    Case("colours that are not painted", "".join(f'<path d="M2 {2 + 2 * i}h30" stroke="{c}"/>' for i, c in enumerate((
        "red", "transparent", "#f000", "rgba(255,0,0,0)", "hsla(0,100%,50%,0)", "none", "url(#nothing)", "url(#nothing) blue"))),
         lacking={"inkscape": "takes a missing paint for black"}),
    Case("prefixed names", whole=whole('<s:svg xmlns:s="http://www.w3.org/2000/svg" width="40mm" height="30mm" viewBox="0 0 40 30" fill="none" stroke="red" stroke-width="0.15">'
         '<s:g><s:path d="M2 2h12l-3 4z"/></s:g><o:path xmlns:o="other" d="M2 20h30"/></s:svg>')),

    # --- what is seen ---
    Case("not seen", '<g opacity="0"><path d="M2 3h20"/></g><path style="opacity:0%" d="M2 5h20"/><path stroke-opacity="0" d="M2 7h20"/><path visibility="hidden" d="M2 9h20"/>'
         '<g visibility="hidden"><path d="M2 11h20"/><path visibility="visible" d="M2 13h20"/></g><g display="none"><path d="M2 15h20"/></g><path style="display:none" d="M2 17h20"/><path stroke-width="0" d="M2 19h20"/><path d="M2 21h20"/>',
         lacking={"inkscape": "exports what visibility hides"}, quick=True),
    Case("switch", '<switch><path systemLanguage="de" d="M2 3h20"/><path systemLanguage="fr, en" d="M2 6h20"/><path d="M2 9h20"/></switch>'
         '<switch><g requiredExtensions="http://example.org/x"><path d="M2 12h20"/></g><g><path d="M2 15h20"/></g></switch><path systemLanguage="de" d="M2 18h20"/>'),
    Case("defs are not drawn", '<defs><path d="M2 3h20"/></defs><symbol><path d="M2 6h20"/></symbol><pattern id="x"><path d="M2 9h20"/></pattern><path d="M2 12h20"/>'),
    Case("unknown elements are not drawn", '<thing><path d="M2 3h20"/></thing><path d="M2 12h20"/>', lacking={"inkscape": "may show what it does not know"}),
    Case("fills", '<path d="M3 3h12l-4 8z" fill="red" stroke="none"/><rect x="20" y="3" width="10" height="8" rx="2" fill="blue" stroke="none"/>'
         '<path d="M3 15h10v10" fill="black" stroke="none"/><circle cx="26" cy="20" r="5" fill="red" stroke="none"/>'),

    # --- dashes ---
    Case("dashes", '<path d="M2 4h30" stroke-dasharray="3 1.5"/><circle cx="12" cy="16" r="7" stroke-dasharray="4,2"/><rect x="24" y="9" width="12" height="14" stroke-dasharray="5 2"/>', quick=True),
    Case("odd number of dashes", '<path d="M2 4h36" stroke-dasharray="5 2 1"/><path d="M2 8h36M2 11h10" stroke-dasharray="4"/>'),
    Case("dash offset", '<path d="M2 4h36" stroke-dasharray="5 3" stroke-dashoffset="2"/><path d="M2 8h36" stroke-dasharray="5 3" stroke-dashoffset="-3"/><path d="M2 12h36" style="stroke-dasharray:5px,3px;stroke-dashoffset:21"/>'),
    Case("pathLength", '<path d="M2 4h36" pathLength="10" stroke-dasharray="2 1"/><g transform="scale(0.1)" stroke-width="1.5"><circle cx="200" cy="180" r="80" pathLength="8" stroke-dasharray="1 1.1"/></g>',
         lacking={"inkscape": "has no pathLength"}),
    Case("dashes through a transform", '<g transform="translate(2 2) scale(3 1.5)" stroke-width="0.07"><path d="M0 2h11L6 12z" stroke-dasharray="2 1"/></g>'),
    Case("dashes of per cent", '<path d="M2 4h36M2 8c10 0 20 20 30 15" stroke-dasharray="10% 5%"/>'),
    Case("invalid dashes are whole lines", '<path d="M2 4h36" stroke-dasharray="5 -3"/><path d="M2 8h36" stroke-dasharray="0 0"/><path d="M2 12h36" stroke-dasharray="none"/>',
         lacking={"inkscape": "draws nothing for negative dashes"}),
    Case("dashes that do not scale", '<g transform="translate(2 2) scale(2)"><path d="M0 2h16" stroke-width="0.6" stroke-dasharray="12 6" vector-effect="non-scaling-stroke"/></g>',
         lacking={"inkscape": "scales dashes all the same"}),
    Case("dashed curves", '<path d="M3 20C3 2 20 2 20 15S30 28 37 5" stroke-dasharray="3 2"/>'),

    # --- clips ---
    Case("clip by a rectangle", '<clipPath id="c"><rect x="8" y="6" width="16" height="12"/></clipPath><g clip-path="url(#c)"><circle cx="16" cy="12" r="8"/><path d="M0 0L40 30"/></g>', quick=True),
    Case("clip by a polygon", '<clipPath id="c"><polygon points="5,5 30,8 18,26"/></clipPath><path clip-path="url(#c)" d="M0 10h40M0 15h40M0 20h40M15 0v30"/>'),
    Case("clip by a circle", '<clipPath id="c"><circle cx="20" cy="15" r="9"/></clipPath><g style="clip-path:url(#c)"><path d="M0 0L40 30M0 30L40 0"/><rect x="13" y="2" width="14" height="26"/></g>'),
    Case("clip with a hole", '<clipPath id="c"><path clip-rule="evenodd" d="M5 5h30v20h-30zM12 10h16v10h-16z"/></clipPath><path clip-path="url(#c)" d="M0 15h40M20 0v30M0 7h40"/>'),
    Case("clips in clips", '<clipPath id="a"><rect x="5" y="5" width="20" height="20"/></clipPath><clipPath id="b" clip-path="url(#a)"><circle cx="22" cy="15" r="9"/></clipPath><g clip-path="url(#b)"><path d="M0 10h40M0 15h40M0 20h40"/></g>',
         lacking={"inkscape": "does not clip a clip"}),
    Case("clip in the box's units", '<clipPath id="c" clipPathUnits="objectBoundingBox"><rect x="0.25" y="0.25" width="0.5" height="0.75"/></clipPath><circle clip-path="url(#c)" cx="18" cy="14" r="10"/>', lacking={"inkscape": "hides what such a clip shows"}),
    Case("clip moved with its user", '<clipPath id="c" transform="translate(2 1)"><rect x="4" y="4" width="10" height="8"/></clipPath><g transform="translate(5 3) rotate(15)" clip-path="url(#c)"><path d="M0 0L30 20M0 20L30 0"/></g>', lacking={"inkscape": "leaves out the clip's own transform"}),
    Case("clip by a used shape", '<defs><circle id="k" cx="10" cy="10" r="7"/></defs><clipPath id="c"><use xlink:href="#k" x="6"/><rect x="2" y="20" width="10" height="6"/></clipPath><path clip-path="url(#c)" d="M0 8h40M0 12h40M0 23h40"/>'),
    Case("empty clip hides", '<clipPath id="c"/><path clip-path="url(#c)" d="M2 3h20"/><path clip-path="url(#gone)" d="M2 6h20"/>', lacking={"inkscape": "takes an empty clip for none"}),
    Case("clipped fills", '<clipPath id="c"><rect x="8" y="6" width="16" height="12"/></clipPath><circle clip-path="url(#c)" cx="8" cy="12" r="8" fill="red" stroke="none"/>'),
    Case("lines on the clip's edge", '<clipPath id="c"><rect x="8" y="6" width="16" height="12"/></clipPath><rect clip-path="url(#c)" x="8" y="6" width="16" height="12"/>'),

    # --- path data and text ---
    Case("arcs", '<path d="M3 10a6 4 20 1 1 10 0M20 10A 5 5 0 0 1 30 10M5 22a.1 .1 0 0 0 8 0M20 22a8 3 -30 0 1 12 4zM34 5a3 3 0 10.1 0"/>', quick=True),
    Case("smooth curves", '<path d="M2 10C4 2 8 2 10 10S16 18 18 10s6-8 8 0M2 22q4-8 8 0t8 0T28 22"/>'),
    Case("packed numbers", '<path d="M2,3.5.5.5l6-1-.5.5-1e0,2e0z m10 0H20V9.5zm1e1,0 3 4-6,0Z"/>'),
    Case("faults end a path", '<path d="M2 4h10 L 20 x 30 30"/><path d="M2 8h10v4 Q 5"/><polyline points="2,15 12,15 12"/><polygon points="20,15 30,15 25,22 5"/>',
         lacking={"inkscape": "may drop a path with a fault"}),
    Case("rounded rectangles", '<rect x="2" y="2" width="14" height="8" rx="3"/><rect x="20" y="2" width="14" height="8" ry="20"/><rect x="2" y="14" width="14" height="8" rx="4" ry="2"/><rect x="20" y="14" width="14" height="8" rx="2" ry="3"/>'),
    Case("ellipse with one radius", '<ellipse cx="10" cy="10" rx="6"/><ellipse cx="26" cy="10" rx="8" ry="4"/>', lacking={"inkscape": "wants both radii"}),
    Case("byte order mark", whole=b"\xef\xbb\xbf" + whole('<?xml version="1.0" encoding="UTF-8"?>' + HEAD + f'viewBox="0 0 40 30" {LOOK}><path d="{FLAG}"/></svg>')),
    Case("utf-16", whole=('﻿<?xml version="1.0" encoding="UTF-16"?>' + HEAD + f'viewBox="0 0 40 30" {LOOK}><path d="{FLAG}"/></svg>').encode("utf-16-le")),
    Case("carriage returns only", whole=whole(('<?xml version="1.0"?>\n' + HEAD + f'\nviewBox="0 0\n40\n30" {LOOK}>\n<style>\npath\n{{stroke:blue}}\n</style><path\nd="M2 2\nh12\nl-3 4\n3 4h-12z"\ntransform="translate(3\n4)"/>\n</svg>').replace("\n", "\r")), quick=True),
    Case("doctype and entities of xml", whole=whole('<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">' + HEAD + f'viewBox="0 0 40 30" {LOOK}><path d="M2 2h1&#50;l-3 4z"/></svg>')),
]
