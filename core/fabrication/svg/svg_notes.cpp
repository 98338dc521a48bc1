// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_notes.h"

namespace formwright {

void add_sentences(const SvgNotes& notes, std::vector<std::string>& sentences) {
  struct Kind {
    std::size_t count;
    const char *one, *many;  // what follows the number
  };
  const Kind kinds[] = {
      {notes.words, "text was left out: convert it to paths to have it on the material.",
       "texts were left out: convert them to paths to have them on the material."},
      {notes.pictures, "picture was left out: only lines are followed.",
       "pictures were left out: only lines are followed."},
      {notes.foreign, "part in another language (foreignObject) was left out: convert text to paths.",
       "parts in another language (foreignObject) were left out: convert text to paths."},
      {notes.clips,
       "clip was not applied, what it hides is in the drawing: cut the shapes themselves (in Inkscape, Path > Intersection).",
       "clips were not applied, what they hide is in the drawing: cut the shapes themselves (in Inkscape, Path > Intersection)."},
      {notes.masks,
       "mask was not applied, what it hides is in the drawing: cut the shapes themselves (in Inkscape, Path > Intersection).",
       "masks were not applied, what they hide is in the drawing: cut the shapes themselves (in Inkscape, Path > Intersection)."},
      {notes.filters, "filter was not applied: lines are where they would be without it.",
       "filters were not applied: lines are where they would be without them."},
      {notes.markers,
       "line has arrowheads or other markers, which were left out: convert them to paths (in Inkscape, Path > Stroke to Path).",
       "lines have arrowheads or other markers, which were left out: convert them to paths (in Inkscape, Path > Stroke to Path)."},
      {notes.dots, "line has dashes of length zero, which were left out: give them a length.",
       "lines have dashes of length zero, which were left out: give them a length."},
      {notes.malformed, "element has a fault and was read as far as it goes.",
       "elements have a fault and were read as far as they go."},
      {notes.hairlines, "stroke has no width and is not painted: give it a width, such as 0.1.",
       "strokes have no width and are not painted: give them a width, such as 0.1."},
      {notes.unstroked, "line has neither a stroke nor an area and is not painted: give it a stroke.",
       "lines have neither a stroke nor an area and are not painted: give them a stroke."},
      {notes.unknown_colours, "shape has a colour that is not understood and is taken as a note: write it as #rrggbb.",
       "shapes have a colour that is not understood and are taken as notes: write it as #rrggbb."},
      {notes.paint_servers,
       "shape is painted with a gradient or pattern, which names no layer, and is taken as a note: give it one colour.",
       "shapes are painted with a gradient or pattern, which names no layer, and are taken as notes: give them one colour."},
      {notes.other_colours,
       "shape has a colour that names no layer (red cut, blue mark, black engrave) and is taken as a note.",
       "shapes have a colour that names no layer (red cut, blue mark, black engrave) and are taken as notes."},
      {notes.rules, "style rule was not followed: save the drawing as plain SVG with presentation attributes.",
       "style rules were not followed: save the drawing as plain SVG with presentation attributes."},
      {notes.animations, "animation was not followed: the drawing is as it is without.",
       "animations were not followed: the drawing is as it is without them."},
      {notes.scripts, "script was not run: what it draws is not in the drawing.",
       "scripts were not run: what they draw is not in the drawing."},
      {notes.entities,
       "attribute has an entity of XML (&name;), which was not replaced: save the drawing as plain SVG.",
       "attributes have entities of XML (&name;), which were not replaced: save the drawing as plain SVG."},
      {notes.other_files, "reference to another file was not followed: copy what it shows into the drawing.",
       "references to other files were not followed: copy what they show into the drawing."},
      {notes.languages, "part depends on the reader's language: English was taken.",
       "parts depend on the reader's language: English was taken."},
      {notes.outside, "line reaches outside the drawing's page, where it is not seen: it is kept.",
       "lines reach outside the drawing's page, where they are not seen: they are kept."}};
  for (const Kind& kind : kinds)
    if (kind.count > 0)
      sentences.push_back(std::to_string(kind.count) + " " + (kind.count == 1 ? kind.one : kind.many));
}

}  // namespace formwright
