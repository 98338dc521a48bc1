// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small drawings that use, between them, all that the reader follows.
#include <string>
#include <utility>
#include <vector>

#include "reliability/hostile_drawings.h"

namespace formwright::fuzz {

inline std::vector<std::pair<std::string, std::string>> svg_seeds() {
  std::vector<std::pair<std::string, std::string>> seeds;
  const auto add = [&](const std::string& name, const std::string& body) {
    seeds.emplace_back(name, test::drawing_of(body));
  };
  add("shapes",
      "<rect x='1' y='2' width='30' height='20' rx='3'/><circle cx='50%' cy='30' r='2em'/><ellipse rx='4' ry='2'/><line x2='9'/><polygon "
      "points='0,0 10,0-5,20'/><path d='M1 1h3v4l-2-2zC1 2 3 4 5 6s1 2 3 4Q1 2 3 4t5 6A5 3 20 1 0 9 9'/>");
  add("transforms",
      "<g transform='translate(1,2)scale(2)rotate(30 1 1)skewX(3)matrix(1 0 0 1 2 3)'><path style='transform:rotate(0.1turn) "
      "translate(5%,2mm);transform-origin:left 5px;transform-box:fill-box;scale:2;rotate:9deg' d='M0 0h9v2'/></g>");
  add("styles",
      "<style>@media screen{g > path.a:not(#b)[d^='M']:nth-child(2n+1){stroke:hsl(120 50% 20%/.5)!important}} * + "
      "path~path,#b{fill:url(#g) red}</style><linearGradient id='g'><stop stop-color='#f00'/></linearGradient><g><path class='a c' "
      "d='M0 0h9v2'/><path id='b' d='M0 0h9v2'/></g>");
  add("dashes",
      "<path stroke-dasharray='3 10% 1mm' stroke-dashoffset='-2' pathLength='9' vector-effect='non-scaling-stroke' d='M0 0h90v9z'/>");
  add("clips",
      "<clipPath id='c' clipPathUnits='objectBoundingBox'><circle cx='.5' cy='.5' r='.4'/><use href='#r'/></clipPath><rect id='r' "
      "width='9' height='9' clip-path='url(#c)'/><rect stroke='none' fill='blue' fill-rule='evenodd' width='9' height='9' "
      "clip-path='url(#c)'/><svg x='1' y='1' width='5' height='4' viewBox='0 0 9 9' preserveAspectRatio='xMinYMax slice'><circle r='9'/></svg>");
  add("uses",
      "<symbol id='s' viewBox='0 0 9 9'><path d='M0 0h9'/></symbol><use href='#s' x='1' width='9' height='5'/><switch><g "
      "systemLanguage='de'/><use href='#s'/></switch>");
  add("left_out",
      "<text>a</text><image/><foreignObject/><g mask='url(#m)' filter='blur(2px)'><path marker-end='url(#m)' opacity='.5' "
      "d='M0 0h9'/></g><marker id='m'/>");
  // The library of hostile drawings, small: what they are made of is where limits are.
  test::hostile_drawings(150, [&](const std::string& name, const std::string& file) {
    if (file.size() < 2000) seeds.emplace_back("hostile_" + name, file);
  });
  return seeds;
}

}  // namespace formwright::fuzz
